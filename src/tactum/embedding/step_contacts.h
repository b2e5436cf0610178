#pragma once
/// The contacts of a step as other programs take them: what a display shows (telemetry/frame_feed.h), with
/// the friction of the surfaces they are on and how well the step has kept each.

#include <vector>

#include "tactum/telemetry/frame_feed.h"

namespace tactum::inline v0_1 {

struct StepContact : ShownContact {
  double friction_N = 0.0;  ///< along the surfaces the point is on, of all their points together [N]
  double friction_coefficient = 0.0;  ///< Coulomb's, of the two materials [-]
  /// Constraint response: how far the gap has opened in the step beyond what the contact law asks, of a point
  /// that pushes; by how much it has closed too far, of another. Along the normal; the second order of a
  /// turn, which the law leaves out, counts. Not a number in the penalty response, whose contacts yield [m].
  double residual_m = 0.0;
};

class StepContacts {
 public:
  /// Takes all contacts of the frame, in the order of its rows, whether they push or not. Allocates only
  /// where there have never been so many. Cost: 0.1 us a contact.
  void take(const FrameSource& frame);
  /// Of the frame that was taken last.
  const std::vector<StepContact>& contacts() const noexcept { return contacts_; }

 private:
  std::vector<ShownContact> shown_;
  std::vector<StepContact> contacts_;
};

}  // namespace tactum::inline v0_1
