#pragma once
/// The part of a body, as a value in memory: a file, or a shape made by rule. kKind is the key of the
/// alternative in the table `part` of a scene file. Numbers without a default there are 0 here, which is out
/// of their range.

#include <optional>
#include <string>
#include <variant>

#include "tactum/mesh/make_part.h"
#include "tactum/parts/bolt_and_nut.h"
#include "tactum/parts/gear.h"
#include "tactum/parts/generated_parts.h"
#include "tactum/parts/iso_fit.h"
#include "tactum/parts/slotted_plate.h"
#include "tactum/parts/socket.h"

namespace tactum::inline v0_1 {

/// A mesh, or a part that `tactum prepare` wrote: that one is in metres and cut, and takes no further member.
struct MeshPart {
  static constexpr const char* kKind = "mesh";
  std::string mesh = {};                   ///< the name of the file, see SceneSource::folders
  std::optional<double> scale = {};        ///< metres per unit of the file; 1 when absent [m]
  std::optional<Vec3> scale_xyz = {};      ///< ... or of each axis; below zero it mirrors [m]
  std::optional<PieceSource> pieces = {};  ///< kAuto when absent
};

/// A fit by its name, which sets the sizes of a peg or hole in place of a clearance. Empty: no fit.
struct FitDescription {
  std::string fit = {};                          ///< "H7/g6"
  std::optional<FitPosition> fit_position = {};  ///< kMid when absent; an error without a fit
};

/// The construction of a gear.
enum class GearForm {
  kPieces,  ///< convex pieces
  kSurface  ///< one closed mesh of the same solid
};

struct GearPart {
  static constexpr const char* kKind = "gear";
  Gear gear = {};
  GearForm as = GearForm::kPieces;
};

struct PegPart {
  static constexpr const char* kKind = "peg";
  Peg peg = {};
  FitDescription fit = {};
};

struct HoleBlockPart {
  static constexpr const char* kKind = "hole_block";
  HoleBlock block = {};  ///< its clearance_m is ignored when there is a fit
  FitDescription fit = {};
};

struct BoltPart {
  static constexpr const char* kKind = "bolt";
  ScrewShape screw = {};
};

struct NutPart {
  static constexpr const char* kKind = "nut";
  ScrewShape screw = {};  ///< its length_m is ignored
};

struct HexKeyPart {
  static constexpr const char* kKind = "hex_key";
  HexKey key = {};
  FitDescription fit = {};
};

struct SocketPart {
  static constexpr const char* kKind = "socket";
  HexSocket socket = {};  ///< its clearance_m is ignored when there is a fit
  FitDescription fit = {};
};

struct SlottedPlatePart {
  static constexpr const char* kKind = "slotted_plate";
  SlottedPlate plate = {};
};

struct BoxPart {
  static constexpr const char* kKind = "box";
  Vec3 size_m = Vec3::Zero();  ///< whole sides [m]
};

struct SpherePart {
  static constexpr const char* kKind = "sphere";
  double radius_m = 0.0;  ///< [m]
  int subdivisions = 2;   ///< of an icosahedron's facets, 0 to 5 [-]
};

/// A true ball: its surface is exact; facets are what is drawn.
struct BallPart {
  static constexpr const char* kKind = "ball";
  double radius_m = 0.0;  ///< [m]
  int subdivisions = 2;   ///< as of a sphere, of what is drawn [-]
};

/// A cylinder about z, exact as a ball is.
struct CylinderPart {
  static constexpr const char* kKind = "cylinder";
  double radius_m = 0.0;  ///< [m]
  double height_m = 0.0;  ///< [m]
  int sides = 32;         ///< facets around it, 8 to 1024 [-]
};

struct EllipsoidPart {
  static constexpr const char* kKind = "ellipsoid";
  Vec3 radii_m = Vec3::Zero();  ///< [m]
  int subdivisions = 2;         ///< as of a sphere [-]
};

struct PrismPart {
  static constexpr const char* kKind = "prism";
  int sides = 0;          ///< 3 to 1024 [-]
  double radius_m = 0.0;  ///< of the circle its corners lie on [m]
  double height_m = 0.0;  ///< [m]
};

/// A cylinder about z with half a ball on either end, of facets.
struct CapsulePart {
  static constexpr const char* kKind = "capsule";
  double radius_m = 0.0;  ///< [m]
  double height_m = 0.0;  ///< of the cylinder alone, without the balls [m]
  int sides = 32;         ///< facets around it, a multiple of 4 from 8 to 256 [-]
};

using PartDescription = std::variant<MeshPart, GearPart, PegPart, HoleBlockPart, BoltPart, NutPart,
                                     HexKeyPart, SocketPart, SlottedPlatePart, BoxPart, SpherePart, BallPart,
                                     CylinderPart, EllipsoidPart, PrismPart, CapsulePart>;

}  // namespace tactum::inline v0_1
