#include "referee_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace tactum {
namespace {

std::vector<RefereedBody> bodies_of(const World& world) {
  std::vector<RefereedBody> bodies;
  for (const Body& body : world.bodies)
    bodies.push_back({&body.part->surface, body.moves(), body.no_contact_with});
  return bodies;
}

const char* what_is_wrong(const Crossing& crossing) {
  if (crossing.surfaces_cross) return "cross";
  return crossing.inside ? "do not cross, but a piece of one has got inside the other"
                         : "do not cross, but hang in each other otherwise than at the start";
}

}  // namespace

RefereeWatch::RefereeWatch(const Session& session, std::uint64_t stride)
    : session_(session),
      stride_(stride),
      referee_(bodies_of(session.scene().world), session.state().world.X_WB) {}

void RefereeWatch::look_at_end() {
  const std::uint64_t frames = session_.record().frames;
  if (frames > next_frame_) judge(frames - 1);
}

void RefereeWatch::judge(std::uint64_t frame) {
  ++judged_;
  next_frame_ = frame + 1;
  const std::vector<Crossing> faults = referee_.judge(session_.state().world.X_WB);
  if (faults.empty()) return;
  if (crossing_++ > 0) return;
  first_ = faults.front();
  first_frame_ = frame;
}

std::string RefereeWatch::name(int body) const {
  return session_.scene().world.bodies[static_cast<std::size_t>(body)].name;
}

std::string RefereeWatch::sentence() const {
  const std::string start = referee_.crossing_at_start() == 0
                                ? ""
                                : fmt::format("; {} pairs of bodies cross at the start and were not judged",
                                              referee_.crossing_at_start());
  if (crossing_ == 0) return fmt::format("{} frames judged: no surfaces have crossed{}", judged_, start);
  return fmt::format("{} of {} frames are wrong, the first at {:.4f} s: '{}' and '{}' {}{}", crossing_,
                     judged_, static_cast<double>(first_frame_) / session_.rate_Hz(), name(first_.body_a),
                     name(first_.body_b), what_is_wrong(first_), start);
}

bool some_surface(const Scene& scene) {
  const std::vector<Body>& bodies = scene.world.bodies;
  return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.part->is_surface(); });
}

}  // namespace tactum
