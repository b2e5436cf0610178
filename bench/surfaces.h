#pragma once
/// The cost of all minima of two surfaces, beside FCL's distance and Bullet's GImpact on the same poses: real
/// parts where the folder with them is given, and pairs made here.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/report.h"
#include "tactum/geometry/triangle_mesh.h"
#include "tactum/math/pose.h"

namespace tactum::bench {

/// Another library's query of two triangle surfaces; each in a file of its own that is compiled where it is
/// installed.
class SurfacePeer {
 public:
  SurfacePeer() = default;
  SurfacePeer(const SurfacePeer&) = delete;
  SurfacePeer& operator=(const SurfacePeer&) = delete;
  virtual ~SurfacePeer() = default;
  virtual void query(const Pose& X_AB) = 0;
};
/// FCL's distance of two BVHModel<OBBRSS>: the nearest pair alone.
std::unique_ptr<SurfacePeer> make_fcl_surfaces(const TriangleMesh& a, const TriangleMesh& b,
                                               double tolerance_m);

/// Bullet's GImpact: all pairs of triangles within the tolerance.
std::unique_ptr<SurfacePeer> make_gimpact_surfaces(const TriangleMesh& a, const TriangleMesh& b,
                                                   double tolerance_m);

struct SurfacesOptions {
  std::string data;                ///< folder of real meshes and motions; empty: only pairs made here
  std::vector<std::string> pairs;  ///< by name; empty: all
  int frames = 200;                ///< poses of each motion made here
  int replays = 5;                 ///< each pose counts with its fastest
  double peer_budget_s = 5.0;      ///< for each peer on each pair [s]
  bool quick = false;              ///< few poses, no large meshes
};

struct SurfacesRow {
  std::string pair;
  int triangles_a = 0, triangles_b = 0;
  double tolerance_m = 0.0;
  int frames = 0;
  double minima_mean = 0.0;  ///< found in a query
  int minima_max = 0;
  double leaf_pairs_mean = 0.0;                                     ///< work
  double feature_pairs_mean = 0.0;                                  ///< compared exactly
  double mean_ns = 0.0, p50_ns = 0.0, p99_ns = 0.0, p999_ns = 0.0;  ///< of the poses' fastest replays [ns]
  double max_ns = 0.0;                                              ///< [ns]
  double bytes_per_triangle = 0.0;
  double build_s = 0.0;          ///< both trees [s]
  double fcl_mean_ns = 0.0;      ///< 0: not measured [ns]
  double gimpact_mean_ns = 0.0;  ///< 0: not measured [ns]
};

struct SurfacesReport {
  std::vector<SurfacesRow> rows;
  std::string how;
};

/// The names of all pairs; `real` ones need the data.
std::vector<std::string> surface_pair_names();
SurfacesReport bench_surfaces(const SurfacesOptions& options,
                              const std::function<void(const std::string&)>& progress);

Table table_of(const SurfacesReport& report);
nlohmann::ordered_json to_json(const SurfacesRow& row);

}  // namespace tactum::bench
