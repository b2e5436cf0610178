/// A scene run to its end on the simulated device it was made for, and an observer of every frame.

#include <tactum/tactum.h>

#include <algorithm>
#include <cstdio>

namespace {

class LargestForce final : public tactum::LoopObserver {
 public:
  bool after_frame(const tactum::FrameRecord& record) noexcept override {
    largest_N = std::max(largest_N, record.F_D.f.norm());
    return true;  // false leads the wrench to zero and ends the run
  }
  double largest_N = 0.0;
};

}  // namespace

int main() {
  using namespace tactum;
  Result<Scene> scene = open_scene("block-on-plate");
  if (!scene) return 1;
  const auto frames = static_cast<std::uint64_t>(frames_of_motion(*scene));
  // Session::open_with(scene, std::make_unique<MyDevice>()) takes a Device of one's own;
  // session->start() runs it on a thread of its own, in real time.
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), SessionOptions{});
  if (!session) return std::fprintf(stderr, "%s\n", session.error().message().c_str()), 1;

  LargestForce observer;
  const Result<VirtualRun> run = (*session)->run_virtual(frames, &observer);
  if (!run) return 1;
  std::printf("%llu frames, largest force %.2f N, goals %s\n", static_cast<unsigned long long>(run->frames),
              observer.largest_N, (*session)->goals().all_met() ? "met" : "not met");
  return observer.largest_N > 0.0 && observer.largest_N == (*session)->record().max_force_N ? 0 : 1;
}
