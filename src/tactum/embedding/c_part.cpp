/// Parts, distance and clearance of the C interface.

#include "tactum/embedding/c_handles.h"
#include "tactum/embedding/c_values.h"

using namespace tactum;  // the C interface stands outside the namespace
using namespace tactum::c_calls;

namespace {

PrepareOptions prepare_options(const tactum_part_options& given) {
  PrepareOptions options;
  options.name = text_of(given.name);
  if (given.unit != nullptr) options.unit = given.unit;
  if (given.pieces != nullptr) options.pieces = given.pieces;
  options.scale = given.scale;
  options.close_holes = given.close_holes;
  if (given.threads > 0) options.threads = given.threads;
  if (given.density_kg_per_m3 != 0.0) options.density_kg_per_m3 = given.density_kg_per_m3;
  return options;
}

tactum_status hand_over(Result<std::shared_ptr<const QueriedPart>> made, tactum_part** part) {
  if (!made) return refuse(made.error());
  *part = new tactum_part{std::move(*made)};
  return TACTUM_OK;
}

tactum_distance c_distance(const PartDistance& found) {
  tactum_distance out{};
  out.distance_m = found.distance;
  put(found.p_a_W, out.p_a_W);
  put(found.p_b_W, out.p_b_W);
  put(found.n_BA_W, out.n_BA_W);
  out.touching_pairs = found.touching_pairs;
  out.inside = found.inside ? 1 : 0;
  out.certified = found.certified ? 1 : 0;
  return out;
}

/// The question of both kinds of distance, once it is sound.
struct PartsAtPoses {
  const QueriedPart* a = nullptr;
  const QueriedPart* b = nullptr;
  Pose X_WA, X_WB;
};

tactum_status read_question(const char* call, const tactum_part* a, const tactum_pose* X_WA,
                            const tactum_part* b, const tactum_pose* X_WB, PartsAtPoses& question) {
  if (a == nullptr || b == nullptr) return bad_call(call, "a part is null");
  if (X_WA == nullptr || X_WB == nullptr) return bad_call(call, "a pose is null");
  question = {a->part.get(), b->part.get(), pose_of(*X_WA), pose_of(*X_WB)};
  if (Result<void> sound = check_pose(question.X_WA, "X_WA"); !sound) return refuse(sound.error());
  if (Result<void> sound = check_pose(question.X_WB, "X_WB"); !sound) return refuse(sound.error());
  return TACTUM_OK;
}

}  // namespace

tactum_status tactum_load_part(const char* path, const tactum_part_options* options, tactum_part** part) {
  return guarded([&] {
    if (path == nullptr || part == nullptr) return bad_call("tactum_load_part", "a pointer is null");
    tactum_part_options taken{};
    if (const tactum_status status = take("tactum_load_part", options, taken); status != TACTUM_OK)
      return status;
    return hand_over(QueriedPart::load(path, prepare_options(taken)), part);
  });
}

tactum_status tactum_make_part(const double* vertices, size_t vertex_count, const int32_t* triangles,
                               size_t triangle_count, const tactum_part_options* options,
                               tactum_part** part) {
  return guarded([&] {
    if (vertices == nullptr || triangles == nullptr || part == nullptr)
      return bad_call("tactum_make_part", "a pointer is null");
    tactum_part_options taken{};
    if (const tactum_status status = take("tactum_make_part", options, taken); status != TACTUM_OK)
      return status;
    TriangleMesh mesh;
    for (size_t i = 0; i < vertex_count; ++i) mesh.vertices.push_back(vector_of(vertices + 3 * i));
    for (size_t i = 0; i < triangle_count; ++i)
      mesh.triangles.push_back({triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]});
    return hand_over(QueriedPart::from_mesh(std::move(mesh), prepare_options(taken)), part);
  });
}

tactum_status tactum_save_part(const tactum_part* part, const char* path) {
  return guarded([&] {
    if (part == nullptr || path == nullptr) return bad_call("tactum_save_part", "a pointer is null");
    const Result<void> saved = save_part(path, part->part->file());
    return saved ? TACTUM_OK : refuse(saved.error());
  });
}

void tactum_release_part(tactum_part* part) { delete part; }

tactum_status tactum_inspect_part(const tactum_part* part, tactum_part_info* info) {
  return guarded([&] {
    if (part == nullptr) return bad_call("tactum_inspect_part", "the part is null");
    if (const tactum_status status = check_room("tactum_inspect_part", info); status != TACTUM_OK)
      return status;
    const PartFile& file = part->part->file();
    tactum_part_info out{};
    out.vertices = static_cast<int32_t>(file.part.surface.vertices.size());
    out.triangles = static_cast<int32_t>(file.part.surface.triangles.size());
    out.pieces = static_cast<int32_t>(file.part.pieces.size());
    out.size_m = file.part.size;
    out.volume_m3 = file.part.mass.volume;
    out.mass_kg = file.part.mass.mass;
    out.density_kg_per_m3 = file.density_kg_per_m3;
    put(file.origin, out.center_P);
    put_rows(file.part.mass.inertia, out.inertia_B);
    const Aabb box = bounds(part->part->mesh().vertices);
    put(box.min, out.box_min_P);
    put(box.max, out.box_max_P);
    give(out, info);
    return TACTUM_OK;
  });
}

const char* tactum_part_name(const tactum_part* part) {
  return part == nullptr ? "" : part->part->file().part.name.c_str();
}

const char* tactum_part_report(const tactum_part* part) {
  return part == nullptr ? "" : part->part->file().report.c_str();
}

tactum_status tactum_part_mesh(const tactum_part* part, tactum_mesh_view* view) {
  return guarded([&] {
    if (part == nullptr) return bad_call("tactum_part_mesh", "the part is null");
    if (const tactum_status status = check_room("tactum_part_mesh", view); status != TACTUM_OK) return status;
    give(c_mesh(part->part->mesh()), view);
    return TACTUM_OK;
  });
}

tactum_status tactum_clearance(const tactum_part* a, const tactum_pose* X_WA, const tactum_part* b,
                               const tactum_pose* X_WB, tactum_distance* distance) {
  return guarded([&] {
    PartsAtPoses at;
    if (const tactum_status status = read_question("tactum_clearance", a, X_WA, b, X_WB, at);
        status != TACTUM_OK)
      return status;
    if (const tactum_status status = check_room("tactum_clearance", distance); status != TACTUM_OK)
      return status;
    SurfacePairCache cache;
    give(c_distance(clearance(*at.a, at.X_WA, *at.b, at.X_WB, cache)), distance);
    return TACTUM_OK;
  });
}

tactum_status tactum_signed_distance(const tactum_part* a, const tactum_pose* X_WA, const tactum_part* b,
                                     const tactum_pose* X_WB, tactum_distance* distance) {
  return guarded([&] {
    PartsAtPoses at;
    if (const tactum_status status = read_question("tactum_signed_distance", a, X_WA, b, X_WB, at);
        status != TACTUM_OK)
      return status;
    if (const tactum_status status = check_room("tactum_signed_distance", distance); status != TACTUM_OK)
      return status;
    const Result<PartDistance> found = signed_distance(*at.a, at.X_WA, *at.b, at.X_WB);
    if (!found) return refuse(found.error());
    give(c_distance(*found), distance);
    return TACTUM_OK;
  });
}
