#include "tactum/mesh/part_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <fstream>

#include "tactum/mesh/array_file.h"
#include "tactum/mesh/mapped_file.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::string_view kMagic = "TACTUM\x1a\n";
constexpr double kLargestCoordinate = 1e12;  // farther, squares of squares leave the range of doubles [m]

/// Every array of a part, once for writing and reading.
template <class Archive, class File>
void fields(Archive& archive, File& file) {
  auto& part = file.part;
  archive("report", file.report);
  archive("origin", file.origin);
  archive("density", file.density_kg_per_m3);
  archive("name", part.name);
  archive("way", part.notes.pieces);
  archive("remarks", part.notes.remarks);
  archive("surface.vertices", part.surface.vertices);
  archive("surface.triangles", part.surface.triangles);
  archive("pieces", part.pieces);
  archive("surface_group", part.groups.of_piece);
  archive("group_count", part.groups.count);
  archive("tree", part.tree);
  archive("volume", part.mass.volume);
  archive("mass", part.mass.mass);
  archive("center", part.mass.center);
  archive("inertia", part.mass.inertia);
  archive("approximation", part.mass.approximation);
  archive("radius", part.radius);
  archive("size", part.size);
}

bool within_range(const std::vector<Vec3>& points) {
  return std::all_of(points.begin(), points.end(), [](const Vec3& p) {
    return p.allFinite() && p.cwiseAbs().maxCoeff() <= kLargestCoordinate;
  });
}

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

/// The first inconsistency, with its place; an empty name when there is none.
struct Fault {
  const char* array = "";
  const char* found = "";
};
Fault fault_in(const PartFile& file) {
  const Part& part = file.part;
  if (!within_range({file.origin})) return {"origin", "no point"};
  if (!positive(file.density_kg_per_m3)) return {"density", "no density"};
  if (!within_range(part.surface.vertices)) return {"surface.vertices", "a vertex that is no point"};
  const int vertices = static_cast<int>(part.surface.vertices.size());
  for (const Triangle& t : part.surface.triangles)
    for (int corner : t)
      if (corner < 0 || corner >= vertices) return {"surface.triangles", "a corner that is no vertex"};
  for (const Polytope& piece : part.pieces)
    if (!within_range(piece.vertices)) return {"pieces", "a vertex that is no point"};
  if (part.surface.triangles.empty()) return {"surface.triangles", "no triangle"};
  if (part.groups.of_piece.size() != part.pieces.size()) return {"surface_group", "another count of pieces"};
  for (int group : part.groups.of_piece)
    if (group < 0 || group >= part.groups.count) return {"surface_group", "a group that is none"};
  if (part.groups.count < 0 || part.groups.count > static_cast<int>(part.surface.triangles.size()))
    return {"group_count", "no count"};
  if (part.tree.triangle_count() != static_cast<int>(part.surface.triangles.size()))
    return {"tree", "another count of triangles"};
  if (!positive(part.mass.mass) || !positive(part.mass.volume)) return {"mass", "no mass"};
  if (!within_range({part.mass.center}) || !part.mass.inertia.allFinite())
    return {"inertia", "numbers that are not finite"};
  if (!positive(part.radius) || !positive(part.size)) return {"size", "no size"};
  return {};
}

Result<PartFile> read_checked(std::string_view bytes, const std::string& name) {
  PartFile file;
  ArrayReader reader(bytes, kMagic, kPartFileVersion, "part", name);
  fields(reader, file);
  if (Result<void> done = reader.finish(); !done) return done.error();
  if (const Fault fault = fault_in(file); fault.array[0] != '\0') {
    reader.refuse(fault.array, fault.found);
    return reader.finish().error();
  }
  std::vector<Aabb> boxes;
  boxes.reserve(file.part.pieces.size());
  for (const Polytope& piece : file.part.pieces) boxes.push_back(bounds(piece.vertices));
  file.part.hierarchy = Bvh(boxes);
  find_true_surface(file.part);
  return file;
}

}  // namespace

bool looks_like_part(std::string_view bytes) { return bytes.substr(0, kMagic.size()) == kMagic; }

std::string part_bytes(const PartFile& file) {
  ArrayWriter writer;
  fields(writer, file);
  return std::move(writer).finish(kMagic, kPartFileVersion);
}

Result<PartFile> read_part(std::string_view bytes, const std::string& name) {
  try {
    return read_checked(bytes, name);
  } catch (const std::exception& trouble) {  // out of memory
    return Error{"the part cannot be read", trouble.what(), "", name};
  }
}

Result<void> save_part(const std::string& path, const PartFile& file) {
  return write_whole_file(path, part_bytes(file));
}

Result<PartFile> load_part(const std::string& path) {
  const Result<MappedFile> mapped = MappedFile::open(path);
  if (!mapped) return mapped.error();
  return read_part(mapped->bytes(), path);
}

bool is_part_file(const std::string& path) {
  std::array<char, kMagic.size()> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  return looks_like_part({start.data(), static_cast<std::size_t>(file.gcount())});
}

void set_density(PartFile& file, double density_kg_per_m3) {
  const double factor = density_kg_per_m3 / file.density_kg_per_m3;
  file.part.mass.mass *= factor;
  file.part.mass.inertia *= factor;
  file.density_kg_per_m3 = density_kg_per_m3;
}

TriangleMesh surface_in_mesh_frame(const PartFile& file) {
  TriangleMesh surface = file.part.surface;
  for (Vec3& vertex : surface.vertices) vertex += file.origin;
  return surface;
}

}  // namespace tactum::inline v0_1
