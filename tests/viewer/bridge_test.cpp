#include <gtest/gtest.h>

#include <limits>

#include "viewer/server/bridge.h"
#include "viewer/server/bridge_connection.h"

namespace tactum::bridge_test {
namespace {

/// Keeps what a speaker says.
class KeptLine final : public BridgeLine {
 public:
  void owe(std::string message, bool) override { owed.push_back(std::move(message)); }
  void offer(std::string message, bool) override { offered.push_back(std::move(message)); }
  std::vector<std::string> owed, offered;
};

BridgeTopics topics_of_nothing() {
  const World world;
  return {world, FrameTrace(world, 1e-3, true, 0).columns(), 1};
}

std::string command(const char* q, const char* frame = "world") {
  return std::string(R"({"op":"publish","topic":"/tactum/hand/command","msg":{"header":{"frame_id":")") +
         frame + R"("},"pose":{"position":{"x":0.5,"y":0,"z":-1},"orientation":)" + q + "}}}";
}

TEST(Bridge, IsAskedForByNameAndPort) {
  EXPECT_EQ(parse_bridge("rosbridge")->port, 9090);
  EXPECT_EQ(parse_bridge("foxglove")->port, 8765);
  EXPECT_EQ(parse_bridge("foxglove:0")->port, 0);
  for (const char* wrong :
       {"", "ros", "rosbridge:", "rosbridge:x", "foxglove:65536", "foxglove:-1", "foxglove:80 "})
    EXPECT_FALSE(parse_bridge(wrong)) << wrong;
}

TEST(Bridge, ForeignPagesAreKeptOut) {
  for (const char* own :
       {"", "http://localhost", "http://127.0.0.1:8080", "https://app.foxglove.dev", "file://"})
    EXPECT_TRUE(bridge_origin(own)) << own;
  for (const char* foreign :
       {"null", "https://example.org", "http://localhost.example.org", "http://127.0.0.1.x",
        "http://localhost:80.org", "https://app.foxglove.dev.org"})
    EXPECT_FALSE(bridge_origin(foreign)) << foreign;
}

TEST(Bridge, WhatIsNotFiniteIsNotTold) {
  const BridgeTopics topics = topics_of_nothing();
  const World world;
  BridgeFrame frame{7, 7'000'000, std::vector<double>(FrameTrace(world, 1e-3, true, 0).width(), 0.1)};
  const BridgeTopic& pose = *topics.named(BridgeProtocol::kRosbridge, "/tactum/hand/pose");
  EXPECT_EQ(topics.message(BridgeProtocol::kRosbridge, pose, frame),
            R"({"header":{"seq":7,"stamp":{"secs":0,"nsecs":7000000},"frame_id":"world"},"pose":{"position":)"
            R"({"x":0.1,"y":0.1,"z":0.1},"orientation":{"x":0.1,"y":0.1,"z":0.1,"w":0.1}}})");
  frame.row[pose.column + 5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(topics.message(BridgeProtocol::kRosbridge, pose, frame), "");
  EXPECT_EQ(topics.named(BridgeProtocol::kRosbridge, "/scene"), nullptr);
}

TEST(Bridge, OnlyPosesInTheWorldLeadTheHand) {
  const BridgeTopics topics = topics_of_nothing();
  KeptLine line;
  RequestInbox inbox;
  const auto speaker = speak_rosbridge(topics, line, &inbox);
  Request request;
  EXPECT_FALSE(speaker->received(command(R"({"w":1,"x":0,"y":0})"), true));
  EXPECT_FALSE(speaker->received(command(R"({"w":2,"x":0,"y":0,"z":0})"), true));
  EXPECT_FALSE(speaker->received(command(R"({"w":1e999,"x":0,"y":0,"z":0})"), true));
  EXPECT_FALSE(speaker->received(command(R"({"w":1,"x":0,"y":0,"z":0})", "tool"), true));
  EXPECT_EQ(line.owed.size(), 4u);
  EXPECT_FALSE(inbox.take(request));
  speaker->closed();
  EXPECT_FALSE(inbox.take(request)) << "who never led lets nothing rest";

  EXPECT_TRUE(speaker->received(command(R"({"w":0,"x":1,"y":0,"z":0})"), true));
  ASSERT_TRUE(inbox.take(request));
  EXPECT_EQ(request.what, Request::What::kAim);
  EXPECT_EQ(request.p, (std::array<double, 3>{0.5, 0.0, -1.0}));
  EXPECT_EQ(request.q, (std::array<double, 4>{0.0, 1.0, 0.0, 0.0}));
  speaker->closed();
  ASSERT_TRUE(inbox.take(request));
  EXPECT_EQ(request.what, Request::What::kRest);
}

TEST(Bridge, FoxgloveSubscribesToChannelsThatThereAre) {
  const BridgeTopics topics = topics_of_nothing();
  KeptLine line;
  const auto speaker = speak_foxglove(topics, line);
  speaker->opened();
  ASSERT_EQ(line.owed.size(), 2u);
  EXPECT_TRUE(speaker->received(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})", true));
  for (const char* wrong :
       {"", "[]", "{}", R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":[3]})",
        R"({"op":"subscribe","subscriptions":[{"id":6,"channelId":99}]})",
        R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":2}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":2}]})",
        R"({"op":"unsubscribe","subscriptionIds":[6]})", R"({"op":7})"})
    EXPECT_FALSE(speaker->received(wrong, true)) << wrong;
  const World world;
  const BridgeFrame frame{1, 258, std::vector<double>(FrameTrace(world, 1e-3, true, 0).width(), 0.0)};
  BridgeMoment moment(topics, frame);
  speaker->show(moment);
  ASSERT_EQ(line.offered.size(), 1u);
  EXPECT_EQ(line.offered[0].substr(0, 14), std::string("\1\5\0\0\0\2\1\0\0\0\0\0\0{", 14));
  EXPECT_TRUE(speaker->received(R"({"op":"unsubscribe","subscriptionIds":[5]})", true));
  speaker->show(moment);
  EXPECT_EQ(line.offered.size(), 1u);
}

TEST(Bridge, APortThatIsInUseIsASentence) {
  const BridgeTopics topics = topics_of_nothing();
  const auto first = Bridge::start({{BridgeProtocol::kRosbridge, 0}}, topics, false);
  ASSERT_TRUE(first);
  const auto second = Bridge::start({{BridgeProtocol::kFoxglove, (*first)->ports()[0]}}, topics, false);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message().find("the bridge of foxglove cannot listen"), std::string::npos);
}

}  // namespace
}  // namespace tactum::bridge_test
