#include "app/sweep/sweep_run.h"

#include <algorithm>
#include <limits>
#include <vector>

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
  SweepWatch(const JamRule& jam, double dt_s, std::size_t hands)
      : jam_(jam), dt_s_(dt_s), record_(hands), last_(hands), hands_(hands) {}

  void frame(const FrameReport& report, const FrameState& state, const GoalRecord& goals) noexcept {
    record_.add(report, state.world, state.other_reports);
    const bool met = goals.size() > 0 && goals.all_met();
    const double time_s = static_cast<double>(record_.frames) * dt_s_;
    if (!met) met_s_ = kNone;
    if (met && !(met_s_ >= 0.0)) met_s_ = time_s;
    bool touched = false;
    double force_N = 0.0;
    std::size_t jammed = hands_.size();
    for (std::size_t h = 0; h < hands_.size(); ++h) {
      const HandReport& hand = h == 0 ? report : state.other_reports[h - 1];
      touched = touched || hand.grasped_contact_points > 0;
      force_N += hand.shown.f.norm();
      if (hand.grasped_body >= 0) stretch_m_ = std::max(stretch_m_, (hand.X_WH.p - hand.X_WH_proxy.p).norm());
      if (jammed == hands_.size() && !met && is_jammed(hand, hands_[h])) jammed = h;
      last_[h] = hand.port;
      hands_[h] = hand.X_WH_proxy.p;
    }
    sum_force_N_ += force_N;
    if (touched) ++touched_;
    count_jam(jammed);
  }

  SweepResult result(const GoalRecord& goals) const {
    SweepResult result;
    const auto frames = static_cast<double>(record_.frames);
    const double each = record_.frames == 0 ? 0.0 : 1.0 / frames;
    const auto sum = [&](ReportFieldName field) { return static_cast<double>(record_.sum(field)); };
    result.numbers = {met_s_ >= 0.0 ? 1.0 : 0.0,
                      met_s_,
                      largest_of_hands(record_.max_force_N, &HandRun::max_force_N),
                      largest_of_hands(record_.max_torque_Nm, &HandRun::max_torque_Nm),
                      sum_force_N_ * each,
                      static_cast<double>(touched_) * each,
                      static_cast<double>(jammed_) * dt_s_,
                      static_cast<double>(longest_) * dt_s_,
                      longest_ > 0 ? where_.x() : kNone,
                      longest_ > 0 ? where_.y() : kNone,
                      longest_ > 0 ? where_.z() : kNone,
                      stretch_m_,
                      goals.size() > 0 ? goals.best(0) : kNone,
                      static_cast<double>(record_.penetrating_frames),
                      sum_of_hands([](const PortReport& port) { return port.total.from_hand_J; }),
                      sum_of_hands([](const PortReport& port) { return port.total.to_hand_J; }),
                      sum_of_hands([](const PortReport& port) { return port.generated_J; }),
                      sum("friction.slipping"),
                      static_cast<double>(record_.lagging_frames),
                      frames};
    for (double& number : result.numbers)
      if (!(number == number)) number = kNone;  // one pattern of bits for all that are none
    result.hash = record_.hash();
    return result;
  }

 private:
  bool is_jammed(const HandReport& hand, const Vec3& before) const noexcept {
    const double speed = (hand.X_WH_proxy.p - before).norm() / dt_s_;
    return record_.frames > 1 && hand.grasped_contact_points > 0 && hand.coupling.f.norm() >= jam_.force_N &&
           speed <= jam_.speed_m_per_s;
  }

  /// `hand` is the first that is jammed now; none where it is none of them.
  void count_jam(std::size_t hand) noexcept {
    if (hand >= hands_.size()) {
      in_row_ = 0;
      return;
    }
    if (in_row_++ == 0) began_ = hands_[hand];
    ++jammed_;
    if (in_row_ <= longest_) return;
    longest_ = in_row_;
    where_ = began_;
  }

  double largest_of_hands(double largest, double HandRun::*member) const {
    for (const HandRun& other : record_.other_hands) largest = std::max(largest, other.*member);
    return largest;
  }
  template <class Number>
  double sum_of_hands(const Number& number) const {
    double sum = 0.0;
    for (const PortReport& port : last_) sum += number(port);
    return sum;
  }

  JamRule jam_;
  double dt_s_;
  RunRecord record_;
  std::vector<PortReport> last_;  // by hand
  std::vector<Vec3> hands_;       // where their handles on the parts were
  double met_s_ = kNone, stretch_m_ = 0.0, sum_force_N_ = 0.0;
  std::uint64_t touched_ = 0, jammed_ = 0, in_row_ = 0, longest_ = 0;
  Vec3 began_ = Vec3::Zero(), where_ = Vec3::Zero();
};

class SessionWatch final : public LoopObserver {
 public:
  SessionWatch(const Session& session, const JamRule& jam)
      : session_(session), watch_(jam, session.scene().settings.dt_s, session.hands()) {}
  bool after_frame(const FrameRecord&) noexcept override {
    watch_.frame(session_.last_report(), session_.state(), session_.goals());
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
  double longest_s = session.scene().hand->duration_s();
  for (const SceneHand& other : session.scene().other_hands)
    if (other.hand) longest_s = std::max(longest_s, other.hand->duration_s());
  const double duration_s = plan.duration_s > 0.0 ? plan.duration_s : longest_s;
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
  const std::size_t hands = simulation.settings().hands();
  SweepWatch watch(plan.jam, head.dt_s, hands);
  std::vector<HandSample> samples(hands);
  std::vector<Wrench> wrenches(hands);
  std::size_t frames = recording.inputs.size();
  if (plan.duration_s > 0.0)
    frames = std::min(frames, static_cast<std::size_t>(plan.duration_s / head.dt_s + 0.5));
  auto command = recording.commands.begin();
  for (std::size_t i = 0; i < frames; ++i) {
    for (; command != recording.commands.end() && command->index <= i; ++command)
      if (!is_swept(plan, key_of(command->command)))
        set_live(command->command, built->device_limits, simulation.settings(), built->safety);
    static_cast<DeviceSample&>(samples[0]) = recording.inputs[i].sample;
    samples[0].refused = recording.inputs[i].tick.refused;
    for (std::size_t h = 1; h < hands; ++h) samples[h] = recording.others[i * (hands - 1) + h - 1];
    simulation.run(samples, recording.inputs[i].tick, wrenches);
    goals.watch(simulation.world(), simulation.bodies(), simulation.report().grasped_body,
                simulation.state().response.rows());
    watch.frame(simulation.report(), simulation.state(), goals);
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
