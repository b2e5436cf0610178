#include "tactum/response/waiting.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tactum/base/frame_rate.h"
#include "tactum/math/screw.h"
#include "tactum/response/joined_bodies.h"
#include "tactum/response/sleep.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// A gap on trial takes between one test and one in every round of free_bodies.cpp.
constexpr int kFewestRounds = 1;
constexpr int kMostRounds = 8;

/// While a body is deferred, the estimate of how far it would go fades to this fraction in kReferenceStep_s,
/// so that it is admitted in the end however many gaps it has.
constexpr double kFading = 0.8;

// A body rests when in this time it has moved no farther than this fraction of its radius. A neighbour as
// fast as this wakes it.
constexpr double kRest_s = 0.06;
constexpr double kRestShare = 0.03;
constexpr double kWakingSpeed = 0.15;  // [m/s]

bool asleep(const Waiting& w, Index body) { return w.contacts_at_rest[body] > 0; }

/// Puts bodies to sleep, and wakes them.
void watch_rest(ConstraintStep& step) {
  Waiting& w = step.own.waiting;
  const int rest_frames = frames_in(kRest_s, step.dt_s);
  std::fill(w.contacts.begin(), w.contacts.end(), 0);
  std::fill(w.hit.begin(), w.hit.end(), 0);
  const auto fast = [&](int body) {
    return !asleep(w, Index(body)) && step.bodies.V_WB[Index(body)].v.norm() > kWakingSpeed;
  };
  for (const ContactPatch& patch : step.patches) {
    ++w.contacts[Index(patch.body_a)];
    ++w.contacts[Index(patch.body_b)];
    if (fast(patch.body_b)) w.hit[Index(patch.body_a)] = 1;
    if (fast(patch.body_a)) w.hit[Index(patch.body_b)] = 1;
  }
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    if (!step.world.bodies[i].moves()) continue;
    const Pose& X_WB = step.bodies.X_WB[i];
    const double radius = step.radius_m[i];
    const Twist moved = twist_between(w.X_rest[i], X_WB, 1.0);
    const bool left = moved.v.norm() + moved.w.norm() * radius > kRestShare * radius;
    const bool lost = 2 * w.contacts[i] < std::max(1, w.contacts_at_rest[i]);
    if (left || lost || w.hit[i] || step.priority[i] != priority::kOther) {
      w.X_rest[i] = X_WB;
      w.rested[i] = w.contacts_at_rest[i] = 0;
    } else if (!w.waits[i] && ++w.rested[i] >= rest_frames) {
      w.contacts_at_rest[i] = std::max(w.contacts_at_rest[i], w.contacts[i]);
    }
  }
}

/// Whether the last steps of its bodies, taken again, would leave so little of the gap that it must be
/// tested.
bool needs_test(const ContactPatch& patch, const ConstraintStep& step) {
  const Waiting& w = step.own.waiting;
  return w.travel[Index(patch.body_a)] + w.travel[Index(patch.body_b)] >= 0.5 * patch.distance;
}

/// The patches of each body that need a test: patch_of[first_patch[i] .. first_patch[i + 1]).
void list_patches(ConstraintStep& step) {
  Waiting& w = step.own.waiting;
  const std::span<const ContactPatch> patches = step.patches;
  std::fill(w.first_patch.begin(), w.first_patch.end(), 0);
  for (const ContactPatch& patch : patches)
    if (needs_test(patch, step))
      for (const int body : {patch.body_a, patch.body_b}) ++w.first_patch[Index(body) + 1];
  std::partial_sum(w.first_patch.begin(), w.first_patch.end(), w.first_patch.begin());
  w.next_patch.assign(w.first_patch.begin(), w.first_patch.end());
  w.patch_of.resize(Index(w.first_patch.back()));  // within what was reserved
  for (Index p = 0; p < patches.size(); ++p)
    if (needs_test(patches[p], step))
      for (const int body : {patches[p].body_a, patches[p].body_b})
        w.patch_of[Index(w.next_patch[Index(body)]++)] = static_cast<int>(p);
}

