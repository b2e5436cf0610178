#include "bench/surfaces_pairs.h"

#include <algorithm>
#include <filesystem>

#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/base/random.h"
#include "tactum/devices/motion_file.h"
#include "tactum/geometry/weld.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/surface/surface_distance.h"

namespace tactum::bench {
namespace {

int frames_of(const SurfacesOptions& options) { return options.quick ? 5 : options.frames; }

std::optional<TriangleMesh> real_mesh(const SurfacesOptions& options, const std::string& name, double scale) {
  const std::filesystem::path path = std::filesystem::path(options.data) / name;
  if (options.data.empty() || !std::filesystem::exists(path)) return std::nullopt;
  const Result<ImportedMesh> mesh = import_mesh(path.string(), {.scale = scale});
  if (!mesh) return std::nullopt;
  WeldOptions weld_options;
  weld_options.drop_zero_area = weld_options.drop_duplicates = true;
  return weld(mesh->mesh, weld_options).mesh;
}

/// B moved along `direction` until the surfaces are `gap_m` apart, to a tenth.
Pose approached(const Surface& a, const Surface& b, Pose X, const Vec3& direction, double gap_m,
                SurfacePairCache& cache) {
  for (int step = 0; step < 100; ++step) {
    const double left_m = surface_distance(a, b, X, cache).distance - gap_m;
    if (left_m < 0.1 * gap_m) break;
    X.p -= left_m * direction;
  }
  return X;
}

/// A hand that keeps B in contact from one side: wandering a little, 5 to 50 micrometres away.
std::vector<Pose> near_contact(const TriangleMesh& mesh_a, const TriangleMesh& mesh_b, const Vec3& direction,
                               int frames) {
  const Surface a(mesh_a);
  const Surface b(mesh_b);
  SurfacePairCache cache;
  Random random(21);
  std::vector<Pose> poses;
  Mat3 R = exp_rotation(Vec3(0.3, -0.2, 0.5));
  Vec3 aside = Vec3::Zero();
  const double far_m = a.size() + b.size();
  for (int i = 0; i < frames; ++i) {
    constexpr double kTurn_rad = 2e-3, kShift_m = 1e-4, kNearest_m = 5e-6, kFarthest_m = 5e-5;
    Vec3 turn;
    for (int k = 0; k < 3; ++k) {
      turn[k] = random.uniform(-kTurn_rad, kTurn_rad);
      aside[k] += random.uniform(-kShift_m, kShift_m);
    }
    R = exp_rotation(turn) * R;
    poses.push_back(approached(a, b, {R, aside + far_m * direction}, direction,
                               random.uniform(kNearest_m, kFarthest_m), cache));
  }
  return poses;
}

/// A nut that is screwed on, its flanks 5 micrometres from the bolt's, wobbling by two.
std::vector<Pose> screwed(const TriangleMesh& bolt, const TriangleMesh& nut, Pose X, double pitch_m,
                          int frames) {
  const Surface a(bolt);
  const Surface b(nut);
  SurfacePairCache cache;
  constexpr double kGap_m = 5e-6, kStep_m = 1e-6, kWobble_m = 2e-6;
  while (surface_distance(a, b, X, cache).distance > kGap_m) X.p.z() -= kStep_m;
  Random random(22);
  std::vector<Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double turn = -2.0 * kPi * i / frames;
    const Pose screw{exp_rotation(Vec3(0, 0, turn)), {0, 0, pitch_m * turn / (2.0 * kPi)}};
    Pose at = screw * X;
    for (int k = 0; k < 3; ++k) at.p[k] += random.uniform(-kWobble_m, kWobble_m);
    poses.push_back(at);
  }
  return poses;
}

std::optional<SurfacePair> real_pair(const SurfacesOptions& options, const std::string& a,
                                     const std::string& b, const std::string& motion_name) {
  auto mesh_a = real_mesh(options, a, 1.0);
  auto mesh_b = real_mesh(options, b, 1.0);
  if (!mesh_a || !mesh_b) return std::nullopt;
  const Result<TwoBodyMotion> motion =
      read_two_body_motion((std::filesystem::path(options.data) / motion_name).string());
  if (!motion) return std::nullopt;
  SurfacePair pair{std::move(*mesh_a), std::move(*mesh_b), {}};
  for (std::size_t i = 0; i < motion->frame.size(); i += options.quick ? 50 : 1) {
    pair.X_AB.push_back(relative_pose(motion->X_WA[i], motion->X_WB[i]));
  }
  return pair;
}

std::optional<SurfacePair> nist_gears(const SurfacesOptions& options) {
  return real_pair(options, "industreal/industreal_gear_medium.obj", "industreal/industreal_gear_small.obj",
                   "reference/gears_medium_small_motion.csv");
}

std::optional<SurfacePair> m16_free(const SurfacesOptions& options) {
  return real_pair(options, "factory/factory_bolt_m16_loose.obj",
                   "factory/factory_nut_m16_loose_subdiv_3x.obj", "reference/m16_loose_screw_motion.csv");
}

std::optional<SurfacePair> m16_contact(const SurfacesOptions& options) {
  auto pair = m16_free(options);
  constexpr double kPitch_m = 0.002;
  if (pair) pair->X_AB = screwed(pair->a, pair->b, pair->X_AB.front(), kPitch_m, frames_of(options));
  return pair;
}

std::optional<SurfacePair> scans(const SurfacesOptions& options) {
  constexpr double kScale = 0.01;
  auto skull = real_mesh(options, "scans/skull.obj", kScale);
  if (!skull) return std::nullopt;
  const Vec3 direction = Vec3(1.0, 0.2, 0.1).normalized();
  return SurfacePair{*skull, *skull, near_contact(*skull, *skull, direction, frames_of(options))};
}

std::optional<SurfacePair> thread(const SurfacesOptions& options) {
  testing::Thread shape;
  shape.turns = 12;
  shape.segments = 80;
  shape.steps = 12;
  const TriangleMesh bolt = testing::thread_mesh(shape);
  constexpr double kPlay_m = 1e-4;
  shape.inner = true;
  shape.turns = 6;
  shape.offset = kPlay_m;
  const TriangleMesh nut = testing::thread_mesh(shape);
  const Pose inside{Mat3::Identity(), {0, 0, 3.0 * shape.pitch}};
  return SurfacePair{bolt, nut, screwed(bolt, nut, inside, shape.pitch, frames_of(options))};
}

SurfacePair rough_tori(const SurfacesOptions& options, int around, int across) {
  Random random(23);
  constexpr double kRough = 1e-4;
  const TriangleMesh a = testing::roughened(testing::torus(around, across, 0.04, 0.015), random, kRough);
  const TriangleMesh b = testing::roughened(testing::torus(around, across, 0.03, 0.01), random, kRough);
  return {a, b, near_contact(a, b, Vec3(0.2, 0.3, 1.0).normalized(), frames_of(options))};
}
std::optional<SurfacePair> tori(const SurfacesOptions& options) { return rough_tori(options, 320, 160); }
std::optional<SurfacePair> million(const SurfacesOptions& options) { return rough_tori(options, 1000, 500); }

}  // namespace

const std::vector<SurfacePairEntry>& surface_pairs() {
  static const std::vector<SurfacePairEntry> list = {
      {"gears-nist", 1e-4, false, nist_gears},   {"m16-motion", 6e-5, false, m16_free},
      {"m16-contact", 6e-5, false, m16_contact}, {"skulls", 6e-5, true, scans},
      {"thread", 6e-5, false, thread},           {"tori", 6e-5, true, tori},
      {"tori-million", 6e-5, true, million}};
  return list;
}

}  // namespace tactum::bench
