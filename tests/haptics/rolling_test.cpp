/// Balls and cylinders that roll, true ones and ones of facets, against mechanics in closed form.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "support/effort.h"
#include "support/sandbox.h"
#include "tactum/geometry/hull.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/round_part.h"

namespace tactum::rolling_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

/// Those of surfaces are felt by their triangles.
enum class Form {
  kTrueBall,
  kFacetedBall,
  kTrueCylinder,
  kFacetedCylinder,
  kSurfaceBall,
  kSurfaceCylinder,
  kTube,
  kWheelset,
  kTubeOfPieces,
  kCask
};
constexpr std::array kForms{Form::kTrueBall, Form::kFacetedBall, Form::kTrueCylinder, Form::kFacetedCylinder};
constexpr std::array kSurfaceForms{Form::kSurfaceBall, Form::kSurfaceCylinder, Form::kTube, Form::kWheelset};
constexpr std::array kFormsOfPieces{Form::kTubeOfPieces, Form::kCask};
constexpr double kBore = 0.6;    // of a tube's radius
constexpr double kAxle = 0.4;    // of a wheel's radius
constexpr double kWheels = 0.5;  // length of both wheels, of that of the set

bool is_ball(Form form) {
  return form == Form::kTrueBall || form == Form::kFacetedBall || form == Form::kSurfaceBall;
}
bool is_true(Form form) { return form == Form::kTrueBall || form == Form::kTrueCylinder; }
/// The inertia about the axis, in units of m r^2: that of the curved solid, where the form has its mass.
double gyration(Form form, const Body& body, double r) {
  if (is_true(form)) return is_ball(form) ? 0.4 : 0.5;
  const Vec3 y_B = body.X_WB.R.transpose().col(1);
  return y_B.dot(body.inertia_B * y_B) / (body.mass_kg * r * r);
}

