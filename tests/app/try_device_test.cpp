// tactum devices --try on devices whose handle moves: a terminal is typed at as a person would, and a hand
// does at the handle what the program asks for.

#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "program.h"
#include "standins/moved_handle.h"
#include "support/standin_files.h"
#include "tactum/drivers/tactum_device.h"

namespace tactum::try_device_test {
namespace {

using standin::HandTask;
using testing::ProgramRun;
using testing::run_tactum;
using Obey = std::function<void(HandTask, int)>;

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// What the program's words ask of the hand.
std::optional<std::pair<HandTask, int>> asked_in(const std::string& words) {
  const std::pair<const char*, std::pair<HandTask, int>> kTasks[] = {
      {"Hold the handle still", {HandTask::kHold, 0}},
      {"Move the handle toward you", {HandTask::kMove, 0}},
      {"Move the handle to the right", {HandTask::kMove, 1}},
      {"Move the handle up", {HandTask::kMove, 2}},
      {"like a steering wheel to the left", {HandTask::kTurn, 0}},
      {"so that its top tips toward you", {HandTask::kTurn, 1}},
      {"counter-clockwise, seen from above", {HandTask::kTurn, 2}},
      {"Press onto it", {HandTask::kPress, 2}},
      {"Put the handle in the middle and let go", {HandTask::kRelease, 0}},
  };
  for (const auto& [text, task] : kTasks)
    if (holds(words, text)) return task;
  return {};
}

/// Answers a question that stands on the terminal: the hand begins, then ENTER is pressed.
void answer_question(int terminal, std::string& unanswered, const Obey& obey) {
  const std::size_t end = unanswered.find("[ENTER: go on, q: stop]");
  if (end == std::string::npos) return;
  const auto task = asked_in(unanswered.substr(0, end));
  if (task) obey(task->first, task->second);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));  // the handle is seen in the middle
  EXPECT_TRUE(task) << "a question that is not understood: " << unanswered;
  EXPECT_EQ(write(terminal, task ? "\n" : "q\n", task ? 1 : 2), task ? 1 : 2);
  unanswered.erase(0, end + 1);
}

/// `tactum devices --try DEVICE` at a terminal of its own, until it ends.
ProgramRun tried_once(const std::string& device, const Obey& obey) {
  const std::string program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "tactum").string();
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    execl(program.c_str(), "tactum", "devices", "--try", device.c_str(), nullptr);
    _exit(127);
  }
  ProgramRun run;
  std::string unanswered;
  std::array<char, 1024> bytes{};
  for (ssize_t got = 0; (got = read(terminal, bytes.data(), bytes.size())) > 0;) {
    run.out.append(bytes.data(), static_cast<std::size_t>(got));
    unanswered.append(bytes.data(), static_cast<std::size_t>(got));
    answer_question(terminal, unanswered, obey);
  }
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

/// The same, and again where it was not passed: this machine may be too busy to serve a device in time, and
/// the handle of a stand-in is put into the middle at once, which is read as a motion where the last sample
/// before it came late. A guide that is wrong passes none of them.
ProgramRun tried(const std::string& device, const Obey& obey) {
  ProgramRun run = tried_once(device, obey);
  for (int again = 0; again < 4 && run.exit_code == 2; ++again) run = tried_once(device, obey);
  return run;
}

/// The number that follows `key` in a text; NaN where there is none.
double number_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key);
  return at == std::string::npos ? NAN : std::strtod(text.c_str() + at + key.size(), nullptr);
}

/// Its profile has the handle's law, and tactum feel says that it goes by it, with the same coupling where
/// the driver does not measure the delay anew.
void expect_profile_in_use(const ProgramRun& run, const std::string& folder, const std::string& device,
                           const standin::HandleLaw& law, bool turns, bool delay_is_steady) {
  std::string path;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) path = entry.path().string();
  const std::string profile = testing::content(path);
  EXPECT_TRUE(holds(run.out, path + " is written, and tactum feel uses it from now on")) << run.out;
  EXPECT_NEAR(number_after(profile, "mass_kg = "), law.mass_kg, 0.1 * law.mass_kg) << profile;
  const double damping = number_after(profile, "\ndamping_Ns_per_m = ");  // less its error
  EXPECT_GT(damping, 0.4 * law.damping_Ns_per_m) << profile;
  EXPECT_LT(damping, 1.1 * law.damping_Ns_per_m) << profile;
  EXPECT_LT(number_after(profile, "delay_s = "), 0.010) << profile;
  if (turns) {
    const double turning = number_after(profile, "damping_Nms_per_rad = ");
    EXPECT_GT(turning, 0.6 * law.damping_Nms_per_rad) << profile;
    EXPECT_LT(turning, 1.1 * law.damping_Nms_per_rad) << profile;
    EXPECT_NEAR(number_after(profile, "inertia_kg_m2 = "), law.inertia_kg_m2, 0.1 * law.inertia_kg_m2);
  }
  const ProgramRun felt = run_tactum("feel gears-involute --duration 0.5 --device " + device);
  EXPECT_TRUE(testing::ended(felt)) << felt.err;
  EXPECT_TRUE(holds(felt.out, "are those of " + path)) << felt.out;
  if (delay_is_steady) {
    const std::size_t margin = run.out.find("The coupling of ");  // chosen with the profile
    ASSERT_NE(margin, std::string::npos) << run.out;
    const std::string coupling = run.out.substr(margin, run.out.find(" See docs", margin) - margin);
    EXPECT_TRUE(holds(felt.out, coupling)) << coupling << "\n" << felt.out;
  } else {
    EXPECT_TRUE(holds(felt.out, " kg (limit")) << "only the profile knows a mass\n" << felt.out;
  }
}

