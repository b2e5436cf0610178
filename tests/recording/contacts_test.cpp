/// The contact points of a recorded frame, written and read again.

#include <gtest/gtest.h>

#include <string>

#include "tactum/recording/frame_slot.h"
#include "tactum/recording/recorded_contacts.h"

namespace tactum::contacts_test {
namespace {

std::string a_message() {
  RecordedContacts written;
  written.index = 41;
  written.left_out = 2;
  for (int i = 0; i < 3; ++i) {
    ShownContact contact;
    contact.body_a = i;
    contact.body_b = i + 1;
    contact.p_W = Vec3(0.1 * i, -0.2, 1.0 / 3.0);
    contact.n_W = Vec3(0.0, 0.6, 0.8);
    contact.distance_m = -0.001 * i;
    contact.force_N = 2.5 * i;
    contact.cone_used = 0.25;
    contact.grip = static_cast<Grip>(i);
    written.contacts.push_back(contact);
  }
  return recording::contacts_message(written);
}

TEST(RecordedContacts, AreThoseThatWereWritten) {
  RecordedContacts read;
  ASSERT_TRUE(recording::read_contacts(a_message(), read));
  EXPECT_EQ(read.index, 41u);
  EXPECT_EQ(read.left_out, 2);
  ASSERT_EQ(read.contacts.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const ShownContact& contact = read.contacts[static_cast<std::size_t>(i)];
    EXPECT_EQ(contact.body_a, i);
    EXPECT_EQ(contact.body_b, i + 1);
    EXPECT_EQ(contact.p_W, Vec3(0.1 * i, -0.2, 1.0 / 3.0));
    EXPECT_EQ(contact.n_W, Vec3(0.0, 0.6, 0.8));
    EXPECT_EQ(contact.distance_m, -0.001 * i);
    EXPECT_EQ(contact.force_N, 2.5 * i);
    EXPECT_EQ(contact.cone_used, 0.25);
    EXPECT_EQ(contact.grip, static_cast<Grip>(i));
  }
}

TEST(RecordedContacts, AMessageOfAnotherLengthOrCountIsNone) {
  const std::string message = a_message();
  RecordedContacts read;
  for (std::size_t size = 0; size < message.size(); ++size)
    EXPECT_FALSE(recording::read_contacts(message.substr(0, size), read)) << size;
  EXPECT_FALSE(recording::read_contacts(message + " ", read));
  std::string many = message;  // a count that no memory would hold
  many[12] = many[13] = many[14] = many[15] = static_cast<char>(0xff);
  EXPECT_FALSE(recording::read_contacts(many, read));
  std::string grip = message;
  grip[grip.size() - 4] = 7;
  EXPECT_FALSE(recording::read_contacts(grip, read));
}

}  // namespace
}  // namespace tactum::contacts_test
