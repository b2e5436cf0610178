#include "bench/schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "bench/heap.h"
#include "bench/overlap.h"
#include "bench/quantile.h"
#include "tactum/base/hash.h"
#include "tactum/haptics/frame_hash.h"
#include "tactum/haptics/simulation.h"

namespace tactum::bench {
namespace {

using Index = std::size_t;

/// No pair of a heap is ever left with this many tests.
constexpr int kNoLimit = 100'000'000;
/// Heaps whose frames the model is fitted to, as fractions of the bodies.
constexpr double kModelHeaps[] = {0.1, 0.25, 0.5, 1.0};
constexpr double kModelShare = 0.1;  // of the pairs
constexpr double kModelSeconds = 0.6;

/// A heap and an ideal device that follows its hand.
class HeapRun {
 public:
  HeapRun(const Scene& scene, int budget) : hand_(scene.hand) {
    FrameSettings settings = scene.settings;
    settings.budget.max_exact_tests = budget;
    simulation_ = std::move(*Simulation::make(scene.world, std::move(settings)));
  }
  const FrameReport& step() {
    const Pose X_DH = hand_->at(simulation_->time_s()).X_DH;
    const auto begin = std::chrono::steady_clock::now();
    simulation_->step(X_DH);
    frame_ns_ =
        static_cast<double>(std::chrono::nanoseconds(std::chrono::steady_clock::now() - begin).count());
    return simulation_->report();
  }
  /// The raw wrench of the next frame, when nothing is left out.
  Wrench next_without_limit() {
    FrameState copy(simulation_->state());
    FrameSettings settings = simulation_->settings();
    settings.budget.max_exact_tests = kNoLimit;
    FrameTick tick;
    tick.index = simulation_->next_index();
    tick.now_s = simulation_->time_s();
    DeviceSample sample;
    sample.valid = true;
    sample.time_s = tick.now_s;
    sample.X_DH = hand_->at(tick.now_s).X_DH;
    FrameReport report;
    haptic_frame(simulation_->world(), settings, sample, tick, copy, report);
    return report.coupling;
  }
  const WorldState& at() const { return simulation_->bodies(); }
  double frame_ns() const { return frame_ns_; }

 private:
  std::shared_ptr<const HandMotion> hand_;
  std::unique_ptr<Simulation> simulation_;
  double frame_ns_ = 0.0;
};

/// Measures the overlap of all pieces of all bodies.
class HeapReferee {
 public:
  explicit HeapReferee(const World& world) : world_(world) {
    for (const Body& body : world.bodies) {
      bodies_.emplace_back();
      radius_.push_back(0.0);
      for (const Polytope& piece : body.part->pieces) {
        bodies_.back().push_back(overlap_piece(piece, Pose()));
        for (const Vec3& p : piece.vertices) radius_.back() = std::max(radius_.back(), p.norm());
      }
    }
  }
  void look(const std::vector<Pose>& X_WB, ScheduleRow& row) const {
    for (Index a = 0; a < bodies_.size(); ++a)
      for (Index b = a + 1; b < bodies_.size(); ++b) {
        if (!world_.bodies[a].moves() && !world_.bodies[b].moves()) continue;
        if ((X_WB[a].p - X_WB[b].p).norm() > radius_[a] + radius_[b]) continue;
        const double depth = deepest(a, b, relative_pose(X_WB[a], X_WB[b]));
        row.overlap_m = std::max(row.overlap_m, depth);
        if (a == 0) row.overlap_of_grasped_m = std::max(row.overlap_of_grasped_m, depth);
      }
  }

 private:
  struct Ball {
    Vec3 center;
    double radius;
  };
  static Ball ball(const OverlapPiece& piece) {
    Ball ball{Vec3::Zero(), 0.0};
    for (const Vec3& p : piece.corners) ball.center += p / static_cast<double>(piece.corners.size());
    for (const Vec3& p : piece.corners) ball.radius = std::max(ball.radius, (p - ball.center).norm());
    return ball;
  }
  double deepest(Index a, Index b, const Pose& X_AB) const {
    double depth = 0.0;
    for (const OverlapPiece& piece_b : bodies_[b]) {
      const OverlapPiece in_a = carried(piece_b, X_AB);
      const Ball ball_b = ball(in_a);
      for (const OverlapPiece& piece_a : bodies_[a]) {
        const Ball ball_a = ball(piece_a);
        if ((ball_a.center - ball_b.center).norm() > ball_a.radius + ball_b.radius) continue;
        depth = std::max(depth, overlap(piece_a, in_a));
      }
    }
    return depth;
  }