TEST(TryDevice, OneOfForceDimensionPassesEveryStepAndItsProfileIsUsed) {
  const testing::ScratchFolder folder;
  std::filesystem::create_directory(folder / "profiles");
  const SetVariable dhd("TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd"));
  const SetVariable record("TACTUM_STANDIN_RECORD", folder / "record");
  const SetVariable hand("TACTUM_STANDIN_HAND", folder / "hand");
  const SetVariable profiles("TACTUM_DEVICE_PROFILES", folder / "profiles");
  standin::AskedHand asked(folder / "hand");
  ASSERT_TRUE(asked.is_mapped());
  const ProgramRun run = tried("force-dimension", [&](HandTask task, int axis) { asked.ask(task, axis); });
  EXPECT_EQ(run.exit_code, 0) << run.out;
  for (const char* words : {"axes of turning: x is toward you", "a force up (+z) moved the handle up (+z)",
                            "a torque about toward you (+x) turned the handle about toward you (+x)",
                            "the device says that it exerted"})
    EXPECT_TRUE(holds(run.out, words)) << words << "\n" << run.out;
  const std::string sent = testing::content(folder / "record");
  EXPECT_TRUE(holds(sent, "forces off at the end, 0 rules broken"));
  expect_profile_in_use(run, folder / "profiles", "force-dimension", {}, true, true);
}

/// A device in a thread of its own, which joins over UDP by the header for devices, again after each goodbye.
class JoinedHandle {
 public:
  JoinedHandle(int port, const standin::HandleLaw& law) : handle_(law) {
    thread_ = std::thread([this, port] { run(port); });
  }
  ~JoinedHandle() {
    ends_ = true;
    thread_.join();
  }
  JoinedHandle(const JoinedHandle&) = delete;
  JoinedHandle& operator=(const JoinedHandle&) = delete;

  void obey(HandTask task, int axis) {
    const std::lock_guard<std::mutex> lock(mutex_);
    handle_.obey(task, axis);
  }

 private:
  void run(int port) {
    tactum_device_info info{};
    info.flags = TACTUM_ACTUATES_FORCE | TACTUM_SENSES_ROTATION;
    info.max_force_N = 8.0, info.stiffest_N_per_m = 1500.0;
    info.workspace_radius_m = 0.08, info.rate_Hz = 1000.0;
    std::snprintf(info.name, sizeof info.name, "moved");
    std::snprintf(info.serial, sizeof info.serial, "3");
    while (!ends_) {
      tactum_device_link link{};
      if (tactum_device_connect(&link, "127.0.0.1", port, &info, 50) != 0) continue;
      while (!ends_ && tactum_device_send(&link, state_of(&link)) == 0)
        std::this_thread::sleep_for(std::chrono::microseconds(300));
      tactum_device_disconnect(&link);
    }
  }

  /// The handle, up to now under the wrench that came last.
  const tactum_device_state* state_of(tactum_device_link* link) {
    double wrench[6];
    tactum_device_receive(link, wrench);
    const std::lock_guard<std::mutex> lock(mutex_);
    handle_.advance(wrench);
    state_ = {};
    state_.flags = TACTUM_HAS_VELOCITY;
    std::copy_n(handle_.x.begin(), 3, state_.position);
    std::copy(handle_.u.begin(), handle_.u.end(), state_.velocity);
    const double angle = std::hypot(handle_.x[3], handle_.x[4], handle_.x[5]);
    state_.orientation_wxyz[0] = std::cos(0.5 * angle);
    for (std::size_t i = 0; angle > 0.0 && i < 3; ++i)
      state_.orientation_wxyz[i + 1] = std::sin(0.5 * angle) * handle_.x[i + 3] / angle;
    return &state_;
  }

  std::mutex mutex_;
  standin::MovedHandle handle_;
  tactum_device_state state_{};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

TEST(TryDevice, OneInAnotherProcessPassesEveryStepAndItsProfileIsUsed) {
  const testing::ScratchFolder folder;
  std::filesystem::create_directory(folder / "profiles");
  const SetVariable profiles("TACTUM_DEVICE_PROFILES", folder / "profiles");
  standin::HandleLaw law;
  law.mass_kg = 0.15;
  law.damping_Ns_per_m = 2.0;
  const int port = 40000 + getpid() % 20000;
  const std::string device = "network:" + std::to_string(port);
  JoinedHandle handle(port, law);
  const ProgramRun run = tried(device, [&](HandTask task, int axis) { handle.obey(task, axis); });
  EXPECT_EQ(run.exit_code, 0) << run.out;
  for (const char* words : {"network moved", "axes of turning: x is toward you",
                            "a force to the right (+y) moved the handle to the right (+y)"})
    EXPECT_TRUE(holds(run.out, words)) << words << "\n" << run.out;
  expect_profile_in_use(run, folder / "profiles", device, law, false, false);
}

}  // namespace
}  // namespace tactum::try_device_test
