#include "tactum/recording/recorded_contacts.h"

#include "tactum/recording/byte_io.h"

namespace tactum::inline v0_1::recording {
namespace {

Vec3 vector_of(ByteReader& in) {
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = in.number<double>();
  return v;
}

/// Bytes of one tactum/Contact.
constexpr std::size_t kContactBytes = 3 * sizeof(std::int32_t) + 9 * sizeof(double);

}  // namespace

bool read_contacts(std::string_view message, RecordedContacts& read) {
  ByteReader in(message);
  read.index = in.number<std::uint64_t>();
  read.left_out = in.number<std::int32_t>();
  const auto count = in.number<std::uint32_t>();
  read.contacts.clear();
  if (!in.good() || message.size() - in.at() != count * kContactBytes) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    ShownContact& contact = read.contacts.emplace_back();
    contact.body_a = in.number<std::int32_t>();
    contact.body_b = in.number<std::int32_t>();
    contact.p_W = vector_of(in);
    contact.n_W = vector_of(in);
    contact.distance_m = in.number<double>();
    contact.force_N = in.number<double>();
    contact.cone_used = in.number<double>();
    const auto grip = in.number<std::int32_t>();
    if (grip < 0 || grip > static_cast<std::int32_t>(Grip::kSlips)) return false;
    contact.grip = static_cast<Grip>(grip);
  }
  return in.good() && in.done();
}

}  // namespace tactum::inline v0_1::recording
