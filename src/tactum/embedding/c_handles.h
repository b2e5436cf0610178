#pragma once
/// What the handles of the C interface are.

#include <memory>
#include <utility>
#include <vector>

#include "tactum/embedding/c_calls.h"
#include "tactum/embedding/part_query.h"
#include "tactum/embedding/stepped_scene.h"
#include "tactum/embedding/world_maker.h"

// The names are those of C, which stands outside the namespace.
struct tactum_part {  // NOLINT(readability-identifier-naming)
  std::shared_ptr<const tactum::QueriedPart> part;
};

struct tactum_world {  // NOLINT(readability-identifier-naming)
  tactum::WorldMaker maker;
};

struct tactum_simulation {  // NOLINT(readability-identifier-naming)
  explicit tactum_simulation(std::unique_ptr<tactum::SteppedScene> opened)
      : scene(std::move(opened)), samples(scene->hands()), F_D(scene->hands()) {}
  std::unique_ptr<tactum::SteppedScene> scene;
  std::vector<tactum::HandSample> samples;  // of a step, by hand
  std::vector<tactum::Wrench> F_D;          // the same
  bool hand_is_open = false;
};

namespace tactum::inline v0_1::c_calls {

inline tactum_status hand_over_scene(Result<std::unique_ptr<SteppedScene>> opened,
                                     tactum_simulation** scene) {
  if (!opened) return refuse(opened.error());
  *scene = new tactum_simulation(std::move(*opened));
  return TACTUM_OK;
}

}  // namespace tactum::inline v0_1::c_calls
