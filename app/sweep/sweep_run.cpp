#include "app/sweep/sweep_run.h"

#include <algorithm>
#include <limits>

#include "tactum/haptics/setting_table.h"
#include "tactum/recording/recorded_scene.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"
#include "tactum/session/session.h"

namespace tactum {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Watches the frames of a run.
class SweepWatch {
 public:
  SweepWatch(const JamRule& jam, double dt_s) : jam_(jam), dt_s_(dt_s) {}

  void frame(const FrameReport& report, const WorldState& bodies, const GoalRecord& goals) noexcept {
    record_.add(report, bodies);
    const bool met = goals.size() > 0 && goals.all_met();
    const double time_s = static_cast<double>(record_.frames) * dt_s_;
    if (!met) met_s_ = kNone;
    if (met && !(met_s_ >= 0.0)) met_s_ = time_s;
    if (report.grasped_body >= 0)
      stretch_m_ = std::max(stretch_m_, (report.X_WH.p - report.X_WH_proxy.p).norm());
    look_for_jam(report, met);
    last_ = report.port;
    before_ = report.X_WH_proxy.p;
  }

  SweepResult result(const GoalRecord& goals) const {
    SweepResult result;
    const auto frames = static_cast<double>(record_.frames);
    const double each = record_.frames == 0 ? 0.0 : 1.0 / frames;
    const auto sum = [&](ReportFieldName field) { return static_cast<double>(record_.sum(field)); };
    result.numbers = {met_s_ >= 0.0 ? 1.0 : 0.0,
                      met_s_,
                      record_.max_force_N,
                      record_.max_torque_Nm,
                      record_.sum_force_N * each,
                      static_cast<double>(record_.grasped_contact_frames) * each,
                      static_cast<double>(jammed_) * dt_s_,
                      static_cast<double>(longest_) * dt_s_,
                      longest_ > 0 ? where_.x() : kNone,
                      longest_ > 0 ? where_.y() : kNone,
                      longest_ > 0 ? where_.z() : kNone,
                      stretch_m_,
                      goals.size() > 0 ? goals.best(0) : kNone,
                      static_cast<double>(record_.penetrating_frames),
                      last_.total.from_hand_J,
                      last_.total.to_hand_J,
                      last_.generated_J,
                      sum("friction.slipping"),
                      static_cast<double>(record_.lagging_frames),
                      frames};
    for (double& number : result.numbers)
      if (!(number == number)) number = kNone;  // one pattern of bits for all that are none
    result.hash = record_.hash();
    return result;
  }

 private:
  void look_for_jam(const FrameReport& report, bool met) noexcept {
    const double speed = (report.X_WH_proxy.p - before_).norm() / dt_s_;
    const bool jammed = record_.frames > 1 && !met && report.grasped_contact_points > 0 &&
                        report.coupling.f.norm() >= jam_.force_N && speed <= jam_.speed_m_per_s;
    if (!jammed) {
      in_row_ = 0;
      return;
    }
    if (in_row_++ == 0) began_ = report.X_WH_proxy.p;
    ++jammed_;
    if (in_row_ <= longest_) return;
    longest_ = in_row_;
    where_ = began_;
  }

  JamRule jam_;
  double dt_s_;
  RunRecord record_;
  PortReport last_;
  double met_s_ = kNone, stretch_m_ = 0.0;
  std::uint64_t jammed_ = 0, in_row_ = 0, longest_ = 0;
  Vec3 before_ = Vec3::Zero(), began_ = Vec3::Zero(), where_ = Vec3::Zero();
};

class SessionWatch final : public LoopObserver {
 public:
  SessionWatch(const Session& session, const JamRule& jam)
      : session_(session), watch_(jam, session.scene().settings.dt_s) {}
  bool after_frame(const FrameRecord&) noexcept override {
    watch_.frame(session_.last_report(), session_.state().world, session_.goals());
    return true;
  }
  SweepResult result() const { return watch_.result(session_.goals()); }

