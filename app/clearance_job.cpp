#include "app/clearance_job.h"

#include <fmt/format.h>

#include "app/command_line.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/mesh/part_file.h"

namespace tactum {
namespace {

TriangleMesh read_surface(const std::string& path, double scale) {
  if (is_part_file(path)) {
    const Result<PartFile> part = load_part(path);
    if (!part) fail(part.error());
    return surface_in_mesh_frame(*part);  // in metres, as prepared
  }
  const Result<ImportedMesh> mesh = import_mesh(path, {.scale = scale});
  if (!mesh) fail(mesh.error());
  for (const std::string& remark : mesh->report.remarks) fmt::print(stderr, "{}: {}\n", path, remark);
  return mesh->mesh;
}

std::vector<Pose> relative_poses(const TwoBodyMotion& motion, double scale) {
  std::vector<Pose> poses;
  poses.reserve(motion.frame.size());
  for (std::size_t i = 0; i < motion.frame.size(); ++i) {
    poses.push_back(relative_pose(motion.X_WA[i], motion.X_WB[i]));
    poses.back().p *= scale;
  }
  return poses;
}

}  // namespace

void add_clearance_files(CLI::App& command, ClearanceFiles& files) {
  command.add_option("A", files.mesh_a, "Mesh of the first body")->required();
  command.add_option("B", files.mesh_b, "Mesh of the second body")->required();
  command.add_option("MOTION", files.motion, "CSV with a pose of A and of B in every row")->required();
  command.add_option("--scale", files.scale, "Metres per unit of the meshes and of the motion")
      ->check(CLI::PositiveNumber);
}

ClearanceJob read_clearance_job(const ClearanceFiles& files) {
  ClearanceJob job;
  job.a = read_surface(files.mesh_a, files.scale);
  job.b = read_surface(files.mesh_b, files.scale);
  Result<TwoBodyMotion> motion = read_two_body_motion(files.motion);
  if (!motion) fail(motion.error());
  if (motion->frame.empty()) fail(Error{"the motion is empty", "no rows", "at least one row", files.motion});
  const std::string repairs = motion->repairs.sentence(motion->frame.size());
  if (!repairs.empty()) fmt::print(stderr, "{}: {}\n", files.motion, repairs);
  job.motion = std::move(*motion);
  job.X_AB = relative_poses(job.motion, files.scale);
  return job;
}

}  // namespace tactum
