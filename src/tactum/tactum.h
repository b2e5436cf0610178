#pragma once
/// The public header: everything that a program outside the library needs. The library itself includes the
/// headers of its layers one by one, and never this one. docs/embedding.md shows a program for each part.
///
/// What is declared in the headers named here is public, and so are the types it uses; what other headers
/// declare may change with any version.

// Queries on two shapes: distance and overlap of convex parts, clearance of surfaces.
#include "tactum/collision/closest_features.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/primitives.h"
#include "tactum/surface/surface_distance.h"

// Parts and worlds.
#include "tactum/dynamics/world.h"
#include "tactum/haptics/materials.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/mesh_import.h"

// Devices, by name or of the caller's own.
#include "tactum/devices/device.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/drivers/registry.h"

// Frames: a world stepped by the caller or by a loop.
#include "tactum/haptics/force_stage.h"
#include "tactum/haptics/simulation.h"
#include "tactum/loop/loop_thread.h"

// Scenes, from files or made in code, and sessions.
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_description.h"
#include "tactum/scene/scene_file.h"
#include "tactum/scene/scene_remarks.h"
#include "tactum/session/session.h"

#include "tactum/version.h"