 private:
  const Session& session_;
  SweepWatch watch_;
};

/// The scene's own hand.
Result<SweepResult> play_scene(const SweepPlan& plan, const std::string& text) {
  const Result<SceneDescription> description =
      parse_description(text, plan.scene_name, plan.source.file, plan.source.folders);
  if (!description) return description.error();
  Result<Scene> scene = build_scene(*description);
  if (!scene) return scene.error();
  Result<std::unique_ptr<Session>> opened = Session::open(std::move(*scene), {});
  if (!opened) return opened.error();
  Session& session = **opened;
  if (!session.scene().hand)
    return Error{"nothing moves in the scene of the sweep", "a scene without a hand", "one with [hand]",
                 plan.source.file};
  const double duration_s = plan.duration_s > 0.0 ? plan.duration_s : session.scene().hand->duration_s();
  SessionWatch watch(session, plan.jam);
  const Result<VirtualRun> run =
      session.run_virtual(static_cast<std::uint64_t>(duration_s * session.rate_Hz()), &watch);
  if (!run) return run.error();
  return watch.result();
}

bool is_swept(const SweepPlan& plan, const std::string& setting) {
  return std::any_of(plan.axes.begin(), plan.axes.end(), [&](const SweepAxis& axis) {
    return std::find(axis.paths.begin(), axis.paths.end(), setting) != axis.paths.end();
  });
}

/// Section and key of the setting that a command changes.
std::string key_of(const SessionCommand& command) {
  const SettingInfo& setting = setting_table()[static_cast<std::size_t>(command.setting)];
  return setting.section[0] == '\0' ? setting.key : std::string(setting.section) + "." + setting.key;
}

/// The hand of a recording, which goes where it went.
Result<SweepResult> play_recording(const SweepPlan& plan, const std::string& text) {
  const SweptRecording& recording = *plan.recording;
  RunHead head = recording.head;
  // A setting of an axis is the sweep's; the others are as they were in the recording.
  std::erase_if(head.settings, [&](const auto& setting) { return is_swept(plan, setting.first); });
  std::map<std::string, std::string> files = recording.files;
  files[kSceneAttachment] = text;
  Result<RecordedScene> built = build_recorded(head, files, {}, plan.file);
  if (!built) return built.error();
  Simulation& simulation = *built->simulation;
  GoalRecord goals(simulation.world(), built->goals);
  SweepWatch watch(plan.jam, head.dt_s);
  std::size_t frames = recording.inputs.size();
  if (plan.duration_s > 0.0)
    frames = std::min(frames, static_cast<std::size_t>(plan.duration_s / head.dt_s + 0.5));
  auto command = recording.commands.begin();
  for (std::size_t i = 0; i < frames; ++i) {
    for (; command != recording.commands.end() && command->index <= i; ++command)
      if (!is_swept(plan, key_of(command->command)))
        set_live(command->command, built->device_limits, simulation.settings(), built->safety);
    simulation.run(recording.inputs[i].sample, recording.inputs[i].tick);
    goals.watch(simulation.world(), simulation.bodies(), simulation.report().grasped_body,
                simulation.state().response.rows());
    watch.frame(simulation.report(), simulation.bodies(), goals);
  }
  return watch.result(goals);
}

}  // namespace

SweepResult run_of_sweep(const SweepPlan& plan, std::uint64_t run) {
  Result<SweepResult> result = Error{};
  const Result<std::string> text = scene_text_of(plan, run);
  if (!text)
    result = text.error();
  else
    result = plan.recording ? play_recording(plan, *text) : play_scene(plan, *text);
  SweepResult answer;
  if (result) {
    answer = *result;
  } else {
    answer.numbers.fill(kNone);
    answer.error = values_of(plan, run) + ": " + result.error().message();
  }
  answer.run = run;
  return answer;
}

}  // namespace tactum
