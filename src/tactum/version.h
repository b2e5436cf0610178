#pragma once
/// The version of the library: the only place where it stands. CMakeLists.txt reads it from here.
///
/// Versions are semantic (https://semver.org). While the major number is 0, a new minor number may change
/// interfaces.

#define TACTUM_VERSION_MAJOR 0
#define TACTUM_VERSION_MINOR 1
#define TACTUM_VERSION_PATCH 0

/// One number that can be compared by the preprocessor: `#if TACTUM_VERSION >= 100` asks for 0.1.0 or newer.
#define TACTUM_VERSION (TACTUM_VERSION_MAJOR * 10000 + TACTUM_VERSION_MINOR * 100 + TACTUM_VERSION_PATCH)
