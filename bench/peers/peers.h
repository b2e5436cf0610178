#pragma once
/// The peers, each in a file of its own that is compiled when its library is installed.

#include "bench/engine.h"

namespace tactum::bench {

/// FCL's own GJK and EPA, started from the last frame's direction; convex pieces climb over neighbours.
std::unique_ptr<Engine> make_fcl();
/// The GJK and EPA that FCL builds on libccd.
std::unique_ptr<Engine> make_fcl_libccd();
/// libccd alone: GJK and EPA for overlapping pieces; it has no distance.
std::unique_ptr<Engine> make_libccd();
/// Bullet's btGjkPairDetector with its penetration solver, as its worlds use them; double precision.
std::unique_ptr<Engine> make_bullet();
/// Bullet's btGjkEpaSolver2, started from the last frame's direction; double precision.
std::unique_ptr<Engine> make_bullet_epa();
/// ODE's colliders of convex pieces and boxes: contacts of overlapping pieces; it has no distance.
std::unique_ptr<Engine> make_ode();

}  // namespace tactum::bench
