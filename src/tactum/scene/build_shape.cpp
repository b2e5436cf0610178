#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "tactum/geometry/hull.h"
#include "tactum/geometry/primitives.h"
#include "tactum/mesh/round_part.h"
#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

using Made = Result<Shape>;

Made shape_of(Result<std::vector<Polytope>> pieces) {
  if (!pieces) return pieces.error();
  Shape shape;
  shape.pieces = std::move(*pieces);
  return shape;
}

Made shape_of(const Polytope& piece) { return shape_of(std::vector<Polytope>{piece}); }

Made shape_of(const RoundSolid& solid) {
  Made shape = shape_of(solid.facets);
  shape->stands_for = solid.surface;
  return shape;
}

Made shape_of(Result<TriangleMesh> mesh) {
  if (!mesh) return mesh.error();
  Shape shape;
  shape.mesh.mesh = std::move(*mesh);
  shape.piece_source = PieceSource::kSurface;
  return shape;
}

/// On rings of the two half balls: a quarter of the sides from the equator to the pole.
std::vector<Vec3> capsule_corners(const CapsulePart& part) {
  const double half_m = 0.5 * part.height_m;
  std::vector<Vec3> corners{{0.0, 0.0, half_m + part.radius_m}, {0.0, 0.0, -half_m - part.radius_m}};
  for (int ring = 0; 4 * ring < part.sides; ++ring) {
    const double up = 2.0 * kPi * ring / part.sides;
    for (int i = 0; i < part.sides; ++i) {
      const double around = 2.0 * kPi * i / part.sides;
      const double across = part.radius_m * std::cos(up), z = half_m + part.radius_m * std::sin(up);
      for (const double side : {z, -z})
        corners.emplace_back(across * std::cos(around), across * std::sin(around), side);
    }
  }
  return corners;
}

/// One of the two parts of a fit.
enum class Mate { kShaft, kHole };

/// A part as it is made from its description, with errors of its fit at `path`.
class PartMaker {
 public:
  PartMaker(SceneBuilder& builder, const std::string& path) : builder_(builder), path_(path) {}

  Made make(const GearPart& part) const {
    return part.as == GearForm::kSurface ? shape_of(gear_surface(part.gear))
                                         : shape_of(gear_pieces(part.gear));
  }
  Made make(const PegPart& part) const {
    Peg peg = part.peg;
    peg.width_m = fitted(part.fit, Mate::kShaft, peg.width_m);
    if (peg.sides == 0) peg.depth_m = fitted(part.fit, Mate::kShaft, peg.depth_m);
    return shape_of(peg_pieces(peg));
  }
  Made make(const HoleBlockPart& part) const {
    HoleBlock block = part.block;
    block.peg_width_m = fitted(part.fit, Mate::kHole, block.peg_width_m);
    if (block.sides == 0) block.peg_depth_m = fitted(part.fit, Mate::kHole, block.peg_depth_m);
    const double narrower_m = part.fit.fit.empty() ? std::max(0.0, -block.clearance_m) : 0.0;
    block.peg_width_m -= narrower_m;
    block.peg_depth_m -= narrower_m;
    if (!part.fit.fit.empty() || narrower_m > 0.0) block.clearance_m = 0.0;
    return shape_of(hole_block_pieces(block));
  }
  Made make(const BoltPart& part) const { return shape_of(bolt_mesh(part.screw)); }
  Made make(const NutPart& part) const { return shape_of(nut_mesh(part.screw)); }
  Made make(const HexKeyPart& part) const {
    HexKey key = part.key;
    key.across_flats_m = fitted(part.fit, Mate::kShaft, key.across_flats_m);
    return shape_of(hex_key_pieces(key));
  }
  Made make(const SocketPart& part) const {
    HexSocket socket = part.socket;
    socket.across_flats_m = fitted(part.fit, Mate::kHole, socket.across_flats_m);
    const double narrower_m = part.fit.fit.empty() ? std::max(0.0, -socket.clearance_m) : 0.0;
    socket.across_flats_m -= narrower_m;
    if (!part.fit.fit.empty() || narrower_m > 0.0) socket.clearance_m = 0.0;
    return shape_of(hex_socket_pieces(socket));
  }
  Made make(const SlottedPlatePart& part) const { return shape_of(slotted_plate_pieces(part.plate)); }
  Made make(const BoxPart& part) const { return shape_of(make_box(0.5 * part.size_m)); }
  Made make(const SpherePart& part) const {
    return shape_of(make_icosphere(part.subdivisions, part.radius_m));
  }
  Made make(const BallPart& part) const { return shape_of(make_ball(part.radius_m, part.subdivisions)); }
  Made make(const CylinderPart& part) const {
    return shape_of(make_cylinder(part.radius_m, part.height_m, part.sides));
  }
  Made make(const EllipsoidPart& part) const {
    return shape_of(make_ellipsoid(part.subdivisions, part.radii_m));
  }
  Made make(const PrismPart& part) const {
    return shape_of(make_prism(part.sides, part.radius_m, part.height_m));
  }
  Made make(const CapsulePart& part) const {
    Result<Polytope> piece = convex_hull(capsule_corners(part));
    if (!piece) return piece.error();
    return shape_of(*piece);
  }

