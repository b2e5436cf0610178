#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/program.h"
#include "tactum/recording/crc32.h"
#include "tactum/recording/mcap_reader.h"
#include "tactum/recording/mcap_writer.h"

namespace tactum::mcap_test {
namespace {

using testing::content;
using testing::ScratchFolder;

/// Keeps everything.
struct Kept final : McapVisitor {
  Result<void> attachment(mcap::Attachment attachment, std::uint64_t) override {
    attachments.push_back(std::move(attachment));
    return {};
  }
  Result<void> message(const McapMessage& message) override {
    messages.push_back(message.channel.topic + ": " + std::string(message.data));
    times_ns.push_back(message.time_ns);
    return {};
  }
  std::vector<mcap::Attachment> attachments;
  std::vector<std::string> messages;
  std::vector<std::uint64_t> times_ns;
};

/// A file of `chunks` chunks with three messages each, and where each chunk with its indexes ends.
std::vector<std::uint64_t> write_file(const std::string& path, int chunks, bool close = true) {
  auto opened = McapWriter::open(path, "", "a test");
  EXPECT_TRUE(opened);
  McapWriter& writer = **opened;
  writer.add_metadata("about", {{"key", "value"}});
  writer.add_attachment({"scene.toml", "application/toml", "schema = 1\n"});
  const std::uint16_t schema = writer.add_schema({"tactum/One", "ros1msg", "float64 x"});
  const std::uint16_t one = writer.add_channel({schema, "/one", "ros1", {{"unit", "m"}}});
  const std::uint16_t two = writer.add_channel({0, "/two", "json", {}});
  std::vector<std::uint64_t> ends;
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const auto time_ns = static_cast<std::uint64_t>(chunk) * 100;
    writer.add_message(one, time_ns, "first of " + std::to_string(chunk));
    writer.add_message(two, time_ns + 10, std::string(200, 'x'));
    writer.add_message(one, time_ns + 20, "last of " + std::to_string(chunk));
    writer.end_chunk();
    ends.push_back(writer.bytes_written());
  }
  if (close) writer.close();
  EXPECT_FALSE(writer.trouble());
  return ends;
}

McapEnd read(const std::string& bytes, Kept& kept) { return read_mcap(McapBytes(bytes), "bytes", kept); }

TEST(Crc32, IsThatOfZip) {
  EXPECT_EQ(crc32("123456789"), 0xCBF43926u);  // the check value that every catalogue of checksums has
  EXPECT_EQ(crc32(""), 0u);
  const std::string text = "a text that is longer than eight bytes, and is given in two parts";
  EXPECT_EQ(crc32(text.substr(13), crc32(text.substr(0, 13))), crc32(text));
}

TEST(Mcap, WhatWasWrittenIsReadAgain) {
  const ScratchFolder folder;
  write_file(folder / "a.mcap", 3);
  Kept kept;
  const McapEnd end = read(content(folder / "a.mcap"), kept);
  EXPECT_TRUE(end.complete) << end.wrong->message();
  ASSERT_EQ(kept.attachments.size(), 1u);
  EXPECT_EQ(kept.attachments[0].name, "scene.toml");
  EXPECT_EQ(kept.attachments[0].data, "schema = 1\n");
  ASSERT_EQ(kept.messages.size(), 9u);
  EXPECT_EQ(kept.messages[3], "/one: first of 1");
  EXPECT_EQ(kept.messages[8], "/one: last of 2");
  EXPECT_EQ(kept.times_ns[8], 220u);
}

TEST(Mcap, AFileThatIsCutAnywhereIsReadUpToItsLastWholeChunk) {
  const ScratchFolder folder;
  const std::vector<std::uint64_t> ends = write_file(folder / "a.mcap", 3);
  const std::string whole = content(folder / "a.mcap");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Kept kept;
    const McapEnd end = read(whole.substr(0, size), kept);
    ASSERT_FALSE(end.complete) << size;
    ASSERT_TRUE(end.cut) << size << " " << end.wrong->message();
    ASSERT_LE(end.good_to, size);
    const auto chunks = std::count_if(ends.begin(), ends.end(), [&](std::uint64_t e) { return e <= size; });
    ASSERT_GE(kept.messages.size(), 3u * static_cast<std::size_t>(chunks)) << size;
  }
}

TEST(Mcap, EverySingleFlippedByteIsNoticedAndItsPlaceIsNamed) {
  const ScratchFolder folder;
  write_file(folder / "a.mcap", 2);
  const std::string whole = content(folder / "a.mcap");
  for (std::size_t place = 0; place < whole.size(); ++place)
    for (const int bits : {0x01, 0x80, 0xff}) {
      std::string bytes = whole;
      bytes[place] = static_cast<char>(bytes[place] ^ bits);
      Kept kept;
      const McapEnd end = read(bytes, kept);
      ASSERT_FALSE(end.complete) << place;
      ASSERT_TRUE(end.wrong) << place;
      EXPECT_NE(end.wrong->where.find("bytes, byte "), std::string::npos) << end.wrong->message();
    }
}

TEST(Mcap, ALengthThatIsALieTakesNoMemory) {
  std::string bytes(mcap::kMagic);
  bytes += "\x01";
  bytes += std::string(7, '\xff') + "\x7f";
  Kept kept;
  const McapEnd end = read(bytes + std::string(100, 'x'), kept);
  ASSERT_TRUE(end.wrong);
  EXPECT_NE(end.wrong->message().find("at most"), std::string::npos) << end.wrong->message();
}

TEST(Mcap, AFileThatIsRemovedIsToldOnce) {
  const ScratchFolder folder;
  auto opened = McapWriter::open(folder / "a.mcap", "", "a test");
  ASSERT_TRUE(opened);
  McapWriter& writer = **opened;
  const std::uint16_t channel = writer.add_channel({0, "/one", "json", {}});
  writer.add_message(channel, 0, "{}");
  writer.end_chunk();
  EXPECT_FALSE(writer.trouble());
  std::filesystem::remove(folder / "a.mcap");
  writer.add_message(channel, 1, "{}");
  writer.end_chunk();
  ASSERT_TRUE(writer.trouble());
  EXPECT_NE(writer.trouble()->message().find("removed"), std::string::npos);
  const std::uint64_t written = writer.bytes_written();
  writer.add_message(channel, 2, "{}");
  writer.close();
  EXPECT_EQ(writer.bytes_written(), written);
}

TEST(Mcap, AFileThatCannotBeMadeIsAnError) {
  const auto opened = McapWriter::open("/nowhere/at/all.mcap", "", "a test");
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message().find("/nowhere/at/all.mcap"), std::string::npos);
}

}  // namespace
}  // namespace tactum::mcap_test
