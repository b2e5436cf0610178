#pragma once
/// Shipped scenes written in code, one of each kind, equal to their files in scenes/.

#include "tactum/scene/scene_description.h"

namespace tactum::testing {

SceneDescription block_on_plate();  // a free body, the handle's path
SceneDescription peg_round_h7g6();  // generated peg and hole, settings, tremor
SceneDescription nut_bolt();        // surfaces, turns, the coupling of the device
SceneDescription dipole_field();    // a field and its sample points
SceneDescription gears_pick();      // hinges, picking, the place of the device
SceneDescription lock();            // components, sliders, limits, friction
SceneDescription dominoes();        // free bodies, gravity, friction, restitution

}  // namespace tactum::testing
