#include "tactum/haptics/frame_snapshot.h"

#include <string>

#include "tactum/base/carried_state.h"

namespace tactum::inline v0_1 {

std::size_t write_snapshot(const FrameState& state, std::span<char> room) noexcept {
  StateWriter writer(room);
  StateVisit<StateWriter>{writer}(state);
  return writer.size();
}

std::uint64_t snapshot_layout(const FrameState& state) noexcept { return layout_of(state); }

const char* snapshot_part(const FrameState& state, std::size_t byte) noexcept {
  StateWriter writer({});
  StateVisit<StateWriter> visit{writer};
  // As FrameState::carried() has them; what is before the hand are the bodies.
  const auto before_end_of = [&](const auto&... parts) {
    visit(parts...);
    return byte < writer.size();
  };
  if (before_end_of(state.world, state.X_WB_start, state.load_work_J)) return "bodies";
  if (before_end_of(state.hand)) return "hand";
  if (before_end_of(state.contacts)) return "contacts";
  if (before_end_of(state.response)) return "response";
  if (before_end_of(state.smoothing)) return "smoothing";
  if (before_end_of(state.port, state.coupling_work_J)) return "energy balance";
  return before_end_of(state.safety) ? "safety" : "other hands";
}

Result<void> read_snapshot(std::string_view bytes, FrameState& state) {
  StateReader reader(bytes);
  StateVisit<StateReader>{reader}(state);
  if (!reader.done())
    return Error{"a snapshot is not of this scene", "broken at its byte " + std::to_string(reader.at()),
                 "the state of its bodies, contacts and stages", ""};
  return {};
}

}  // namespace tactum::inline v0_1
