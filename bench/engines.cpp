#include <vector>

#include "bench/engine.h"
#include "bench/peers/peers.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/penetration.h"

namespace tactum::bench {
namespace {

using Query = PairDistance (*)(const Polytope&, const Polytope&, const Pose&, PairCache&) noexcept;

class Tracked final : public Engine {
 public:
  explicit Tracked(Query function) : function_(function) {}
  bool hold(const Shape& a, const Shape& b) override {
    a_ = &a.polytope;
    b_ = &b.polytope;
    return true;
  }
  void forget() override { cache_ = {}; }
  void place(const Recording& recording, std::size_t i) override { X_AB_ = recording.poses[i]; }
  void query() override {
    const PairDistance x = function_(*a_, *b_, X_AB_, cache_);
    found_ = {x.certified(), x.distance, x.steps};
  }
  Answer answer() const override { return found_; }

 private:
  Query function_;
  const Polytope* a_ = nullptr;
  const Polytope* b_ = nullptr;
  Pose X_AB_;
  PairCache cache_;
  Answer found_;
};

}  // namespace

std::unique_ptr<Engine> make_closest_features() { return std::make_unique<Tracked>(closest_features); }
std::unique_ptr<Engine> make_penetration() { return std::make_unique<Tracked>(penetration_depth); }

std::span<const EngineEntry> peers() {
  static const std::vector<EngineEntry> entries = {
#ifdef TACTUM_PEER_FCL
      {"fcl", make_fcl},       {"fcl-libccd", make_fcl_libccd},
#endif
#ifdef TACTUM_PEER_LIBCCD
      {"libccd", make_libccd},
#endif
#ifdef TACTUM_PEER_BULLET
      {"bullet", make_bullet}, {"bullet-epa", make_bullet_epa},
#endif
#ifdef TACTUM_PEER_ODE
      {"ode", make_ode},
#endif
  };
  return entries;
}

}  // namespace tactum::bench
