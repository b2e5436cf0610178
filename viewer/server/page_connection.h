#pragma once
/// The WebSocket of one page: sends it new messages (docs/viewer.md draws them), and takes in its requests.

#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "viewer/server/connection_hub.h"

namespace tactum {

/// Answers a request for a WebSocket, which has been found allowed, and keeps the connection until its page
/// ends it.
void open_page(ConnectionHub& hub, boost::beast::tcp_stream&& stream,
               boost::beast::http::request<boost::beast::http::empty_body>&& request);

}  // namespace tactum
