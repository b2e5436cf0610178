#pragma once
/// Rigid-body engines that move free and hinged bodies, each in a file of its own that is compiled when its
/// library is installed. docs/mechanics.md states their settings.

#include "bench/free_motion.h"

namespace tactum::bench {

std::unique_ptr<MotionEngine> make_bullet_motion(const FreeMotion& motion, double step_s);
std::unique_ptr<MotionEngine> make_ode_motion(const FreeMotion& motion, double step_s);
std::unique_ptr<MotionEngine> make_mujoco_motion(const FreeMotion& motion, double step_s);

}  // namespace tactum::bench
