#pragma once
/// A part on the viewer's page, to be looked at: pieces and kinds of edges in colours, saved as a picture.

#include "tactum/geometry/part.h"

namespace tactum {

/// Serves the page until it is interrupted. `port` 0 finds a free one.
void view_part(const Part& part, int port);

}  // namespace tactum
