#pragma once
/// One HTTP connection: serves the page's files and the geometry to clients that may have them (access.h),
/// until the client asks for the WebSocket of a page.

#include <boost/asio/ip/tcp.hpp>

#include "viewer/server/connection_hub.h"

namespace tactum {

/// Answers the requests on the socket, until one side ends it.
void serve_http(ConnectionHub& hub, boost::asio::ip::tcp::socket&& socket);

}  // namespace tactum
