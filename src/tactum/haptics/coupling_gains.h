#pragma once
/// The largest stiffness of the virtual coupling on a device, at a rate. A spring K and damper B that are
/// sampled every T and act after a delay of tau generate energy at the hand, and the device's own damping b
/// must dissipate it:
///
///   b > K (T / 2 + tau) + |B|            [Colgate and Schenkel 1994], with delay [Gil 2009]
///
/// With it the port is passive whatever the hand does, also when it releases the handle. Devices are built to
/// have as little damping as possible, so few walls in daily use satisfy it (a Premium: 0.05 N s/m, 100 N/m
/// at 1 kHz). A hand that holds the handle adds its damping, 3 N s/m when it is loose: with that the same law
/// bounds the stiffness that does not buzz in a hand. Both bounds are given; the gains are chosen for the
/// hand, and the observer (passivity.h) watches for the rest.
///
/// The mass of the handle is in neither: a mass is passive. It bounds the coupling's damper, which acts late
/// as the spring does, and turns a light handle around faster than it measures it:
///
///   B T / m < 2 sin(pi / (4 n + 2)),     n T the delay      [Levin and May 1976]
///
/// The smaller m counts, that of the device alone; where it is unknown nothing is bounded by it.
///
/// A coarse encoder makes a stiff spring chatter by one step and back, which friction stops when
///
///   friction > K step / 2                [Abbott and Okamura 2005]
///
/// On a device that cannot turn the handle there is no loop around the turning spring, so no bound. It is
/// never felt and only determines how far the proxy yields: chosen stiff, so that the rotation follows the
/// hand and a contact that resists it is felt as force, the only thing that can be.
///
/// A coupling is stated at the device, so the bounds hold at every workspace scale (workspace_scale.h).

#include <string>

#include "tactum/devices/device.h"
#include "tactum/loop/passivity.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// The damping that a coupling requires: K (T / 2 + tau) + |B|. The same for rotation.
double damping_needed(double stiffness, double damping, double period_s, double delay_s) noexcept;

/// The stiffest spring that `device_damping` allows beside a damper B; 0 when B alone is too much.
double stiffness_allowed(double device_damping, double damping, double period_s, double delay_s) noexcept;

/// The strongest damper that does not swing on a free handle of this mass; infinite where the mass is unknown
/// (0). The same for rotation, with the moment of inertia.
double damper_allowed(double mass, double period_s, double delay_s) noexcept;

/// The bounds of the coupling in one of its halves, translation or rotation (then N m/rad).
struct GainBounds {
  double alone = 0.0;       ///< nobody holds the handle: passive [N/m]
  double loose_hand = 0.0;  ///< in a loose hand [N/m]
  double damper = 0.0;      ///< on a free handle; infinite where its mass is unknown [N s/m]
  double encoder = 0.0;     ///< friction stops the chatter; infinite where friction or step is unknown [N/m]
};

struct CouplingGains {
  Coupling coupling;  ///< chosen
  GainBounds translation, rotation;
};

/// The gains for a device served at `rate_Hz`: half of what a loose hand allows, no more than the encoder and
/// the device's makers allow, with a tenth of that hand's damping as its damper, but no more than half of
/// what the handle's mass allows.
CouplingGains coupling_gains(const DeviceInfo& info, double rate_Hz);

/// The settings of the passivity stage for this device.
PortSettings port_settings(const DeviceInfo& info);

/// What a workspace scale other than one makes of a coupling in the scene, in a sentence for people; else
/// empty.
std::string scale_sentence(const Coupling& coupling, double scale);

/// Where a coupling is stable on a device.
enum class Stability {
  kAlways,    ///< in any hand, and when the handle is let go
  kInHand,    ///< in any hand that holds the handle
  kUncertain  ///< not even in a loose hand
};
Stability stability_of(const Coupling& coupling, const DeviceInfo& info, double rate_Hz);

/// Whether a coupling is stable on this device in a loose hand and when it is let go, with the bounds that it
/// exceeds, in sentences for people.
std::string margin_sentence(const Coupling& coupling, const DeviceInfo& info, double rate_Hz);

}  // namespace tactum::inline v0_1
