#pragma once
/// The public header: everything that a program outside the library needs. The library itself includes the
/// headers of its layers one by one, and never this one.

#include "tactum/haptics/frame.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"
#include "tactum/version.h"
