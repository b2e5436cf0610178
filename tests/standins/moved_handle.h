#pragma once
/// The handle of a stand-in that moves, in real time, under the wrench that is exerted on it and under a hand
/// that does what a test asks of it. It shares no code with the simulated device:
///
///   m x'' + b x' + c sign(x') = F + hand,    hand = k (target - x) - d x', or nothing when it lets go
///
/// for each of the three directions and, with an inertia and a torque, for each of the three turns; a turn is
/// kept as a rotation vector, which is exact while it stays about one axis.

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>

namespace tactum::standin {

enum class HandTask { kHold, kMove, kTurn, kPress, kRelease };

/// What a handle is, and the hand at it.
struct HandleLaw {
  double mass_kg = 0.25, inertia_kg_m2 = 4e-4;
  double damping_Ns_per_m = 1.2, damping_Nms_per_rad = 4e-3;
  double friction_N = 0.05, friction_Nm = 5e-4;
  double hand_N_per_m = 600.0, hand_Ns_per_m = 15.0;
  double hand_Nm_per_rad = 2.0, hand_Nms_per_rad = 0.05;
};

class MovedHandle {
 public:
  using Six = std::array<double, 6>;  // three lengths, three angles

  explicit MovedHandle(const HandleLaw& law = {}) : law_(law), now_s_(clock_s()) {}

  static double clock_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  /// The hand puts the handle into the middle, at rest, and begins the task.
  void obey(HandTask task, int axis) {
    x = u = Six{};
    task_ = task;
    end_ = Six{};
    if (task == HandTask::kMove) end_[static_cast<std::size_t>(axis)] = 0.060;
    if (task == HandTask::kTurn) end_[static_cast<std::size_t>(axis) + 3] = 0.9;
    if (task == HandTask::kPress) end_[2] = -0.018;
    now_s_ = begin_s_ = clock_s();
  }

  /// Up to now, under the wrench that has been exerted since the last call.
  void advance(const double* wrench) {
    constexpr double kStep_s = 1e-4;
    for (const double until_s = clock_s(); now_s_ < until_s;) {
      const double h = std::min(kStep_s, until_s - now_s_);
      now_s_ += h;
      for (std::size_t i = 0; i < 6; ++i) step(i, wrench[i], h);
    }
  }

  /// The orientation, row by row.
  std::array<double, 9> frame() const {
    const double angle = std::sqrt(x[3] * x[3] + x[4] * x[4] + x[5] * x[5]);
    if (angle == 0.0) return {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double a = x[3] / angle, b = x[4] / angle, c = x[5] / angle;
    const double s = std::sin(angle), k = 1.0 - std::cos(angle), e = std::cos(angle);
    return {e + a * a * k,     a * b * k - c * s, a * c * k + b * s, b * a * k + c * s, e + b * b * k,
            b * c * k - a * s, c * a * k - b * s, c * b * k + a * s, e + c * c * k};
  }

  Six x{}, u{};  // pose and velocity

 private:
  void step(std::size_t i, double wrench, double h) {
    constexpr double kWait_s = 0.1, kTime_s = 0.8;  // before a motion, and of it
    const bool turns = i > 2;
    const double mass = turns ? law_.inertia_kg_m2 : law_.mass_kg;
    double force = wrench - (turns ? law_.damping_Nms_per_rad : law_.damping_Ns_per_m) * u[i];
    if (task_ != HandTask::kRelease) {
      const double share = std::clamp((now_s_ - begin_s_ - kWait_s) / kTime_s, 0.0, 1.0);
      force += (turns ? law_.hand_Nm_per_rad : law_.hand_N_per_m) * (share * end_[i] - x[i]) -
               (turns ? law_.hand_Nms_per_rad : law_.hand_Ns_per_m) * u[i];
    }
    u[i] += h * force / mass;
    const double slowed = h * (turns ? law_.friction_Nm : law_.friction_N) / mass;
    u[i] -= std::clamp(u[i], -slowed, slowed);
    x[i] += h * u[i];
  }

  HandleLaw law_;
  HandTask task_ = HandTask::kHold;
  Six end_{};  // of the motion
  double now_s_, begin_s_ = 0.0;
};

/// What a test asks of the hand at a stand-in in another process, through a file that both map.
class AskedHand {
 public:
  explicit AskedHand(const std::string& path) {
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0) return;
    if (ftruncate(file, sizeof(Asked)) == 0) {
      void* memory = mmap(nullptr, sizeof(Asked), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      if (memory != MAP_FAILED) asked_ = static_cast<Asked*>(memory);
    }
    close(file);
  }
  ~AskedHand() {
    if (asked_ != nullptr) munmap(asked_, sizeof(Asked));
  }
  AskedHand(const AskedHand&) = delete;
  AskedHand& operator=(const AskedHand&) = delete;

  bool is_mapped() const { return asked_ != nullptr; }
  void ask(HandTask task, int axis) {
    asked_->task.store(static_cast<int>(task));
    asked_->axis.store(axis);
    ++asked_->count;
  }
  /// Lets the handle obey what was asked since the last call.
  void pass_on(MovedHandle& handle) {
    const int count = asked_->count.load();
    if (count != passed_) handle.obey(static_cast<HandTask>(asked_->task.load()), asked_->axis.load());
    passed_ = count;
  }

 private:
  struct Asked {
    std::atomic<int> count, task, axis;
  };
  Asked* asked_ = nullptr;
  int passed_ = 0;
};

}  // namespace tactum::standin