/// A part turned about z: the outline is one of (radius, height), counter-clockwise with z up, and closed.
std::shared_ptr<const Part> turned_part(const std::vector<std::array<double, 2>>& outline, int sides,
                                        PieceSource pieces = PieceSource::kSurface) {
  TriangleMesh mesh;
  const int rows = static_cast<int>(outline.size());
  for (const auto& [radius, height] : outline)
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * kPi * k / sides;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < sides; ++k) {
      const int a = row * sides + k;
      const int b = row * sides + (k + 1) % sides;
      const int c = (row + 1) % rows * sides + (k + 1) % sides;
      const int d = (row + 1) % rows * sides + k;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  Result<Part> part = part_from_mesh(mesh, {.pieces = pieces, .about_center_of_mass = true});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

std::shared_ptr<const Part> surface_of(const Polytope& shape) {
  return std::make_shared<const Part>(
      *part_from_mesh(solid_of(shape)->surface, {.pieces = PieceSource::kSurface}));
}

std::shared_ptr<const Part> part_of(Form form, double r) {
  switch (form) {
    case Form::kTrueBall:
      return std::make_shared<const Part>(*round_part(make_ball(r, 2)));
    case Form::kFacetedBall:
      return solid_of(make_icosphere(2, r));
    case Form::kTrueCylinder:
      return std::make_shared<const Part>(*round_part(make_cylinder(r, 1.5 * r, 16)));
    case Form::kSurfaceBall:
      return surface_of(make_icosphere(2, r));
    case Form::kSurfaceCylinder:
      return surface_of(make_prism(32, r, 1.5 * r));
    case Form::kTube: {
      const double half = 0.75 * r;
      return turned_part({{r, -half}, {r, half}, {kBore * r, half}, {kBore * r, -half}}, 32);
    }
    case Form::kWheelset: {  // an axle between two wheels, hollow like a straw for its mesh to be closed
      const double half = 1.5 * r, inner = (1.0 - kWheels) * half, straw = 1e-3 * r;
      return turned_part({{r, -half},
                          {r, -inner},
                          {kAxle * r, -inner},
                          {kAxle * r, inner},
                          {r, inner},
                          {r, half},
                          {straw, half},
                          {straw, -half}},
                         32);
    }
    case Form::kTubeOfPieces: {
      const double half = 0.75 * r;
      return turned_part({{r, -half}, {r, half}, {kBore * r, half}, {kBore * r, -half}}, 24,
                         PieceSource::kSolid);
    }
    case Form::kCask: {
      std::vector<Vec3> cloud;
      for (int k = 0; k < 24; ++k)
        for (const double z : {-1.0, -0.5, 0.5, 1.0}) {
          const double radius = std::abs(z) < 1.0 ? r : 0.8 * r;
          cloud.emplace_back(radius * std::cos(kPi * k / 12.0), radius * std::sin(kPi * k / 12.0), z * r);
        }
      return solid_of(*convex_hull(cloud));
    }
    case Form::kFacetedCylinder:
      break;
  }
  return solid_of(make_prism(16, r, 1.5 * r));
}

enum class Floor { kOneBody, kTiles, kPieces, kSurface };

struct Roll {
  Form form = Form::kTrueBall;
  double radius_m = 0.02;
  double slope_rad = 0.1;
  double friction = 0.5;
  double rate_Hz = 1000.0;
  ResponseModel response = ResponseModel::kConstraint;
  Floor floor = Floor::kOneBody;
  Vec3 turn{0.3, -0.7, 0.2};   // of the facets
  double speed_m_per_s = 0.0;  // at which it rolls at the start
  bool floor_first = true;
};

std::ostream& operator<<(std::ostream& out, const Roll& roll) {
  return out << "form " << static_cast<int>(roll.form) << ", r " << roll.radius_m << " m, slope "
             << roll.slope_rad << ", friction " << roll.friction << ", " << roll.rate_Hz << " Hz, response "
             << static_cast<int>(roll.response) << ", floor " << static_cast<int>(roll.floor);
}

struct Rolling {
  Sandbox box;
  int body = -1;
};

/// A floor whose top is z = 0, from x = -2 r to far enough.
void add_floor(const Roll& roll, Sandbox& box) {
  const double r = roll.radius_m;
  const double length = 3.0 + 4.0 * r;
  const int tiles = roll.floor == Floor::kTiles || roll.floor == Floor::kPieces ? 12 : 1;
  std::vector<std::vector<Vec3>> clouds;
  for (int i = 0; i < tiles; ++i) {
    const double middle = -2.0 * r + length * (i + 0.5) / tiles;
    const Polytope tile = make_box({0.5 * length / tiles, 4.0 * r, r});
    const Pose X{Mat3::Identity(), {middle, 0.0, -r}};
    if (roll.floor == Floor::kSurface) {
      add_body(box.world, {.part = surface_of(tile), .X_WP = X, .joint = {.kind = JointKind::kFixed}});
    } else if (roll.floor != Floor::kPieces) {
      box.add_fixed(tile, X);
    }
    if (roll.floor != Floor::kPieces) continue;
    clouds.emplace_back();
    for (const Vec3& p : tile.vertices) clouds.back().push_back(X * p);
  }
  if (roll.floor != Floor::kPieces) return;
  add_body(box.world,
           {.part = std::make_shared<const Part>(*part_from_clouds(clouds, {.about_center_of_mass = true})),
            .joint = {.kind = JointKind::kFixed}});
}

/// Gravity leans by the slope: the floor stays level, and downhill is +x. A cylinder's axis is y.
Rolling rolling(const Roll& roll) {
  Rolling made;
  made.box.settings.dt_s = 1.0 / roll.rate_Hz;
  made.box.settings.response = roll.response;
  made.box.world.gravity_W = kGravity * Vec3(std::sin(roll.slope_rad), 0.0, -std::cos(roll.slope_rad));
  if (roll.floor_first) add_floor(roll, made.box);
  const double r = roll.radius_m;
  const Mat3 R = is_ball(roll.form) ? exp_rotation(roll.turn)
                                    : exp_rotation({kPi / 2, 0, 0}) * exp_rotation({0, 0, roll.turn.x()});
  const double v = roll.speed_m_per_s;
  made.body = add_body(
      made.box.world,
      {.part = part_of(roll.form, r), .X_WP = {R, {0.0, 0.0, r}}, .V_WB = {{v, 0, 0}, {0, v / r, 0}}});
  if (!roll.floor_first) add_floor(roll, made.box);
  made.box.rub(roll.friction);
  return made;
}

/// The displacement after a second, and the spin, as fractions of their closed forms.
void expect_rolls(const Roll& roll, double tolerance) {
  SCOPED_TRACE(::testing::Message() << roll);
  Rolling made = rolling(roll);
  const double k =
      gyration(roll.form, made.box.world.bodies[static_cast<std::size_t>(made.body)], roll.radius_m);
  const double pull = kGravity * std::sin(roll.slope_rad);
  const double most = roll.friction * kGravity * std::cos(roll.slope_rad);
  const bool slips = pull * k / (1.0 + k) > most;
  const double a = slips ? pull - most : pull / (1.0 + k);
  const double spin = (slips ? most / k : a) / roll.radius_m;
  const double time_s = 0.7;
  made.box.run(time_s);
  const Vec3 p = made.box.X(made.body).p;
  EXPECT_NEAR(p.x() / (0.5 * a * time_s * time_s), 1.0, tolerance);
  EXPECT_NEAR(p.y(), 0.0, 1e-7 * p.x());
  EXPECT_NEAR(p.z(), roll.radius_m, 1e-4 * roll.radius_m);
  // The state's velocity is that of the middle of the last frame.
  const double middle_s = time_s - 0.5 * made.box.settings.dt_s;
  const Vec3 w = made.box.begun().world.V_WB[static_cast<std::size_t>(made.body)].w;
  EXPECT_NEAR(w.y() / (spin * middle_s), 1.0, tolerance + 2e-4);
  EXPECT_LT(std::hypot(w.x(), w.z()), 1e-6 * w.y());
  EXPECT_EQ(made.box.penetrating_frames, 0);
}

double tolerance_of(Form form) { return is_true(form) ? 2e-5 : 1e-3; }

TEST(Rolling, DownAnInclineAsSevenFifthsAndThreeHalvesOfTheMassDo) {
  for (const Form form : kForms) {
    const auto each = [&](Roll roll) {
      roll.form = form;
      expect_rolls(roll, tolerance_of(form));
    };
    each({});
    each({.response = ResponseModel::kPenalty});
    if (testing::kSanitized) continue;
    for (const double slope : {0.01, 0.3}) each({.slope_rad = slope});
    for (const double r : {0.001, 0.2, 1.0}) each({.radius_m = r});
    for (const double rate : {500.0, 4000.0}) each({.rate_Hz = rate});
    each({.turn = {0, 0, 0}});
    each({.turn = {1.0, 2.0, -0.5}});
    each({.floor_first = false});
  }
}

TEST(Rolling, SlidesWhereFrictionIsTooSmallToRoll) {
  for (const Form form : kForms)
    for (const double share : {0.5, 0.9}) {  // of the friction that rolling takes
      Roll roll{.form = form, .slope_rad = 0.4};
      const Rolling made = rolling(roll);
      const double k =
          gyration(form, made.box.world.bodies[static_cast<std::size_t>(made.body)], roll.radius_m);
      roll.friction = share * std::tan(roll.slope_rad) * k / (1.0 + k);
      expect_rolls(roll, 1e-4);
    }
}

TEST(Rolling, OverTilesAndPiecesAsOverOneFloor) {
  for (const Form form : kForms)
    for (const Floor floor : {Floor::kTiles, Floor::kPieces})
      expect_rolls({.form = form, .slope_rad = 0.3, .floor = floor}, 2.0 * tolerance_of(form));
}

TEST(Rolling, OverAPartThatIsFeltByItsSurface) {
  for (const Form form : kForms)
    for (const bool floor_first : {true, false})
      expect_rolls({.form = form, .floor = Floor::kSurface, .floor_first = floor_first}, tolerance_of(form));
}

TEST(Rolling, PartsThatAreFeltByTheirSurface) {
  for (const Form form : kSurfaceForms)
    for (const Floor floor : {Floor::kOneBody, Floor::kSurface}) {
      const auto each = [&](Roll roll) {
        roll.form = form;
        roll.floor = floor;
        expect_rolls(roll, tolerance_of(form));
      };
      each({});
      if (testing::kSanitized || floor == Floor::kOneBody) continue;
      each({.response = ResponseModel::kPenalty});
      each({.slope_rad = 0.3, .floor_first = false});
      each({.radius_m = 0.003});
      each({.radius_m = 0.5, .rate_Hz = 500.0});
      each({.rate_Hz = 4000.0, .turn = {1.0, 2.0, -0.5}});
      each({.slope_rad = 0.4, .friction = 0.05});
    }
}

TEST(Rolling, TurnedPartsThatAreMadeOfPieces) {
  for (const Form form : kFormsOfPieces)
    for (const bool floor_first : {true, false})
      for (const Floor floor : {Floor::kOneBody, Floor::kSurface}) {
        expect_rolls({.form = form, .floor = floor, .floor_first = floor_first}, tolerance_of(form));
        expect_rolls({.form = form,
                      .radius_m = 0.2,
                      .slope_rad = 0.3,
                      .response = ResponseModel::kPenalty,
                      .floor = floor,
                      .floor_first = floor_first},
                     tolerance_of(form));
      }
}

/// A wheelset on rails under its axle goes down by the axle's radius, and is felt by edges where rails end.
TEST(Rolling, AnAxleRollsOnRailsThatAreNarrowerThanIt) {
  for (const bool rails_by_surface : {false, true})
    for (const double r : {0.004, 0.03}) {
      SCOPED_TRACE(::testing::Message() << "radius " << r << " m, surface " << rails_by_surface);
      Sandbox box;
      const double slope_rad = 0.1;
      box.world.gravity_W = kGravity * Vec3(std::sin(slope_rad), 0.0, -std::cos(slope_rad));
      const double axle = kAxle * r;
      for (const double side : {-1.0, 1.0}) {
        const Polytope rail = make_box({1.0, 0.1 * r, 2.0 * r});
        add_body(box.world, {.part = rails_by_surface ? surface_of(rail) : solid_of(rail),
                             .X_WP = {Mat3::Identity(), {0.5, side * 0.4 * r, -2.0 * r}},
                             .joint = {.kind = JointKind::kFixed}});
      }
      const int wheels = add_body(box.world, {.part = part_of(Form::kWheelset, r),
                                              .X_WP = {exp_rotation({kPi / 2, 0, 0}), {0, 0, axle}}});
      box.rub(0.5);
      const double time_s = 0.5;
      box.run(time_s);
      const double k = gyration(Form::kWheelset, box.world.bodies[static_cast<std::size_t>(wheels)], axle);
      const double x = 0.5 * kGravity * std::sin(slope_rad) / (1.0 + k) * time_s * time_s;
      EXPECT_NEAR(box.X(wheels).p.x() / x, 1.0, 0.02);
      EXPECT_NEAR(box.X(wheels).p.z(), axle, 1e-3 * axle);
      EXPECT_EQ(box.penetrating_frames, 0);
    }
}

TEST(Rolling, OnTheLevelKeepsItsSpeed) {
  for (const Form form : kForms) {
    SCOPED_TRACE(static_cast<int>(form));
    Rolling made = rolling({.form = form, .slope_rad = 0.0, .speed_m_per_s = 1.0});
    made.box.run(2.0);
    const Twist V = made.box.V(made.body);
    EXPECT_NEAR(V.v.x(), 1.0, is_true(form) ? 2e-5 : 0.02);
    EXPECT_NEAR(V.w.y() * 0.02, 1.0, is_true(form) ? 2e-5 : 0.02);
    EXPECT_NEAR(V.v.y(), 0.0, 1e-7);
  }
}

TEST(Rolling, SharpPrismsDoNot) {
  for (const int sides : {4, 6}) {
    Sandbox box;
    box.world.gravity_W = kGravity * Vec3(std::sin(0.2), 0.0, -std::cos(0.2));
    box.add_fixed(make_box({1.0, 0.1, 0.02}), {Mat3::Identity(), {0, 0, -0.02}});
    const double r = 0.02;
    const double low = r * std::cos(kPi / sides);
    const double turn = sides == 4 ? kPi / 4 : 0.0;  // a side faces down
    const Mat3 R = exp_rotation({kPi / 2, 0, 0}) * exp_rotation({0, 0, turn});
    const int nut = box.add(make_prism(sides, r, 0.03), {R, {0, 0, low}});
    box.rub(0.8);
    box.run(1.0);
    EXPECT_NEAR(box.X(nut).p.x(), 0.0, 1e-7);
  }
}

TEST(Rolling, ABallLeavesTheFloorWithoutSpin) {
  for (const Form form : {Form::kTrueBall, Form::kFacetedBall})
    for (const double r : {0.002, 0.02, 0.5})
      for (const Vec3& turn : {Vec3(0.3, -0.7, 0.2), Vec3(2.0, 1.0, 0.5)}) {
        Sandbox box;
        box.world.gravity_W = {0, 0, -kGravity};
        box.add_fixed(make_box({5.0 * r, 5.0 * r, r}), {Mat3::Identity(), {0, 0, -r}});
        const double drop = 0.05;
        const double e = 0.7;
        const int ball =
            add_body(box.world, {.part = part_of(form, r), .X_WP = {exp_rotation(turn), {0, 0, r + drop}}});
        box.rub(0.5);
        box.bounce(e);
        const double fall_s = std::sqrt(2.0 * drop / kGravity);
        box.run(fall_s * (1.0 + e));
        EXPECT_NEAR((box.X(ball).p.z() - r) / drop, e * e, 1e-3);
        EXPECT_LT(box.V(ball).w.norm() * r, 1e-6);
        EXPECT_LT(std::hypot(box.X(ball).p.x(), box.X(ball).p.y()), 1e-6 * drop);
      }
}

/// Two equal true balls meet aside, without friction: what is along the line of their centres is exchanged.
/// The line is taken at the start of the frame of the impact, so it is right to the first order of the step.
/// (Two balls of facets meet by these: Bounce.ABallHitAside.)
TEST(Rolling, BallsThatMeetAsideExchangeTheirSpeedAlongTheirCentres) {
  const double r = 0.02;
  const Form form = Form::kTrueBall;
  for (const double rate_Hz : {1000.0, 4000.0})
    for (const double aside : {0.0, 0.7, 1.3}) {  // radii
      Sandbox box;
      box.settings.dt_s = 1.0 / rate_Hz;
      add_body(box.world, {.part = part_of(form, r),
                           .X_WP = {exp_rotation({1, 2, 3}), {-3.0 * r, 0, 0}},
                           .V_WB = {{1, 0, 0}, Vec3::Zero()}});
      add_body(box.world,
               {.part = part_of(form, r), .X_WP = {exp_rotation({-1, 0.4, 2}), {0, aside * r, 0}}});
      box.bounce(1.0);
      const double energy = box.energy();
      box.run(0.1);
      const Vec3 n = Vec3(std::sqrt(4.0 - aside * aside), aside, 0) / 2.0;
      const double turn = 1.0 / rate_Hz / r;  // of the line in a frame, at most
      EXPECT_LT((box.V(1).v - n.x() * n).norm(), turn);
      EXPECT_LT((box.V(0).v - (Vec3(1, 0, 0) - n.x() * n)).norm(), turn);
      EXPECT_LT((box.V(0).w.norm() + box.V(1).w.norm()) * r, 2.0 * turn);
      EXPECT_NEAR(box.energy(), energy, 1e-9 * energy);
      EXPECT_EQ(box.penetrating_frames, 0);
    }
}

/// A plate on three balls, pushed along: the balls go half as far.
TEST(Rolling, BallsCarryAPlate) {
  for (const Form form : {Form::kTrueBall, Form::kFacetedBall}) {
    SCOPED_TRACE(static_cast<int>(form));
    Sandbox box;
    const double r = 0.01;
    box.world.gravity_W = {0, 0, -kGravity};
    box.add_fixed(make_box({1.0, 0.1, 0.02}), {Mat3::Identity(), {0, 0, -0.02}});
    const std::array<Vec3, 3> places{Vec3(-0.06, 0.0, r), Vec3(0.06, -0.03, r), Vec3(0.06, 0.03, r)};
    double mass_kg = 0.0;
    std::vector<int> balls;
    const Mat3 R = exp_rotation({0.7, -0.4, 0.2});
    for (const Vec3& p : places)
      balls.push_back(add_body(box.world, {.part = part_of(form, r), .X_WP = {R, p}}));
    for (const int ball : balls) mass_kg += box.world.bodies[static_cast<std::size_t>(ball)].mass_kg;
    const double push_N = 0.2;
    const Polytope plate_shape = make_box({0.1, 0.05, 0.005});
    const int plate = add_body(box.world, {.part = solid_of(plate_shape),
                                           .X_WP = {Mat3::Identity(), {0, 0, 2.0 * r + 0.005}},
                                           .load = {.constant = {{push_N, 0, 0}, Vec3::Zero()}}});
    box.rub(0.5);
    box.run(0.4);
    const double plate_kg = box.world.bodies[static_cast<std::size_t>(plate)].mass_kg;
    const double k = gyration(form, box.world.bodies[static_cast<std::size_t>(balls[0])], r);
    const double a = push_N / (plate_kg + 0.25 * (1.0 + k) * mass_kg);
    const double x = 0.5 * a * 0.4 * 0.4;
    EXPECT_NEAR(box.X(plate).p.x() / x, 1.0, 0.01);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((box.X(balls[i]).p.x() - places[i].x()) / x, 0.5, 0.01);
    EXPECT_EQ(box.penetrating_frames, 0);
  }
}

/// A ball lies in a groove of two sides at 45 degrees: each carries m g / sqrt(2).
TEST(Rolling, ABallRestsInAGroove) {
  for (const Form form : {Form::kTrueBall, Form::kFacetedBall})
    for (const double mu : {0.0, 0.4}) {
      Sandbox box;
      const double r = 0.01;
      box.world.gravity_W = {0, 0, -kGravity};
      for (const double sign : {-1.0, 1.0}) {
        const Mat3 tilt = exp_rotation({0, sign * kPi / 4, 0});
        box.add_fixed(make_box({0.03, 0.03, 0.005}), {tilt, tilt * Vec3(0, 0, -0.005)});
      }
      const int ball = add_body(
          box.world,
          {.part = part_of(form, r), .X_WP = {exp_rotation({0.4, 0.1, 0.9}), {0, 0, std::sqrt(2.0) * r}}});
      box.rub(mu);
      box.run(0.5);
      const Vec3 p = box.X(ball).p;
      box.run(0.5);
      EXPECT_LT((box.X(ball).p - p).norm(), 1e-8);
      EXPECT_EQ(box.penetrating_frames, 0);
      EXPECT_NEAR(p.z() / (std::sqrt(2.0) * r), 1.0, 1e-4);
      const double weight = kGravity * box.world.bodies[static_cast<std::size_t>(ball)].mass_kg;
      std::array<double, 2> load_N{};
      for (const ContactRow& row : box.begun().response.rows())
        load_N[row.body_a == 0 || row.body_b == 0 ? 0 : 1] += row.impulse / box.settings.dt_s;
      if (mu > 0.0) continue;
      EXPECT_NEAR(load_N[0] / weight, std::sqrt(0.5), 1e-4);
      EXPECT_NEAR(load_N[1] / weight, std::sqrt(0.5), 1e-4);
    }
}

}  // namespace
}  // namespace tactum::rolling_test
