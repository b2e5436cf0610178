#include "bench/scene_feel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/port_referee.h"
#include "tactum/devices/hand_model.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum::bench {
namespace {

constexpr double kStep_N = 0.05;
constexpr double kToAndFro_N = 0.02;
constexpr double kChanged_N = 0.01;
constexpr double kChanged_Nm = 2e-4;
constexpr std::size_t kExplainedWithin = 15;  // frames

/// Counts the steps of one stage's wrench.
class StepCounter {
 public:
  StepCounter(const FrameTrace& trace, const std::string& stage, StageSteps& out)
      : force_(trace.column(stage + "_fx_N")), torque_(trace.column(stage + "_tx_Nm")), out_(out) {}

  Vec3 force(std::span<const double> row) const { return vector_at(row, force_); }
  Vec3 torque(std::span<const double> row) const { return vector_at(row, torque_); }
  const Vec3& step() const { return step_; }
  const Vec3& step_of_torque() const { return step_of_torque_; }

  void look(std::span<const double> row, bool counts) {
    const Vec3 f = force(row), t = torque(row);
    const Vec3 before = step_;
    step_ = known_ ? Vec3(f - f_) : Vec3(Vec3::Zero());
    step_of_torque_ = known_ ? Vec3(t - t_) : Vec3(Vec3::Zero());
    f_ = f;
    t_ = t;
    known_ = true;
    if (!counts) return;
    const double size = step_.norm();
    out_.largest_N = std::max(out_.largest_N, size);
    out_.largest_Nm = std::max(out_.largest_Nm, step_of_torque_.norm());
    out_.steps += size > kStep_N ? 1 : 0;
    if (!(step_.dot(before) < 0.0)) return;
    const double both = std::min(size, before.norm());
    out_.largest_turn_N = std::max(out_.largest_turn_N, both);
    out_.to_and_fro += both > kToAndFro_N ? 1 : 0;
  }

 private:
  int force_, torque_;
  StageSteps& out_;
  Vec3 f_ = Vec3::Zero(), t_ = Vec3::Zero(), step_ = Vec3::Zero(), step_of_torque_ = Vec3::Zero();
  bool known_ = false;
};

/// Judges the rows of a trace.
class SceneJudge final : public LoopObserver {
 public:
  SceneJudge(const Session& session, FrameTrace& trace, SceneFeelRow& out)
      : settings_(session.scene().settings),
        trace_(trace),
        out_(out),
        row_(trace.width()),
        referee_(session.scene().world, session.scene().settings, trace),
        computed_(trace, "computed", out.computed),
        smoothed_(trace, "smoothed", out.smoothed),
        sent_(trace, "sent", out.sent),
        device_p_(trace.column("device_px_m")),
        device_q_(trace.column("device_qw")),
        ramping_(trace.column("ramping")),
        share_(trace.column("energy_stiffness_share")) {
    // Of the farthest point of what may be held from the handle, wherever it is held.
    const World& world = session.scene().world;
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (settings_.tool.picks || static_cast<int>(i) == settings_.tool.body)
        for (const Vec3& vertex : world.bodies[i].part->surface.vertices)
          lever_m_ = std::max(lever_m_, 2.0 * vertex.norm() / settings_.workspace.scale);
  }

  bool after_frame(const FrameRecord&) noexcept override {
    while (trace_.pop(row_)) judge();
    return true;
  }
  void end() {
    out_.generated_J = referee_.generated_J();
    out_.generated_by_motors_J = referee_.generated_by_motors_J();
    out_.deepest_fall_J = referee_.deepest_fall_J();
  }

 private:
  void judge() {
    const bool ramps = row_[static_cast<std::size_t>(ramping_)] != 0.0;
    const bool counts = !ramps && !ramped_;
    ramped_ = ramps;
    referee_.look(row_);
    computed_.look(row_, counts);
    smoothed_.look(row_, counts);
    sent_.look(row_, counts);
    const SafetyLimits& limits = settings_.safety;
    out_.beyond_slew += sent_.step().norm() > limits.max_force_slew_N_per_s * settings_.dt_s * (1.0 + 1e-9) ||
                                sent_.step_of_torque().norm() >
                                    limits.max_torque_slew_Nm_per_s * settings_.dt_s * (1.0 + 1e-9)
                            ? 1
                            : 0;
    const double explained_N = explained();
    if (!counts) return;
    ++out_.frames;
    out_.unexplained += smoothed_.step().norm() > std::max(kStep_N, explained_N) * (1.0 + 1e-9) ? 1 : 0;
    const double off_N = (sent_.force(row_) - smoothed_.force(row_)).norm();
    const double off_Nm = (sent_.torque(row_) - smoothed_.torque(row_)).norm();
    out_.changed += off_N > kChanged_N || off_Nm > kChanged_Nm ? 1 : 0;
    out_.least_share = std::min(out_.least_share, row_[static_cast<std::size_t>(share_)]);
  }

  /// The largest step that the hand's motion of the last frames can have made.
  double explained() {
    const Vec3 p = vector_at(row_, device_p_);
    const double moved = known_ ? (p - p_).norm() : 0.0;
    p_ = p;
    const Eigen::Quaterniond q(
        row_[static_cast<std::size_t>(device_q_)], row_[static_cast<std::size_t>(device_q_) + 1],
        row_[static_cast<std::size_t>(device_q_) + 2], row_[static_cast<std::size_t>(device_q_) + 3]);
    const double turned = known_ ? q_.angularDistance(q) : 0.0;
    q_ = q;
    known_ = true;
    made_N_[next_++ % kExplainedWithin] = settings_.coupling.stiffness_N_per_m * (moved + lever_m_ * turned);
    return *std::max_element(made_N_.begin(), made_N_.end());
  }

