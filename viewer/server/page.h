#pragma once
/// The page, as it lies inside the program: the files that viewer/web builds, compressed (made at build time
/// by viewer/web/embed.mjs).

#include <span>
#include <string_view>

namespace tactum {

struct PageFile {
  std::string_view path;  ///< "index.html", "assets/index-1a2b.js"
  std::string_view type;  ///< for the Content-Type header
  std::string_view gzip;  ///< its bytes, compressed
};

/// The first is the page itself.
std::span<const PageFile> page_files();

}  // namespace tactum