  const World& world_;
  std::vector<std::vector<OverlapPiece>> bodies_;
  std::vector<double> radius_;
};

int frames_of(const Scene& scene, double seconds) {
  const int all = static_cast<int>(frames_of_motion(scene));
  return seconds > 0.0 ? std::min(all, static_cast<int>(seconds / scene.settings.dt_s)) : all;
}

/// The most pairs that are near at once, in a run with little budget.
int most_near_pairs(const Scene& scene, int frames) {
  HeapRun run(scene, 2 * static_cast<int>(scene.world.bodies.size()));
  int most = 0;
  for (int i = 0; i < frames; ++i) most = std::max(most, run.step().work.near_pairs);
  return most;
}

double fastest(const WorldState& state) {
  double speed = 0.0;
  for (Index i = kHeapFixtures; i < state.V_WB.size(); ++i) speed = std::max(speed, state.V_WB[i].v.norm());
  return speed;
}

ScheduleRow run_with(const Scene& scene, double share, int pairs, int frames, int looks) {
  ScheduleRow row;
  row.share = share;
  row.budget = std::max(1, static_cast<int>(share * pairs));
  row.frames = frames;
  HeapRun run(scene, row.budget);
  const HeapReferee referee(scene.world);
  std::vector<double> times;
  FrameHash hash;
  int compared = 0;
  for (int i = 0; i < frames; ++i) {
    const bool look = (i + 1) * looks / frames != i * looks / frames;
    const Wrench truth = look ? run.next_without_limit() : Wrench();
    const FrameReport& report = run.step();
    times.push_back(run.frame_ns());
    add_to(hash, report);
    const ContactWork& work = report.work;
    row.most_near = std::max(row.most_near, work.near_pairs);
    row.most_tests = std::max(row.most_tests, report.tests());
    row.left_of_grasped += work.left_of_grasped;
    row.unchecked_mean += static_cast<double>(work.unchecked) / frames;
    row.unproven_mean += static_cast<double>(work.left_unproven) / frames;
    row.waiting_mean += static_cast<double>(report.waiting) / frames;
    row.unchecked_max = std::max(row.unchecked_max, work.unchecked);
    row.unproven_max = std::max(row.unproven_max, work.left_unproven);
    row.longest_unchecked = std::max(row.longest_unchecked, work.longest_unchecked);
    row.longest_wait = std::max(row.longest_wait, report.longest_wait);
    row.grasped_frames += report.grasped_contact_points > 0 ? 1 : 0;
    row.unchecked_at_end = work.unchecked;
    if (!look) continue;
    referee.look(run.at().X_WB, row);
    if (report.grasped_contact_points == 0) continue;
    const double error = (report.coupling.f - truth.f).norm();
    ++compared;
    row.force_error_mean_N += (error - row.force_error_mean_N) / compared;
    row.force_error_max_N = std::max(row.force_error_max_N, error);
  }
  row.fastest_at_end = fastest(run.at());
  std::sort(times.begin(), times.end());
  row.p50_us = quantile(times, 0.5) * 1e-3;
  row.p99_us = quantile(times, 0.99) * 1e-3;
  row.frame_hash = hash.value();
  return row;
}

/// The work of a frame, and its fastest time.
struct Frame {
  std::array<double, 4> work;
  double ns;
};

std::vector<Frame> frames_for_model(const Scene& scene, int budget, int replays) {
  std::vector<Frame> frames;
  const auto count = static_cast<Index>(kModelSeconds / scene.settings.dt_s);
  double pieces = 0.0;
  for (const Body& body : scene.world.bodies) pieces += static_cast<double>(body.part->pieces.size());
  for (int replay = 0; replay < replays; ++replay) {
    HeapRun run(scene, budget);
    for (Index i = 0; i < count; ++i) {
      const FrameReport& report = run.step();
      if (replay == 0) {
        const double sweeps = static_cast<double>(report.contact_points) * report.solver_iterations;
        frames.push_back(
            {{pieces, double(report.tests()), double(report.work.patches), sweeps}, run.frame_ns()});
      } else {
        frames[i].ns = std::min(frames[i].ns, run.frame_ns());
      }
    }
  }
  return frames;
}

double predicted(const Frame& frame, const std::array<double, 4>& constants) {
  double ns = 0.0;
  for (Index k = 0; k < 4; ++k) ns += constants[k] * frame.work[k];
  return ns;
}

/// Least squares of relative errors, constants not negative: a term that would be is left out.
TimeModel fitted(const std::vector<Frame>& frames, Index terms) {
  TimeModel model;
  std::array<bool, 4> used{};
  for (Index k = 0; k < terms; ++k) used[k] = true;
  for (bool again = true; again;) {
    again = false;
    Eigen::Matrix4d normal = Eigen::Matrix4d::Identity();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (Index r = 0; r < 4; ++r) {
      if (!used[r]) continue;
      for (Index c = 0; c < 4; ++c) {
        if (!used[c]) continue;
        double sum = 0.0;
        for (const Frame& frame : frames) sum += frame.work[r] * frame.work[c] / (frame.ns * frame.ns);
        normal(Eigen::Index(r), Eigen::Index(c)) = sum;
      }
      for (const Frame& frame : frames) right[Eigen::Index(r)] += frame.work[r] / frame.ns;
    }
    const Eigen::Vector4d constants = normal.ldlt().solve(right);
    for (Index k = 0; k < 4; ++k) {
      model.constants_ns[k] = used[k] ? constants[Eigen::Index(k)] : 0.0;
      if (model.constants_ns[k] >= 0.0) continue;
      used[k] = false;
      again = true;
    }
  }
  std::vector<double> errors;
  for (const Frame& frame : frames)
    errors.push_back(std::abs(predicted(frame, model.constants_ns) / frame.ns - 1.0));
  std::sort(errors.begin(), errors.end());
  model.typical_error = quantile(errors, 0.5);
  model.worst_error = quantile(errors, 1.0);
  return model;
}

std::string rounded(double value) { return fmt::format("{:.0f}", value); }

}  // namespace

Result<ScheduleReport> bench_schedule(const ScheduleOptions& options,
                                      const std::function<void(const std::string&)>& progress) {
  ScheduleReport report;
  std::vector<std::vector<Frame>> by_heap;
  std::vector<Frame> frames;
  for (const double part : kModelHeaps) {
    HeapOptions heap;
    heap.bodies = std::max(1, static_cast<int>(part * options.bodies));
    Result<Scene> scene = heap_scene(heap);
    if (!scene) return scene.error();
    progress(fmt::format("model, {} bodies", heap.bodies));
    const int pairs = most_near_pairs(*scene, static_cast<int>(kModelSeconds / scene->settings.dt_s));
    by_heap.push_back(frames_for_model(*scene, static_cast<int>(kModelShare * pairs), options.replays));
    frames.insert(frames.end(), by_heap.back().begin(), by_heap.back().end());
    report.heaps.push_back({.bodies = heap.bodies});
  }
  report.model_frames = static_cast<int>(frames.size());
  report.paper = fitted(frames, 3);
  report.swept = fitted(frames, 4);
  for (Index h = 0; h < by_heap.size(); ++h) {
    ModelRow& row = report.heaps[h];
    const double share = 1.0 / static_cast<double>(by_heap[h].size());
    for (const Frame& frame : by_heap[h]) {
      row.pieces += share * frame.work[0];
      row.tests += share * frame.work[1];
      row.patches += share * frame.work[2];
      row.sweeps += share * frame.work[3];
      row.measured_us += share * frame.ns * 1e-3;
      row.paper_us += share * predicted(frame, report.paper.constants_ns) * 1e-3;
      row.swept_us += share * predicted(frame, report.swept.constants_ns) * 1e-3;
    }
  }

  HeapOptions heap;
  heap.bodies = options.bodies;
  Result<Scene> scene = heap_scene(heap);
  if (!scene) return scene.error();
  const int count = frames_of(*scene, options.seconds);
  progress("how many pairs are near");
  const int pairs = most_near_pairs(*scene, count);
  for (const double share : options.shares) {
    progress(fmt::format("budget {} of {} pairs", share, pairs));
    report.rows.push_back(run_with(*scene, share, pairs, count, options.looks));
  }
  return report;
}

nlohmann::ordered_json to_json(const ScheduleReport& report) {
  const auto model = [](const TimeModel& m) {
    return nlohmann::ordered_json{
        {"constants_ns", m.constants_ns}, {"typical_error", m.typical_error}, {"worst_error", m.worst_error}};
  };
  nlohmann::ordered_json json = {{"model_frames", report.model_frames},
                                 {"paper_model", model(report.paper)},
                                 {"swept_model", model(report.swept)}};
  for (const ModelRow& row : report.heaps)
    json["heaps"].push_back({{"bodies", row.bodies},
                             {"pieces", row.pieces},
                             {"tests", row.tests},
                             {"patches", row.patches},
                             {"sweeps", row.sweeps},
                             {"measured_us", row.measured_us},
                             {"paper_us", row.paper_us},
                             {"swept_us", row.swept_us}});
  for (const ScheduleRow& row : report.rows)
    json["budgets"].push_back({{"share", row.share},
                               {"budget", row.budget},
                               {"most_near", row.most_near},
                               {"most_tests", row.most_tests},
                               {"left_of_grasped", row.left_of_grasped},
                               {"frames", row.frames},
                               {"grasped_frames", row.grasped_frames},
                               {"force_error_mean_N", row.force_error_mean_N},
                               {"force_error_max_N", row.force_error_max_N},
                               {"unchecked_mean", row.unchecked_mean},
                               {"unchecked_max", row.unchecked_max},
                               {"unproven_mean", row.unproven_mean},
                               {"unproven_max", row.unproven_max},
                               {"waiting_mean", row.waiting_mean},
                               {"longest_unchecked", row.longest_unchecked},
                               {"longest_wait", row.longest_wait},
                               {"unchecked_at_end", row.unchecked_at_end},
                               {"fastest_at_end_m_per_s", row.fastest_at_end},
                               {"overlap_m", row.overlap_m},
                               {"overlap_of_grasped_m", row.overlap_of_grasped_m},
                               {"p50_us", row.p50_us},
                               {"p99_us", row.p99_us},
                               {"frame_hash", fmt::format("{:016x}", row.frame_hash)}});
  return json;
}

Table table_of(const std::vector<ScheduleRow>& rows) {
  Table table;
  table.rows.push_back({"budget", "tests", "most tests", "most near", "force error", "worst", "unchecked",
                        "most", "unproven", "most", "waiting", "longest", "left of held", "overlap", "p50",
                        "p99"});
  for (const ScheduleRow& row : rows)
    table.rows.push_back(
        {fmt::format("{:g}", row.share), fmt::format("{}", row.budget), fmt::format("{}", row.most_tests),
         fmt::format("{}", row.most_near), fmt::format("{:.2g} N", row.force_error_mean_N),
         fmt::format("{:.2g} N", row.force_error_max_N), rounded(row.unchecked_mean),
         fmt::format("{}", row.unchecked_max), rounded(row.unproven_mean),
         fmt::format("{}", row.unproven_max), rounded(row.waiting_mean),
         fmt::format("{} frames", row.longest_wait), fmt::format("{}", row.left_of_grasped),
         length_text(row.overlap_m), time_text(row.p50_us * 1e3), time_text(row.p99_us * 1e3)});
  return table;
}

Table table_of(const std::vector<ModelRow>& rows) {
  Table table;
  table.rows.push_back(
      {"bodies", "N", "K", "M", "points x sweeps", "measured", "paper's model", "with sweeps"});
  for (const ModelRow& row : rows)
    table.rows.push_back({fmt::format("{}", row.bodies), rounded(row.pieces), rounded(row.tests),
                          rounded(row.patches), rounded(row.sweeps), time_text(row.measured_us * 1e3),
                          time_text(row.paper_us * 1e3), time_text(row.swept_us * 1e3)});
  return table;
}

std::string describe(const ScheduleReport& report) {
  const auto& p = report.paper;
  const auto& s = report.swept;
  return fmt::format(
      "T_h = N t_s + K t_c + M t_f with t_s = {}, t_c = {}, t_f = {}: off by {:.0f} % in the typical frame, "
      "{:.0f} % at "
      "worst. With a term for contact points times sweeps, t_s = {}, t_c = {}, t_f = {}, t_r = {}: {:.0f} % "
      "and {:.0f} %. "
      "{} frames.\n",
      time_text(p.constants_ns[0]), time_text(p.constants_ns[1]), time_text(p.constants_ns[2]),
      100.0 * p.typical_error, 100.0 * p.worst_error, time_text(s.constants_ns[0]),
      time_text(s.constants_ns[1]), time_text(s.constants_ns[2]), time_text(s.constants_ns[3]),
      100.0 * s.typical_error, 100.0 * s.worst_error, report.model_frames);
}

}  // namespace tactum::bench
