#pragma once
/// The contact points of a recorded frame: what a tactum/Contacts message holds.

#include <cstdint>
#include <string_view>
#include <vector>

#include "tactum/telemetry/frame_feed.h"

namespace tactum::inline v0_1 {

struct RecordedContacts {
  std::uint64_t index = 0;  ///< of the frame
  int left_out = 0;         ///< contacts beyond those recorded
  /// Bodies, point, normal, distance, force, share of the friction cone and grip; the rest is not recorded.
  std::vector<ShownContact> contacts;
};

namespace recording {
/// False where the bytes are not such a message. The list's room is kept from message to message.
bool read_contacts(std::string_view message, RecordedContacts& read);
}  // namespace recording

}  // namespace tactum::inline v0_1