/// Admits bodies while the tests suffice, those of the highest priority first.
void admit_bodies(ConstraintStep& step) {
  Waiting& w = step.own.waiting;
  list_patches(step);
  w.counted.assign(step.patches.size(), 0);
  w.order.clear();
  for (Index i = 0; i < step.world.bodies.size(); ++i)
    if (step.world.bodies[i].moves() && !asleep(w, i) &&
        (!step.gaps.blocked(static_cast<int>(i)) || is_grasped(step, i)))
      w.order.push_back(static_cast<int>(i));
  std::sort(w.order.begin(), w.order.end(), [&](int a, int b) {
    const Index i = Index(a);
    const Index k = Index(b);
    if (step.priority[i] != step.priority[k]) return step.priority[i] < step.priority[k];
    return w.waited[i] != w.waited[k] ? w.waited[i] > w.waited[k] : a < b;
  });
  int left = step.gaps.tests_left() / w.rounds;
  for (const int body : w.order) {
    const auto begin = w.patch_of.begin() + w.first_patch[Index(body)];
    const auto end = w.patch_of.begin() + w.first_patch[Index(body) + 1];
    const auto tests =
        static_cast<int>(std::count_if(begin, end, [&](int p) { return w.counted[Index(p)] == 0; }));
    if (tests > left && !is_grasped(step, Index(body))) continue;
    left = std::max(0, left - tests);
    std::for_each(begin, end, [&](int p) { w.counted[Index(p)] = 1; });
    w.waits[Index(body)] = 0;
  }
}

}  // namespace

void defer_bodies(ConstraintStep& step) noexcept {
  Waiting& w = step.own.waiting;
  if (w.ran_out) {
    w.rounds = std::min(2 * w.rounds, kMostRounds);
  } else {
    w.rounds = std::max(w.rounds - 1, kFewestRounds);
  }
  w.ran_out = false;
  const bool some_blocked = step.work.left_unproven > 0 || step.gaps.capacity_reached();
  if (!step.gaps.budget_limited() && !some_blocked) {
    std::fill(w.waits.begin(), w.waits.end(), 0);
    std::fill(w.waited.begin(), w.waited.end(), 0);
    std::fill(w.rested.begin(), w.rested.end(), 0);
    std::fill(w.contacts_at_rest.begin(), w.contacts_at_rest.end(), 0);
    if (!step.own.free.others) {
      wake(step.own.sleep);
    } else if (step.settings.budget.sleep) {
      let_sleep(step);
    }
    return;
  }
  wake(step.own.sleep);
  watch_rest(step);
  std::fill(w.waits.begin(), w.waits.end(), 1);
  admit_bodies(step);
  wait_together(step);
  const double fading = std::pow(kFading, step.dt_s / kReferenceStep_s);
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    w.waited[i] = w.waits[i] && !asleep(w, i) ? w.waited[i] + 1 : 0;
    if (!w.waits[i] || !step.world.bodies[i].moves()) continue;
    if (asleep(w, i)) {
      ++step.report.asleep;
      w.V_kept[i] = step.bodies.V_WB[i] = {};
      w.travel[i] = 0.0;
      continue;
    }
    w.travel[i] *= fading;
    ++step.report.waiting;
    step.report.flags |= frame_flag::kBudgetShort;
    step.report.longest_wait = std::max(step.report.longest_wait, w.waited[i]);
    step.bodies.V_WB[i] = {};  // go_on() gives it back what it had before weight and load
  }
}

void go_on(ConstraintStep& step) noexcept {
  Waiting& w = step.own.waiting;
  for (Index i = 0; i < w.waits.size(); ++i)
    if (w.waits[i]) step.bodies.V_WB[i] = w.V_kept[i];
}

}  // namespace tactum::inline v0_1
