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

bool stands_still(const FrameSource& frame, std::int32_t body) noexcept {
  const Twist& V = frame.state.world.V_WB[Index(body)];
  return V.v.isZero(0.0) && V.w.isZero(0.0) && body != frame.state.hand.grasp.body;
}

float* put(const Pose& X, float* out) noexcept {
  for (int i = 0; i < 3; ++i) *out++ = static_cast<float>(X.p[i]);
  const Quat q(X.R);
  for (const double number : {q.w(), q.x(), q.y(), q.z()}) *out++ = static_cast<float>(number);
  return out;
}

void copy_row(const ContactRow& row, std::span<const FrictionUse> uses, CopiedRow& to) noexcept {
  to.body_a = row.body_a;
  to.body_b = row.body_b;
  to.p_W = row.p_W;
  to.n_BA_W = row.n_BA_W;
  to.distance = row.distance;
  to.impulse = row.impulse;
  to.grip = Grip::kNone;
  to.cone_used = 0.0;
  if (row.friction_patch < 0) return;
  const FrictionUse& use = uses[Index(row.friction_patch)];
  to.grip = use.sticks ? Grip::kSticks : Grip::kSlips;
  to.cone_used = use.cone_used;
}

ShownContact shown_contact(const CopiedRow& row, double acted) noexcept {
  ShownContact contact{};
  contact.body_a = row.body_a;
  contact.body_b = row.body_b;
  contact.p_W = row.p_W;
  contact.n_W = row.n_BA_W;
  contact.distance_m = row.distance;
  contact.force_N = acted > 0.0 ? row.impulse / acted : 0.0;
  contact.grip = row.grip;
  contact.cone_used = row.cone_used;
  return contact;
}

ShownContact shown_contact(const FrameSource& frame, const ContactRow& row) noexcept {
  CopiedRow copy;
  copy_row(row, frame.state.response.friction_uses(), copy);
  ShownContact contact = shown_contact(copy, acted_s(frame.report, frame.settings.dt_s));
  contact.tolerance_m = row.margin;
  contact.patch = row.patch;
  contact.rests =
      contact.force_N == 0.0 && stands_still(frame, row.body_a) && stands_still(frame, row.body_b);
  const std::span<const ContactPatch> patches = frame.state.contacts.finder.patches();
  if (row.patch < 0 || Index(row.patch) >= patches.size()) return contact;
  const ContactPatch& patch = patches[Index(row.patch)];
  contact.piece_a = patch.piece_a;
  contact.piece_b = patch.piece_b;
  contact.a = patch.manifold.a;
  contact.b = patch.manifold.b;
  return contact;
}

/// Where there are more contacts than room, those that push most are kept: at the top of a heap stands the
/// one that is given up next.
template <class Row, class ContactOf>
int keep_strongest(std::span<const Row> rows, const ContactOf& contact_of, int grasped, std::size_t most,
                   std::vector<ShownContact>& shown) noexcept {
  const auto pushes_more = [grasped](const ShownContact& x, const ShownContact& y) {
    const auto on_grasped = [grasped](const ShownContact& c) {
      return c.force_N > 0.0 && (c.body_a == grasped || c.body_b == grasped);
    };
    return on_grasped(x) != on_grasped(y) ? on_grasped(x) : x.force_N > y.force_N;
  };
  shown.clear();
  int left_out = 0;
  for (const Row& row : rows) {
    const ShownContact contact = contact_of(row);
    if (shown.size() < most) {
      shown.push_back(contact);
      continue;
    }
    if (left_out++ == 0) std::make_heap(shown.begin(), shown.end(), pushes_more);
    if (!pushes_more(contact, shown.front())) continue;
    std::pop_heap(shown.begin(), shown.end(), pushes_more);
    shown.back() = contact;
    std::push_heap(shown.begin(), shown.end(), pushes_more);
  }
  return left_out;
}

}  // namespace

int sample_size() noexcept {
  return static_cast<int>(6 * wrench_stages().size() + channels().size()) + kStageCount;
}

std::vector<int> posed_bodies(const World& world) {
  std::vector<int> posed;
  for (Index body = 0; body < world.bodies.size() && posed.size() < FrameSample::kPosed; ++body)
    if (world.bodies[body].moves()) posed.push_back(static_cast<int>(body));
  return posed;
}

FrameFeed::FrameFeed(const World& world, double rate_Hz, std::size_t hands)
    : samples_(kSamples),
      pictures_([bodies = world.bodies.size(), hands](FramePicture& picture) {
        picture.other_hands.resize(hands - 1);
        picture.X_WB.resize(bodies);
        picture.contacts.reserve(kContacts);
      }),
      posed_(posed_bodies(world)),
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
  sample.posed = static_cast<int>(posed_.size());
  float* pose = sample.poses.data();
  for (const int body : posed_) pose = put(frame.state.world.X_WB[Index(body)], pose);
  if (!samples_.push(sample)) {  // a picture without its numbers would be shown beside those of another frame
    dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return;
  }
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
  TACTUM_DEMAND(picture.other_hands.size() == state.other_hands.size());
  for (Index i = 0; i < picture.other_hands.size(); ++i) {
    const HandStage& hand = state.other_hands[i].hand;
    const HandReport& report = state.other_reports[i];
    picture.other_hands[i] = {hand.known ? hand.grasp.body : -1, report.X_WH, report.X_WH_proxy,
                              rotated(hand.X_WD.R, report.shown)};
  }
  std::copy(state.world.X_WB.begin(), state.world.X_WB.end(), picture.X_WB.begin());
  picture.contacts_left_out = show_contacts(frame, kContacts, picture.contacts);
}

void copy_rows(std::span<const ContactRow> rows, std::span<const FrictionUse> uses, CopiedRow* to) noexcept {
  for (const ContactRow& row : rows) copy_row(row, uses, *to++);
}

double acted_s(const FrameReport& report, double dt_s) noexcept { return dt_s - report.time_of_impact_s; }

int show_contacts(const FrameSource& frame, std::size_t most, std::vector<ShownContact>& shown) noexcept {
  const int grasped = frame.state.hand.known ? frame.state.hand.grasp.body : -1;
  return keep_strongest(
      frame.state.response.rows(), [&](const ContactRow& row) { return shown_contact(frame, row); }, grasped,
      most, shown);
}

int show_contacts(std::span<const CopiedRow> rows, int grasped, double acted_s, std::size_t most,
                  std::vector<ShownContact>& shown) noexcept {
  return keep_strongest(
      rows, [acted_s](const CopiedRow& row) { return shown_contact(row, acted_s); }, grasped, most, shown);
}

}  // namespace tactum::inline v0_1
