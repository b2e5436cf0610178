#include "tactum/telemetry/frame_feed.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/assert.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

float* put(const Wrench& F, float* out) noexcept {
  for (int i = 0; i < 3; ++i) *out++ = static_cast<float>(F.f[i]);
  for (int i = 0; i < 3; ++i) *out++ = static_cast<float>(F.t[i]);
  return out;
}

}  // namespace

int sample_size() noexcept {
  return static_cast<int>(6 * wrench_stages().size() + channels().size()) + kStageCount;
}

FrameFeed::FrameFeed(std::size_t bodies, double rate_Hz)
    : samples_(kSamples),
      pictures_([bodies](FramePicture& picture) {
        picture.X_WB.resize(bodies);
        picture.contacts.reserve(kContacts);
      }),
      frames_a_picture_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(rate_Hz / kPictures_Hz))) {
  TACTUM_DEMAND(sample_size() <= FrameSample::kRoom);
}

void FrameFeed::take(const FrameSource& frame, const StageClock* clock) noexcept {
  FrameSample sample;
  sample.index = frame.report.index;
  float* out = sample.values.data();
  for (const WrenchStage& stage : wrench_stages()) out = put(stage.of(frame), out);
  for (const Channel& channel : channels()) *out++ = static_cast<float>(channel.of(frame));
  for (int i = 0; clock != nullptr && i < kStageCount; ++i)
    *out++ = static_cast<float>(static_cast<double>(clock->stage_ns(static_cast<Stage>(i))) / 1e9);
  if (!samples_.push(sample))
    dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (frame.report.index % frames_a_picture_ != 0) return;
  draw(frame, pictures_.writable());
  pictures_.publish();
}

void FrameFeed::draw(const FrameSource& frame, FramePicture& picture) noexcept {
  const FrameState& state = frame.state;
  picture.index = frame.report.index;
  picture.X_WH = frame.report.X_WH;
  picture.X_WH_proxy = frame.report.X_WH_proxy;
  picture.X_WD = state.hand.X_WD;
  picture.grasped_body = state.hand.known ? state.hand.grasp.body : -1;
  std::copy(state.world.X_WB.begin(), state.world.X_WB.end(), picture.X_WB.begin());
  picture.contacts.clear();
  picture.contacts_left_out = 0;
  const std::span<const ContactPatch> patches = state.contacts.finder.patches();
  const double rest = frame.settings.dt_s - frame.report.time_of_impact_s;  // the impulses acted so long
  for (const ContactRow& row : state.response.rows()) {
    if (picture.contacts.size() == kContacts) {
      ++picture.contacts_left_out;
      continue;
    }
    ShownContact& contact = picture.contacts.emplace_back();
    contact = {};
    contact.body_a = row.body_a;
    contact.body_b = row.body_b;
    contact.p_W = row.p_W;
    contact.n_W = row.n_BA_W;
    contact.distance_m = row.distance;
    contact.tolerance_m = row.margin;
    contact.force_N = rest > 0.0 ? row.impulse / rest : 0.0;
    contact.patch = row.patch;
    if (row.friction_patch >= 0) {
      const FrictionUse& use = state.response.friction_uses()[Index(row.friction_patch)];
      contact.grip = use.sticks ? Grip::kSticks : Grip::kSlips;
      contact.cone_used = use.cone_used;
    }
    if (row.patch < 0 || Index(row.patch) >= patches.size()) continue;
    const ContactPatch& patch = patches[Index(row.patch)];
    contact.piece_a = patch.piece_a;
    contact.piece_b = patch.piece_b;
    contact.a = patch.manifold.a;
    contact.b = patch.manifold.b;
  }
}

}  // namespace tactum::inline v0_1
