#include <algorithm>
#include <cmath>

#include "bench/feel.h"
#include "tactum/base/random.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"
#include "tactum/parts/generated_parts.h"

namespace tactum::bench {
namespace {

constexpr double kDegree = kPi / 180.0;
const Vec3 kBlock(0.010, 0.007, 0.005);  // half the grasped block [m]

FeelPiece box(const Vec3& half, const Pose& X = {}) { return {{"box", make_box(half), half}, X}; }

FeelPiece hull(const std::vector<Vec3>& points) { return {{"hull", *convex_hull(points), std::nullopt}, {}}; }

/// A part's piece; a box along the axes is given as one.
FeelPiece piece_of(const Polytope& P) {
  Vec3 low = P.vertices.front(), high = low;
  for (const Vec3& v : P.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const bool is_box =
      P.vertices.size() == 8 && std::all_of(P.vertices.begin(), P.vertices.end(), [&](const Vec3& v) {
        return (v.array() == low.array() || v.array() == high.array()).all();
      });
  if (is_box) return box(0.5 * (high - low), {Mat3::Identity(), 0.5 * (low + high)});
  // About its own middle: some engines need the origin inside.
  std::vector<Vec3> corners;
  for (const Vec3& v : P.vertices) corners.push_back(v - P.extent.center);
  FeelPiece piece = hull(corners);
  piece.X_BP.p = P.extent.center;
  return piece;
}

std::vector<FeelPiece> pieces_of(const std::vector<Polytope>& all) {
  std::vector<FeelPiece> pieces;
  for (const Polytope& P : all) pieces.push_back(piece_of(P));
  return pieces;
}

/// Six corners on the axes.
FeelPiece octahedron(double r) {
  return hull({{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}});
}

FeelPiece plate() { return box({0.06, 0.06, 0.01}, {Mat3::Identity(), {0, 0, -0.01}}); }

Pose at(const Vec3& p, const Vec3& turn = Vec3::Zero()) { return {exp_rotation(turn), p}; }

/// Appends a motion to `pressed`, a rest there, which is judged, and the way back.
void press_and_release(FeelScene& scene, const Pose& start, const Pose& pressed) {
  auto motion = std::make_shared<ScriptedMotion>(start);
  motion->move_to(0.5, pressed).hold(0.5).move_to(0.5, start).hold(0.1);
  scene.hand = motion;
  scene.judged_from_s = 0.8;
  scene.judged_to_s = 1.0;
}

Wrench stretch(const Coupling& k, const Vec3& displacement, const Vec3& turn) {
  return {k.stiffness_N_per_m * displacement, k.stiffness_Nm_per_rad * turn};
}

FeelScene block_on_plane() {
  FeelScene scene;
  scene.grasped = {box(kBlock)};
  scene.fixed = {plate()};
  const Vec3 turn(0.02, -0.03, 0.0);
  press_and_release(scene, at({0, 0, kBlock.z() + 0.002}), at({0.004, 0.002, kBlock.z() - 0.008}, turn));
  // It lies flat: only height and tilt are stretched. In the plane it goes where the hand is.
  scene.truth = [k = scene.coupling](const Pose& X_WH, double skin) {
    const Vec3 tilt = log_rotation(X_WH.R);
    return stretch(k, {0, 0, kBlock.z() + skin - X_WH.p.z()}, {-tilt.x(), -tilt.y(), 0});
  };
  return scene;
}

FeelScene wedge_in_groove() {
  FeelScene scene;
  constexpr double kTip = 0.02 / 3.0;  // below the centre of mass [m]
  std::vector<Vec3> corners;
  for (const double y : {-0.01, 0.01})
    corners.insert(corners.end(), {{-0.01, y, 0.01 - kTip}, {0.01, y, 0.01 - kTip}, {0, y, -kTip}});
  scene.grasped = {hull(corners)};
  for (const double side : {1.0, -1.0}) {
    const Mat3 R = exp_rotation({0, -side * kPi / 4.0, 0});  // its x axis goes up along the face
    scene.fixed.push_back(box({0.02, 0.02, 0.01}, {R, R * Vec3(side * 0.02, 0, -0.01)}));
  }
  press_and_release(scene, at({0, 0, kTip + 0.002}), at({0.002, 0.001, kTip - 0.006}, {0.01, 0.02, -0.01}));
  scene.truth = [k = scene.coupling](const Pose& X_WH, double skin) {
    const double seat = kTip + std::sqrt(2.0) * skin;
    return stretch(k, {-X_WH.p.x(), 0, seat - X_WH.p.z()}, -log_rotation(X_WH.R));
  };
  return scene;
}

/// A part tilted about y touches the plane with a corner or edge that is `height(angle)` below the handle:
/// the angle at which force and torsion spring balance, by bisection around the hand's.
Wrench tilted_contact(const Coupling& k, const Pose& X_WH, double skin, double x, double z) {
  const double hand = log_rotation(X_WH.R).y();
  const auto height = [&](double a) { return x * std::sin(a) - z * std::cos(a) + skin; };
  const auto torque = [&](double a) {
    const double arm = x * std::cos(a) + z * std::sin(a);
    return k.stiffness_N_per_m * (height(a) - X_WH.p.z()) * arm + k.stiffness_Nm_per_rad * (a - hand);
  };
  double low = hand - 0.3, high = hand + 0.3;
  for (int i = 0; i < 80; ++i) (torque(0.5 * (low + high)) > 0.0 ? high : low) = 0.5 * (low + high);
  const double angle = 0.5 * (low + high);
  return stretch(k, {0, 0, height(angle) - X_WH.p.z()}, {0, angle - hand, 0});
}

FeelScene edge_on_plane() {
  FeelScene scene;
  scene.grasped = {box(kBlock)};
  scene.fixed = {plate()};
  press_and_release(scene, at({0, 0, 0.012}, {0, 0.5, 0}), at({0.002, 0, 0.005}, {0, 0.5, 0}));
  scene.truth = [k = scene.coupling](const Pose& X, double skin) {
    return tilted_contact(k, X, skin, kBlock.x(), -kBlock.z());
  };
  return scene;
}

FeelScene corner_on_plane() {
  FeelScene scene;
  constexpr double kTip = 0.008;
  scene.grasped = {octahedron(kTip)};
  scene.fixed = {plate()};
  press_and_release(scene, at({0, 0, 0.010}, {0, 0.25, 0}), at({0.002, 0, 0.003}, {0, 0.25, 0}));
  scene.truth = [k = scene.coupling](const Pose& X, double skin) {
    return tilted_contact(k, X, skin, 0.0, -kTip);
  };
  return scene;
}

/// Along arcs of a circle in steps so small that the chords do not count.
constexpr int kArcs = 240;

FeelScene cylinder_in_hole() {
  FeelScene scene;
  constexpr double kWidth = 0.025, kClearance = 0.0002;
  Peg peg{64, kWidth, kWidth, 0.02, 0.0};
  Polytope cylinder = peg_pieces(peg)->front();
  std::vector<Vec3> corners;
  for (const Vec3& v : cylinder.vertices) corners.push_back(v - Vec3(0, 0, 0.01));
  scene.grasped = {hull(corners)};
  const auto ring = *hole_block_pieces({64, kWidth, kWidth, kClearance, 0.01, 0.03, 0.0});
  scene.fixed = pieces_of(ring);
  double middle = 0.0;
  for (const Vec3& v : ring.front().vertices)
    middle += v.z() / static_cast<double>(ring.front().vertices.size());
  auto motion = std::make_shared<ScriptedMotion>(at({0, 0, middle}));
  const auto point = [&](double a) { return at({0.005 * std::cos(a), 0.005 * std::sin(a), middle}); };
  motion->move_to(0.5, point(0.0));
  for (int i = 1; i <= kArcs; ++i)
    motion->move_to(2.0 / kArcs, point(1.0 * i / kArcs), MotionProfile::kSteady);
  motion->move_to(0.5, at({0, 0, middle})).hold(0.1);
  scene.hand = motion;
  scene.judged_from_s = 0.6;
  scene.judged_to_s = 2.4;
  scene.truth = [k = scene.coupling](const Pose& X_WH, double skin) {
    const Vec3 out(X_WH.p.x(), X_WH.p.y(), 0);
    const double free = 0.5 * kClearance - skin;
    return stretch(k, -out * (1.0 - free / out.norm()), Vec3::Zero());
  };
  // The hole is convex: no corner of the peg may be behind the inner face of any piece.
  std::vector<std::pair<Vec3, double>> inner;
  for (const Polytope& P : ring) {
    const auto face = std::min_element(P.faces.begin(), P.faces.end(), [&](const auto& a, const auto& b) {
      return a.normal.dot(P.extent.center) < b.normal.dot(P.extent.center);
    });
    inner.emplace_back(face->normal, face->offset);
  }
  scene.depth = [corners, inner](const Pose& X_WB) {
    double deepest = 0.0;
    for (const Vec3& v : corners)
      for (const auto& [normal, offset] : inner) deepest = std::max(deepest, offset - normal.dot(X_WB * v));
    return deepest;
  };
  return scene;
}

FeelScene sliding_over_facets() {
  FeelScene scene;
  static constexpr double kRadius = 0.02, kTip = 0.001, kForce_N = 5.0;
  scene.grasped = {octahedron(kTip)};
  std::vector<Vec3> corners;
  for (const Vec3& v : make_prism(64, kRadius, 0.04).vertices) corners.emplace_back(v.x(), v.z(), v.y());
  scene.fixed = {hull(corners)};
  const double radius = kRadius - kForce_N / scene.coupling.stiffness_N_per_m;
  auto motion = std::make_shared<ScriptedMotion>(at({0, 0, kRadius + 0.003 + kTip}));
  const auto point = [&](double a) { return at({radius * std::sin(a), 0, radius * std::cos(a) + kTip}); };
  motion->move_to(0.5, point(0.0)).move_to(0.5, point(-0.6));
  for (int i = 1; i <= kArcs; ++i)
    motion->move_to(2.0 / kArcs, point(-0.6 + 1.2 * i / kArcs), MotionProfile::kSteady);
  motion->move_to(0.5, point(0.0)).move_to(0.5, at({0, 0, kRadius + 0.003 + kTip})).hold(0.1);
  scene.hand = motion;
  scene.judged_from_s = 1.1;
  scene.judged_to_s = 2.9;
  scene.truth = [k = scene.coupling](const Pose& X_WH, double skin) {
    const Vec3 out = X_WH.p - Vec3(0, 0, kTip);
    const Vec3 f = k.stiffness_N_per_m * out * ((kRadius + skin) / out.norm() - 1.0);
    return Wrench{f, Vec3(0, 0, -kTip).cross(f)};
  };
  return scene;
}

FeelScene rubbed_block() {
  FeelScene scene;
  scene.grasped = {box(kBlock)};
  scene.fixed = {plate()};
  scene.friction = 0.3;
  return scene;
}

FeelScene sliding_with_friction() {
  FeelScene scene = rubbed_block();
  const Pose start = at({0, 0, kBlock.z() + 0.002});
  const double z = kBlock.z() - 0.008;
  auto motion = std::make_shared<ScriptedMotion>(start);
  motion->move_to(0.5, at({0, 0, z}))
      .move_to(1.5, at({0.03, 0, z}), MotionProfile::kSteady)
      .move_to(0.5, at({0.03, 0, start.p.z()}))
      .move_to(0.5, start);
  scene.hand = motion;
  scene.judged_from_s = 1.0;
  scene.judged_to_s = 1.95;
  scene.truth = [k = scene.coupling, mu = scene.friction](const Pose& X_WH, double skin) {
    const double load = kBlock.z() + skin - X_WH.p.z();
    return stretch(k, {-mu * load, 0, load}, Vec3::Zero());
  };
  return scene;
}

/// A rest of a second at half the force at which it should slide, then a motion beyond it.
FeelScene stick_slip() {
  FeelScene scene = rubbed_block();
  const Pose start = at({0, 0, kBlock.z() + 0.002});
  const double z = kBlock.z() - 0.008;
  auto motion = std::make_shared<ScriptedMotion>(start);
  motion->move_to(0.5, at({0, 0, z}))
      .move_to(0.3, at({0.0012, 0, z}))
      .hold(1.2)
      .move_to(2.0, at({0.004, 0, z}), MotionProfile::kSteady)
      .move_to(0.5, start);
  scene.hand = motion;
  scene.judged_from_s = 1.0;
  scene.judged_to_s = 2.0;
  scene.begins_to_slide = true;
  // Its own friction as the truth of the resting time: all of the coupling's pull, as it does not move.
  scene.truth = [k = scene.coupling](const Pose& X_WH, double skin) {
    return stretch(k, {-X_WH.p.x(), 0, kBlock.z() + skin - X_WH.p.z()}, Vec3::Zero());
  };
  return scene;
}

}  // namespace

const std::vector<FeelSceneEntry>& feel_scenes() {
  static const std::vector<FeelSceneEntry> entries = {
      {"block on plane", block_on_plane},
      {"wedge in a V-groove", wedge_in_groove},
      {"edge on plane", edge_on_plane},
      {"corner on plane", corner_on_plane},
      {"cylinder in a hole", cylinder_in_hole},
      {"sliding over facets", sliding_over_facets},
      {"sliding with friction", sliding_with_friction},
      {"stick-slip threshold", stick_slip},
  };
  return entries;
}

FeelScene peg_scene(double clearance_m, int hand) {
  FeelScene scene;
  Polytope peg = peg_pieces({0, 0.025, 0.025, 0.06, 0.001})->front();
  std::vector<Vec3> corners;
  for (const Vec3& v : peg.vertices) corners.push_back(v - Vec3(0, 0, 0.03));  // grasped in its middle
  scene.grasped = {hull(corners)};
  scene.fixed = pieces_of(*hole_block_pieces({0, 0.025, 0.025, clearance_m, 0.025, 0.03, 0.005}));
  scene.coupling.stiffness_Nm_per_rad = 0.6;
  scene.coupling.damping_Nms_per_rad = 0.001;
  Random random(static_cast<std::uint64_t>(100 + hand));
  const auto off = [&](double size) {
    const double x = random.uniform(-size, size), y = random.uniform(-size, size);
    return Vec3(x, y, random.uniform(-size, size));
  };
  const Vec3 over(0, 0, 0.065);  // 5 mm over the block
  auto motion = std::make_shared<ScriptedMotion>(at(over + Vec3(0.004, 0, 0)));
  while (motion->duration_s() < 4.0) {
    const double depth = random.uniform(-0.047, -0.004);  // mostly far too deep: 12 mm into the floor is 7 N
    const Vec3 turn = off(3.0 * kDegree);
    const Vec3 place = over + Vec3(0, 0, depth) + off(0.003);
    motion->move_to(random.uniform(0.1, 0.8), at(place, turn));
  }
  motion->move_to(1.0, at(over - Vec3(0, 0, 0.004)))
      .move_to(1.5, at(over - Vec3(0, 0, 0.037)))
      .hold(0.5)
      .move_to(1.5, at(over + Vec3(0, 0, 0.010)))
      .hold(0.3);
  scene.hand = motion;
  return scene;
}

}  // namespace tactum::bench