  const FrameSettings& settings_;
  FrameTrace& trace_;
  SceneFeelRow& out_;
  std::vector<double> row_;
  PortReferee referee_;
  StepCounter computed_, smoothed_, sent_;
  int device_p_, device_q_, ramping_, share_;
  double lever_m_ = 0.0;
  bool ramped_ = true, known_ = false;
  Vec3 p_ = Vec3::Zero();
  Quat q_ = Quat::Identity();
  std::array<double, kExplainedWithin> made_N_{};
  std::size_t next_ = 0;
};

std::vector<std::string> all_scenes() {
  std::vector<std::string> names;
  for (const BuiltinScene& scene : builtin_scenes()) names.emplace_back(scene.name);
  return names;
}

std::vector<std::string> all_devices() {
  std::vector<std::string> names;
  for (const SimulatedDeviceModel& model : simulated_device_presets()) names.push_back(model.name);
  return names;
}

}  // namespace

Result<SceneFeelRow> feel_scene(Scene scene, const std::string& device, const std::string& hand,
                                double most_s) {
  SceneFeelRow row;
  row.scene = scene.name;
  row.device = device;
  row.hand = hand;
  row.response = scene.settings.response == ResponseModel::kPenalty ? "penalty" : "constraint";
  const double duration_s = scene.hand == nullptr ? 0.0 : scene.hand->duration_s();
  Result<std::unique_ptr<Session>> opened =
      Session::open(std::move(scene), {.device = "simulated:" + device, .grip = hand, .rate_Hz = 0.0});
  if (!opened) return opened.error();
  Session& session = **opened;
  FrameTrace trace(session.scene().world, session.scene().settings.dt_s, true);
  session.trace_to(&trace);
  SceneJudge judge(session, trace, row);
  const double felt_s = most_s > 0.0 ? std::min(most_s, duration_s) : duration_s;
  const Result<VirtualRun> run =
      session.run_virtual(static_cast<std::uint64_t>(felt_s * session.rate_Hz()), &judge);
  if (!run) return run.error();
  judge.end();
  return row;
}

Result<std::vector<SceneFeelRow>> bench_scene_feel(const SceneFeelOptions& options,
                                                   const std::function<void(const std::string&)>& progress) {
  const auto or_all = [](const std::vector<std::string>& asked, std::vector<std::string> all) {
    return asked.empty() ? std::move(all) : asked;
  };
  std::vector<SceneFeelRow> rows;
  for (const std::string& name : or_all(options.scenes, all_scenes())) {
    progress(name);
    for (const std::string& response : or_all(options.responses, {"constraint", "penalty"}))
      for (const std::string& device : or_all(options.devices, all_devices()))
        for (const std::string& hand : or_all(options.hands, {"loose", "medium", "firm"})) {
          Result<Scene> scene = open_scene(name);
          if (!scene) return scene.error();
          scene->settings.response =
              response == "penalty" ? ResponseModel::kPenalty : ResponseModel::kConstraint;
          Result<SceneFeelRow> row = feel_scene(std::move(*scene), device, hand, options.most_s);
          if (!row) return row.error();
          rows.push_back(std::move(*row));
        }
  }
  return rows;
}

Table table_of(const std::vector<SceneFeelRow>& rows) {
  Table table;
  table.left = 4;
  table.rows.push_back({"scene", "device", "hand", "response", "computed N", "smoothed N", "sent N", "steps",
                        "unexplained", "to and fro", "changed", "beyond slew", "generated mJ", "motors mJ",
                        "fall mJ", "stiffness %"});
  for (const SceneFeelRow& row : rows)
    table.rows.push_back(
        {row.scene, row.device, row.hand, row.response, fmt::format("{:.3f}", row.computed.largest_N),
         fmt::format("{:.3f}", row.smoothed.largest_N), fmt::format("{:.3f}", row.sent.largest_N),
         fmt::format("{}", row.sent.steps), fmt::format("{}", row.unexplained),
         fmt::format("{} ({:.3f})", row.sent.to_and_fro, row.sent.largest_turn_N),
         fmt::format("{}", row.changed), fmt::format("{}", row.beyond_slew),
         fmt::format("{:.3f}", 1e3 * row.generated_J), fmt::format("{:.3f}", 1e3 * row.generated_by_motors_J),
         fmt::format("{:.3f}", 1e3 * row.deepest_fall_J), fmt::format("{:.1f}", 100.0 * row.least_share)});
  return table;
}

nlohmann::ordered_json to_json(const SceneFeelRow& row) {
  const auto stage = [](const StageSteps& steps) {
    return nlohmann::ordered_json{{"largest_step_N", steps.largest_N},
                                  {"largest_step_Nm", steps.largest_Nm},
                                  {"steps", steps.steps},
                                  {"to_and_fro", steps.to_and_fro},
                                  {"largest_to_and_fro_N", steps.largest_turn_N}};
  };
  return {{"scene", row.scene},
          {"device", row.device},
          {"hand", row.hand},
          {"response", row.response},
          {"frames", row.frames},
          {"computed", stage(row.computed)},
          {"smoothed", stage(row.smoothed)},
          {"sent", stage(row.sent)},
          {"unexplained_steps", row.unexplained},
          {"changed_frames", row.changed},
          {"beyond_slew_frames", row.beyond_slew},
          {"generated_J", row.generated_J},
          {"generated_by_motors_J", row.generated_by_motors_J},
          {"deepest_fall_J", row.deepest_fall_J},
          {"least_stiffness_share", row.least_share}};
}

}  // namespace tactum::bench
