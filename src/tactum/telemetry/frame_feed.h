#pragma once
/// From the loop's thread to a watching thread: every frame's numbers, and now and then the whole picture.
///
///   loop thread    take(frame) --- every frame ---> ring of FrameSample ---> pop, in order
///                              --- at kPictures_Hz ---> newest FramePicture ---> the newest only
///
/// The loop writes plain records whether or not anyone reads: its work does not depend on readers. It never
/// waits; when the ring is full the newest sample is lost and counted, and no picture is made of its frame.

#include <atomic>
#include <cstdint>
#include <vector>

#include "tactum/base/newest.h"
#include "tactum/base/spsc_ring.h"
#include "tactum/response/settings.h"
#include "tactum/telemetry/channels.h"
#include "tactum/telemetry/run_record.h"

namespace tactum::inline v0_1 {

/// The numbers of one frame: six a wrench stage (force, torque), then the channels, then the times of the
/// frame's stages [s] (zero when nobody takes them); and the poses of the first bodies that move.
struct FrameSample {
  static constexpr int kRoom = 96;
  static constexpr int kPosed = 12;       ///< most bodies whose pose it has
  static constexpr int kPoseNumbers = 7;  ///< of a pose: place [m], quaternion w, x, y, z
  std::uint64_t index = 0;                ///< frames since the start
  std::array<float, kRoom> values{};
  std::array<float, kPosed * kPoseNumbers> poses{};  ///< X_WB of posed_bodies(), one after the other
  int posed = 0;                                     ///< bodies whose pose it has
};

/// How many of FrameSample::values are used.
int sample_size() noexcept;

/// The bodies whose poses samples have: those that move, the first kPosed of them.
std::vector<int> posed_bodies(const World& world);

/// The state of friction at a contact point that pushes.
enum class Grip : std::int32_t { kNone, kSticks, kSlips };

/// A contact point that pushes, or would if it were nearer.
struct ShownContact {
  std::int32_t body_a = -1, body_b = -1, piece_a = -1, piece_b = -1;
  Feature a, b;              ///< of the pieces
  Vec3 p_W = Vec3::Zero();   ///< [m]
  Vec3 n_W = Vec3::Zero();   ///< from B to A, as shaded [-]
  double distance_m = 0.0;   ///< signed [m]
  double tolerance_m = 0.0;  ///< pushes below this [m]
  double force_N = 0.0;      ///< along n on A [N]
  std::int32_t patch = -1;   ///< points of one patch have one number
  Grip grip = Grip::kNone;   ///< of the surfaces it is part of
  double cone_used = 0.0;    ///< the fraction of their friction cone in use, 0 to 1 [-]
  bool rests = false;        ///< neither body moves: no force is computed between bodies that sleep
};

/// What recordings tell of a row of the contact problem: small, so that the loop's thread can pass every row
/// on, and another can choose.
struct CopiedRow {
  std::int32_t body_a = -1, body_b = -1;
  Grip grip = Grip::kNone;
  Vec3 p_W = Vec3::Zero();     ///< [m]
  Vec3 n_BA_W = Vec3::Zero();  ///< [-]
  double distance = 0.0;       ///< [m]
  double impulse = 0.0;        ///< [N s]
  double cone_used = 0.0;      ///< as in ShownContact [-]
};

/// Fills `to`, which has as many entries as there are rows. `uses` are Response::friction_uses().
void copy_rows(std::span<const ContactRow> rows, std::span<const FrictionUse> uses, CopiedRow* to) noexcept;

/// The contacts of a frame, at most `most`: those that push most, on the grasped part first. `shown` has room
/// for them already. Returns how many are left out. No allocation.
int show_contacts(const FrameSource& frame, std::size_t most, std::vector<ShownContact>& shown) noexcept;

/// The same of copied rows, without what they do not have. `grasped` is the body in the hand, -1 for none,
/// and `acted_s` how long the impulses acted [s].
int show_contacts(std::span<const CopiedRow> rows, int grasped, double acted_s, std::size_t most,
                  std::vector<ShownContact>& shown) noexcept;

/// How long the impulses of a frame acted [s].
double acted_s(const FrameReport& report, double dt_s) noexcept;

/// A hand after the first.
struct HandPicture {
  int grasped_body = -1;  ///< the body that it holds; -1: none
  Pose X_WH, X_WH_proxy;  ///< of its probe, and of the handle on its part [m]
  Wrench shown_W;         ///< that was sent to its device, at the handle, world axes [N, N m]
};

/// The poses and contacts of one frame.
struct FramePicture {
  std::uint64_t index = 0;
  Pose X_WH, X_WH_proxy, X_WD;
  int grasped_body = -1;                 ///< the body in the hand; -1: none
  std::vector<HandPicture> other_hands;  ///< the second and all after it
  std::vector<Pose> X_WB;                ///< of every body
  std::vector<ShownContact> contacts;
  int contacts_left_out = 0;  ///< for lack of room
};

class FrameFeed {
 public:
  static constexpr double kPictures_Hz = 125.0;      ///< twice what a screen shows [Hz]
  static constexpr std::size_t kSamples = 1u << 14;  ///< sixteen seconds at 1 kHz until they are popped
  static constexpr std::size_t kContacts = 256;      ///< contacts of a picture: those that push most

  /// Of a run with so many hands.
  FrameFeed(const World& world, double rate_Hz, std::size_t hands = 1);

  /// The loop's thread, after the frame. `clock` may be null. No allocation, no lock, no clock.
  void take(const FrameSource& frame, const StageClock* clock) noexcept;

  // One other thread.
  bool pop(FrameSample& sample) noexcept { return samples_.pop(sample); }
  /// True when there is a newer picture than last time.
  bool look() noexcept { return pictures_.take(); }
  const FramePicture& picture() const noexcept { return pictures_.readable(); }
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  static void draw(const FrameSource& frame, FramePicture& picture) noexcept;

  SpscRing<FrameSample> samples_;
  Newest<FramePicture> pictures_;
  std::vector<int> posed_;
  std::atomic<std::uint64_t> dropped_{0};
  std::uint64_t frames_a_picture_;
};

}  // namespace tactum::inline v0_1