 private:
  /// The size as made: nominal when there is no fit.
  double fitted(const FitDescription& wanted, Mate mate, double nominal_m) const {
    if (wanted.fit.empty()) return nominal_m;
    const Result<Fit> fit = iso_fit(wanted.fit, nominal_m);
    if (!fit) {
      builder_.fail(item_path(path_, "fit"), fit.error());
      return nominal_m;
    }
    const FitPosition position = wanted.fit_position.value_or(FitPosition::kMid);
    return nominal_m + (mate == Mate::kHole ? fit->hole_m(position) : fit->shaft_m(position));
  }

  SceneBuilder& builder_;
  const std::string& path_;
};

/// A file that `tactum prepare` wrote: in metres, and cut.
void load_prepared(SceneBuilder& builder, const std::string& path, const MeshPart& part, Shape& shape) {
  const auto refuse = [&](const char* key) {
    builder.fail(item_path(path, key), fmt::format("\"{}\" is for meshes only", key), "a prepared part",
                 "none of it");
  };
  if (part.scale) refuse("scale");
  if (part.scale_xyz) refuse("scale_xyz");
  if (part.pieces) refuse("pieces");
  Result<PartFile> file = load_part(shape.file);
  if (!file) return builder.fail(item_path(path, MeshPart::kKind), file.error().message());
  shape.prepared = std::make_shared<const PartFile>(std::move(*file));
}

/// Each axis by its own scale; a mirrored mesh is turned outside in, which is mended.
void stretch(const Vec3& scale, TriangleMesh& mesh) {
  for (Vec3& vertex : mesh.vertices) vertex = vertex.cwiseProduct(scale);
  if (scale.prod() < 0.0)
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

Shape load_mesh(SceneBuilder& builder, const std::string& path, const MeshPart& part) {
  Shape shape;
  const PieceSource pieces = part.pieces.value_or(PieceSource::kAuto);
  shape.given = pieces == PieceSource::kGiven;
  shape.piece_source = shape.given ? PieceSource::kAuto : pieces;
  const std::string item = item_path(path, MeshPart::kKind);
  const std::optional<std::string> found = builder.find_file(item, "mesh", part.mesh);
  if (!found) return shape;
  shape.file = *found;
  if (is_part_file(shape.file)) {
    load_prepared(builder, path, part, shape);
    return shape;
  }
  ImportOptions options;
  options.scale = part.scale.value_or(1.0);
  Result<ImportedMesh> imported = import_mesh(shape.file, options);
  if (imported) {
    shape.mesh = std::move(*imported);
    if (part.scale_xyz) stretch(*part.scale_xyz, shape.mesh.mesh);
  } else {
    builder.fail(item, imported.error().message());
  }
  return shape;
}

}  // namespace

Shape build_shape(SceneBuilder& builder, const std::string& path, const PartDescription& part) {
  if (const auto* mesh = std::get_if<MeshPart>(&part)) return load_mesh(builder, path, *mesh);
  return std::visit(
      [&](const auto& kind) -> Shape {
        using Kind = std::decay_t<decltype(kind)>;
        if constexpr (!std::is_same_v<Kind, MeshPart>) {
          const std::string table = item_path(path, Kind::kKind);
          Made shape = PartMaker(builder, table).make(kind);
          if (shape) return std::move(*shape);
          builder.fail(table, shape.error());
        }
        return {};
      },
      part);
}

}  // namespace tactum::inline v0_1
