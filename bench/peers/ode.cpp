#include <array>

#include "bench/peers/ode_geometry.h"
#include "bench/peers/peers.h"

namespace tactum::bench {
namespace {

class Ode final : public Engine {
 public:
  Ode() { dInitODE2(0); }
  ~Ode() override {
    a_.reset();
    b_.reset();
    dCloseODE();
  }
  bool reports_distances() const override { return false; }
  bool hold(const Shape& a, const Shape& b) override {
    // Its collider tries every pair of edges, 0.1 us each.
    constexpr std::size_t kMostEdgePairs = 1'000'000;
    if (a.polytope.edges.size() * b.polytope.edges.size() > kMostEdgePairs) return false;
    a_ = std::make_unique<OdeGeometry>(a);
    b_ = std::make_unique<OdeGeometry>(b);
    return true;
  }
  void forget() override {}
  void place(const Recording& recording, std::size_t i) override { b_->place(recording.poses[i]); }
  void query() override {
    const int count = dCollide(a_->id(), b_->id(), static_cast<int>(contacts_.size()), contacts_.data(),
                               sizeof(dContactGeom));
    double depth = 0.0;
    for (int i = 0; i < count; ++i) depth = std::max(depth, contacts_[static_cast<std::size_t>(i)].depth);
    found_ = {count > 0, -depth, 0};
  }
  Answer answer() const override { return found_; }

 private:
  std::unique_ptr<OdeGeometry> a_, b_;
  std::array<dContactGeom, 32> contacts_{};
  Answer found_;
};

}  // namespace

std::unique_ptr<Engine> make_ode() { return std::make_unique<Ode>(); }

}  // namespace tactum::bench
