#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "bench/peers/bullet_shape.h"
#include "bench/peers/peers.h"

namespace tactum::bench {
namespace {

class Bullet : public Engine {
 public:
  bool hold(const Shape& a, const Shape& b) override {
    a_ = bullet_shape(a);
    b_ = bullet_shape(b);
    return true;
  }
  void forget() override { guess_ = {1.0, 0.0, 0.0}; }
  void place(const Recording& recording, std::size_t i) override {
    pose_b_ = bullet_pose(recording.poses[i]);
    if (guess_.fuzzyZero()) guess_ = {1.0, 0.0, 0.0};
  }
  Answer answer() const override { return found_; }

 protected:
  std::unique_ptr<btConvexShape> a_, b_;
  btTransform pose_a_ = btTransform::getIdentity();
  btTransform pose_b_ = btTransform::getIdentity();
  btVector3 guess_{1.0, 0.0, 0.0};
  Answer found_;
};

class PairDetector final : public Bullet {
 public:
  bool hold(const Shape& a, const Shape& b) override {
    Bullet::hold(a, b);
    detector_ = std::make_unique<btGjkPairDetector>(a_.get(), b_.get(), &simplex_, &depths_);
    return true;
  }
  void query() override {
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA = pose_a_;
    input.m_transformB = pose_b_;
    btPointCollector collected;
    detector_->getClosestPoints(input, collected, nullptr);
    found_ = {collected.m_hasResult, collected.m_distance, 0};
  }

 private:
  btVoronoiSimplexSolver simplex_;
  btGjkEpaPenetrationDepthSolver depths_;
  std::unique_ptr<btGjkPairDetector> detector_;
};

class EpaSolver final : public Bullet {
 public:
  void query() override {
    btGjkEpaSolver2::sResults results;
    found_ = {};
    if (btGjkEpaSolver2::Distance(a_.get(), pose_a_, b_.get(), pose_b_, guess_, results)) {
      guess_ = results.witnesses[0] - results.witnesses[1];
      found_ = {true, results.distance, 0};
    } else if (btGjkEpaSolver2::Penetration(a_.get(), pose_a_, b_.get(), pose_b_, guess_, results, false)) {
      found_ = {true, results.distance, 0};
    }
  }
};

}  // namespace

std::unique_ptr<Engine> make_bullet() { return std::make_unique<PairDetector>(); }
std::unique_ptr<Engine> make_bullet_epa() { return std::make_unique<EpaSolver>(); }

}  // namespace tactum::bench
