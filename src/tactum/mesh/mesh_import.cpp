#include "tactum/mesh/mesh_import.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tactum/base/text_encoding.h"
#include "tactum/mesh/mesh_builder.h"
#include "tactum/mesh/text_scanner.h"

namespace tactum::inline v0_1 {
namespace {

using Reader = Result<void> (*)(std::string_view, detail::MeshBuilder&);

struct Format {
  std::string_view ending;
  Reader read;
};
constexpr Format kFormats[] = {{"obj", detail::read_obj},    {"stl", detail::read_stl},
                               {"ply", detail::read_ply},    {"off", detail::read_off},
                               {"gltf", detail::read_gltf},  {"glb", detail::read_gltf},
                               {"dae", detail::read_collada}};

constexpr std::size_t kRootWithin = 4096;  // of an XML file, behind its comments

std::string ending_of(const std::string& name) {
  std::string ending = std::filesystem::path(name).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

/// The format by the first bytes; empty when they are ambiguous.
std::string_view sniffed(std::string_view bytes) {
  if (bytes.substr(0, 4) == "glTF") return "glb";
  const std::string_view first = detail::Tokens(bytes.substr(0, 256)).next();
  if (first == "ply") return "ply";
  if (first == "OFF") return "off";
  if (!first.empty() && first.front() == '{') return "gltf";
  if (first.starts_with('<') && bytes.substr(0, kRootWithin).find("<COLLADA") != std::string_view::npos)
    return "dae";
  return {};
}

/// The format by content, else by ending.
Result<Format> format_of(std::string_view bytes, const std::string& name) {
  const std::string ending = ending_of(name);
  const std::string_view content = sniffed(bytes);
  const std::string_view wanted = content.empty() ? std::string_view(ending) : content;
  const bool is_text_format = wanted == "obj" || wanted == "off" || wanted == "gltf" || wanted == "dae";
  if (is_text_format && bytes.find('\0') != std::string_view::npos) {
    return Error{"the file is not a text", "a zero byte", "the text of an ." + std::string(wanted) + " file",
                 name};
  }
  for (const Format& format : kFormats) {
    if (format.ending == wanted) return format;
  }
  if (ending == "step" || ending == "stp")
    return Error{"exact surfaces cannot be felt as they are", "a STEP file",
                 "its triangles: tactum prepare " + name + " -o PART.tactum makes them", name};
  return Error{"the format is not known", ending.empty() ? "a name without ending" : "." + ending,
               ".obj, .stl, .ply, .off, .gltf, .glb or .dae", name};
}

Result<ImportedMesh> import_checked(std::string_view bytes, const std::string& name,
                                    const ImportOptions& options) {
  if (bytes.empty()) return Error{"the file is empty", "0 bytes", "a mesh", name};
  if (bytes.size() > options.max_bytes) {
    return Error{"the file is too large", std::to_string(bytes.size()) + " bytes",
                 "at most " + std::to_string(options.max_bytes) + " (raise max_bytes)", name};
  }
  if (!std::isfinite(options.scale) || options.scale <= 0.0) {
    return Error{"the scale is no scale", std::to_string(options.scale), "a number above zero", name};
  }
  // The header of a binary STL is any 80 bytes, so that a mark in it means nothing.
  const bool is_text = !detail::is_binary_stl(bytes) || ending_of(name) != "stl";
  const Result<std::string_view> text = is_text ? utf8_text(bytes, name) : bytes;
  if (!text) return text.error();
  const Result<Format> format = format_of(*text, name);
  if (!format) return format.error();
  detail::MeshBuilder builder(name, options);
  if (const std::string ending = ending_of(name); ending != format->ending) {
    builder.report().remarks.push_back("The name ends in ." + ending + ", the content is " +
                                       std::string(format->ending) + ".");
  }
  if (Result<void> done = format->read(*text, builder); !done) return done.error();
  return builder.finish();
}

Result<std::string> file_bytes(const std::string& path, const ImportOptions& options) {
  std::error_code trouble;
  if (!std::filesystem::exists(path, trouble)) return Error{"the file is not there", "", "a mesh file", path};
  if (!std::filesystem::is_regular_file(path, trouble)) {
    return Error{"this is not a file", "a folder or device", "a mesh file", path};
  }
  const std::uintmax_t size = std::filesystem::file_size(path, trouble);
  if (trouble) return Error{"the size of the file is not known", trouble.message(), "", path};
  if (size > options.max_bytes) {
    return Error{"the file is too large", std::to_string(size) + " bytes",
                 "at most " + std::to_string(options.max_bytes) + " (raise max_bytes)", path};
  }
  std::ifstream file(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!file || !file.read(bytes.data(), static_cast<std::streamsize>(size))) {
    return Error{"the file cannot be read", "", "read permission and a whole file", path};
  }
  return bytes;
}

}  // namespace

Result<ImportedMesh> import_mesh_bytes(std::string_view bytes, const std::string& name,
                                       const ImportOptions& options) {
  try {
    return import_checked(bytes, name, options);
  } catch (const std::exception& trouble) {  // out of memory, or from a library underneath
    return Error{"the mesh cannot be imported", trouble.what(), "", name};
  }
}

Result<ImportedMesh> import_mesh(const std::string& path, const ImportOptions& options) {
  try {
    const Result<std::string> bytes = file_bytes(path, options);
    if (!bytes) return bytes.error();
    return import_mesh_bytes(*bytes, path, options);
  } catch (const std::exception& trouble) {
    return Error{"the mesh cannot be imported", trouble.what(), "", path};
  }
}

UnitGuess unit_of(const ImportReport& report, const Aabb& box) {
  if (report.in_metres && report.format == "COLLADA")
    return {"metres", 1.0, "COLLADA says its unit, by which it was read in metres."};
  if (report.in_metres) return {"metres", 1.0, "glTF is in metres by its standard."};
  return guess_unit(box);
}

}  // namespace tactum::inline v0_1
