#pragma once
/// The mesh that every reader fills: vertices, polygons and groups, with the caps and checks of all formats.

#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/mesh/imported_mesh.h"

namespace tactum::inline v0_1::detail {

class MeshBuilder {
 public:
  MeshBuilder(std::string file, const ImportOptions& options) : file_(std::move(file)), options_(options) {}

  /// An error at a place of this file: "line 12", "byte 84", "mesh 3".
  Error error(const std::string& what, const std::string& found, const std::string& expected,
              const std::string& place = {}) const;

  /// Fails on coordinates that are not finite or not plausible, and beyond the cap.
  Result<void> add_vertex(const Vec3& point, const std::string& place);

  /// Indices must be in [0, vertex count). Fewer than three corners: dropped and counted.
  Result<void> add_polygon(const std::vector<int>& corners, const std::string& place);

  /// The triangles from here on belong to `name`. A group without triangles vanishes.
  void begin_group(std::string_view name);

  int vertex_count() const { return static_cast<int>(out_.mesh.vertices.size()); }
  ImportReport& report() { return out_.report; }
  const std::string& file() const { return file_; }
  const ImportOptions& options() const { return options_; }

  /// Last checks, scale, groups and sentences; an error when there is no triangle.
  Result<ImportedMesh> finish();

 private:
  void write_remarks();

  std::string file_;
  ImportOptions options_;
  ImportedMesh out_;
};

inline std::string at_line(int line) { return "line " + std::to_string(line); }
inline std::string at_byte(std::size_t byte) { return "byte " + std::to_string(byte); }

/// A word of a file as it may stand in an error: short, printable, quoted.
std::string in_quotes(std::string_view word);

/// Whether the size is to the byte that of a binary STL of as many triangles as its header counts.
bool is_binary_stl(std::string_view bytes);

Result<void> read_obj(std::string_view text, MeshBuilder& builder);
Result<void> read_stl(std::string_view bytes, MeshBuilder& builder);
Result<void> read_ply(std::string_view bytes, MeshBuilder& builder);
Result<void> read_off(std::string_view text, MeshBuilder& builder);
Result<void> read_gltf(std::string_view bytes, MeshBuilder& builder);
Result<void> read_collada(std::string_view text, MeshBuilder& builder);

}  // namespace tactum::inline v0_1::detail
