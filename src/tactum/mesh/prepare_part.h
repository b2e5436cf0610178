#pragma once
/// From a mesh as files hold it to a part that is proved to be that mesh:
///
///   mesh -> unit -> repair -> mass -> pieces -> verification -> part file
///
/// Each stage reports its findings and changes. Verification is code of its own (deviation.h,
/// piece_overlap.h): the surfaces must agree in both directions to kSurfaceDeviation, volumes and areas must
/// add up, no two solid pieces may overlap. A part that fails is not written; when the method was chosen
/// automatically, the next one is tried.
///
/// The methods to make pieces, in the order "auto" tries them, are listed in one table in prepare_pieces.cpp.

#include <functional>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/deviation.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/mesh/part_file.h"
#include "tactum/mesh/piece_overlap.h"
#include "tactum/repair/mesh_repair.h"

namespace tactum::inline v0_1 {

struct PrepareOptions {
  std::string name = {};              ///< of the part
  std::string unit = "auto";          ///< of the mesh's numbers: auto, m, cm, mm, inch
  double scale = 0.0;                 ///< metres per unit of the mesh's numbers; 0: as `unit` says [m]
  std::string pieces = "auto";        ///< the method: auto, or one of pieces_ways()
  int close_holes = 0;                ///< holes of at most this many edges are closed; 0: none
  double density_kg_per_m3 = 1000.0;  ///< [kg/m^3]
  int threads = 1;                    ///< the part does not depend on it
  int area_samples = kAreaSamples;    ///< of the verification, over either surface, beside corners and sides
};

/// The measurements of verification.
struct Verification {
  Deviation deviation;
  PieceOverlaps overlaps;
  double mesh_volume = -1.0;    ///< that solid pieces must have together; negative: not known [m^3]
  double pieces_volume = -1.0;  ///< that they have; negative: the part is a surface [m^3]
  double mesh_area = -1.0;      ///< that the faces must have together; negative: cuts add to it [m^2]
  double pieces_area = 0.0;     ///< that they have [m^2]
};

/// All numbers of a preparation; the part file keeps them as JSON.
struct PrepareReport {
  std::string format;
  UnitGuess unit;
  std::vector<RepairNote> notes;
  std::vector<MeshComponent> components;
  MeshReport mesh;  ///< after repair
  std::string pieces;
  std::string pieces_reason;
  Verification verification;
};

/// Called before each stage; `share` is the fraction of the work that is done, 0 to 1.
using PrepareProgress = std::function<void(const char* stage, double share)>;

/// Prepares a mesh in the units of its file. An error says what makes it unusable and where.
Result<PartFile> prepare_part(ImportedMesh given, const PrepareOptions& options,
                              const PrepareProgress& progress = {});

/// The names of the methods to make pieces.
std::vector<std::string> pieces_ways();

/// Verifies a part with its frame at `origin` against the mesh it was made of, in metres. `reference` is the
/// mesh before repair with the triangles that close holes; volume and area as in Verification, negative: not
/// checked.
Verification verify_part(const TriangleMesh& reference, const Part& part, const Vec3& origin, double volume,
                         double area, int area_samples = kAreaSamples, int threads = 1);

/// The faults that verification found, as an error; nothing when the part passes.
Result<void> verdict_on(const Verification& found, const std::string& name);

std::string to_json(const PrepareReport& report, const Part& part);

}  // namespace tactum::inline v0_1
