#include "viewer/server/server.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "viewer/raw_page.h"

namespace tactum {
namespace {

using testing::ask;
using testing::RawPage;
using testing::status_of;
using testing::word_at;
using Json = nlohmann::json;

/// Waits for the effect of another thread, by events and not by a clock that is judged.
bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

class ServerThread : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<std::unique_ptr<Server>> started = Server::start(0);
    ASSERT_TRUE(started) << started.error().message();
    server = std::move(*started);
    host = "127.0.0.1:" + std::to_string(server->port());
  }
  std::uint64_t refused(Refusal reason) const {
    return server->status().refused[static_cast<std::size_t>(reason)];
  }
  std::string get(const std::string& path, const std::string& headers, const std::string& as_host = "") {
    return ask(server->port(), "GET " + path + " HTTP/1.1\r\nHost: " + (as_host.empty() ? host : as_host) +
                                   "\r\n" + headers + "Connection: close\r\n\r\n");
  }
  std::string own_path(const std::string& file = "") { return "/" + server->token() + "/" + file; }
  std::unique_ptr<RawPage> open_page() {
    return std::make_unique<RawPage>(server->port(), server->token(), "http://" + host);
  }
  std::unique_ptr<Server> server;
  std::string host;
};

TEST_F(ServerThread, ServesThePageUnderAStrictPolicyToWhoKnowsTheToken) {
  const std::string answer = get(own_path(), "");
  EXPECT_EQ(status_of(answer), 200);
  EXPECT_NE(answer.find("Content-Encoding: gzip"), std::string::npos);
  EXPECT_NE(answer.find("X-Content-Type-Options: nosniff"), std::string::npos);
  EXPECT_NE(answer.find("Referrer-Policy: no-referrer"), std::string::npos);
  const std::size_t at = answer.find("Content-Security-Policy: default-src 'none'");
  ASSERT_NE(at, std::string::npos);
  const std::string policy = answer.substr(at, answer.find("\r\n", at) - at);
  EXPECT_EQ(policy.find("unsafe"), std::string::npos) << policy;
  EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos) << policy;
}

TEST_F(ServerThread, RefusesAndCountsWhatIsNotForIt) {
  EXPECT_EQ(status_of(get("/", "")), 403);
  EXPECT_EQ(status_of(get("/" + std::string(32, '0') + "/", "")), 403);
  EXPECT_EQ(status_of(get("/" + server->token(), "")), 403);  // without the slash behind it
  EXPECT_EQ(refused(Refusal::kWrongToken), 3u);
  EXPECT_EQ(status_of(get(own_path(), "", "tactum.example:80")), 403);
  EXPECT_EQ(status_of(get(own_path(), "", "127.0.0.1:1")), 403);
  EXPECT_EQ(refused(Refusal::kForeignHost), 2u);
  EXPECT_EQ(status_of(get(own_path(), "Origin: http://tactum.example\r\n")), 403);
  EXPECT_EQ(status_of(get(own_path(), "Sec-Fetch-Site: cross-site\r\n")), 403);
  EXPECT_EQ(refused(Refusal::kForeignOrigin), 2u);
  EXPECT_EQ(status_of(get(own_path("../etc/passwd"), "")), 404);
  EXPECT_EQ(refused(Refusal::kNotThere), 1u);
  EXPECT_EQ(status_of(get(own_path(), "X-Long: " + std::string(20000, 'x') + "\r\n")), 413);
  EXPECT_EQ(refused(Refusal::kOversized), 1u);
  EXPECT_EQ(status_of(ask(server->port(), "POST " + own_path() + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n")),
            405);
  EXPECT_EQ(status_of(ask(server->port(), "\x16\x03\x01 no HTTP at all\r\n\r\n")), 400);
  EXPECT_EQ(refused(Refusal::kMalformed), 2u);
}

TEST_F(ServerThread, AForeignOriginOrNoneOpensNoWebSocket) {
  RawPage foreign(server->port(), server->token(), "http://tactum.example");
  EXPECT_EQ(status_of(foreign.answer), 403);
  RawPage other_port(server->port(), server->token(), "http://127.0.0.1:1");
  EXPECT_EQ(status_of(other_port.answer), 403);
  RawPage wrong(server->port(), std::string(32, 'a'), "http://" + host);
  EXPECT_EQ(status_of(wrong.answer), 403);
  EXPECT_EQ(refused(Refusal::kForeignOrigin), 2u);
  EXPECT_EQ(refused(Refusal::kWrongToken), 1u);
  EXPECT_TRUE(open_page()->accepted());
}

TEST_F(ServerThread, OversizedEndsThePageAndMalformedIsCounted) {
  auto page = open_page();
  ASSERT_TRUE(page->accepted());
  for (const char* text : {"", "[]", "{}", "{\"do\":\"fly\"}", "{\"do\":\"ack\"}",
                           "{\"do\":\"ack\",\"seq\":-1}", "{\"do\":\"stop\",\"now\":1}",
                           "{\"do\":\"aim\",\"hand\":0,\"p\":[0,0,1e9],\"q\":[1,0,0,0],\"buttons\":0}"})
    page->say(text);
  page->say("\x01\x02", 2);
  EXPECT_TRUE(comes_true([&] { return refused(Refusal::kMalformed) == 9; })) << refused(Refusal::kMalformed);
  page->say("{\"do\":\"stop\"}");  // it still listens
  Request request;
  EXPECT_TRUE(comes_true([&] { return server->take(request); }));
  EXPECT_EQ(request.what, Request::What::kStop);
  page->say(std::string(Server::kLargestMessage + 1, ' '));
  EXPECT_TRUE(comes_true([&] { return refused(Refusal::kOversized) == 1 && server->status().pages == 0; }));
}

TEST_F(ServerThread, WhoSaysTooMuchIsCutOff) {
  auto page = open_page();
  for (int i = 0; i < 3000; ++i) page->say("{\"do\":\"steer\"}");
  EXPECT_TRUE(comes_true([&] { return refused(Refusal::kTooFast) >= 1 && server->status().pages == 0; }));
  auto nonsense = open_page();
  for (int i = 0; i < 30; ++i) nonsense->say("?");
  EXPECT_TRUE(comes_true([&] { return refused(Refusal::kMalformed) > 20 && server->status().pages == 0; }));
}

TEST_F(ServerThread, OneSteersAndAnyoneStops) {
  auto first = open_page();
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 1; }));
  auto second = open_page();
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 2; }));
  Request request;
  second->say("{\"do\":\"reset\"}");
  EXPECT_TRUE(comes_true([&] { return refused(Refusal::kNotSteering) == 1; }));
  second->say("{\"do\":\"stop\"}");
  ASSERT_TRUE(comes_true([&] { return server->take(request); }));
  EXPECT_EQ(request.what, Request::What::kStop);
  second->say("{\"do\":\"steer\"}");  // takes over: the first hand is released
  ASSERT_TRUE(comes_true([&] { return server->take(request); }));
  EXPECT_EQ(request.what, Request::What::kRest);
  second->say("{\"do\":\"reset\"}");
  ASSERT_TRUE(comes_true([&] { return server->take(request); }));
  EXPECT_EQ(request.what, Request::What::kReset);
  second.reset();  // gone: no page leads the hand
  ASSERT_TRUE(comes_true([&] { return server->take(request); }));
  EXPECT_EQ(request.what, Request::What::kRest);
}

/// A request to lead the hand.
std::string aim_of(int hand) {
  return "{\"do\":\"aim\",\"hand\":" + std::to_string(hand) + ",\"p\":[0,0,0],\"q\":[1,0,0,0],\"buttons\":0}";
}

TEST_F(ServerThread, HandsAfterTheFirstAreLedByThePageThatTakesThem) {
  auto first = open_page();
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 1; }));
  auto second = open_page();
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 2; }));
  Request request;
  const auto passes = [&](RawPage& page, int hand) {
    page.say(aim_of(hand));
    return comes_true([&] { return server->take(request); }) && request.what == Request::What::kAim &&
           request.hand == static_cast<std::uint32_t>(hand);
  };
  EXPECT_TRUE(passes(*first, 0));
  EXPECT_TRUE(passes(*second, 1));  // two pages, two hands
  EXPECT_TRUE(passes(*second, 2));
  EXPECT_TRUE(passes(*second, 1));
  second->say(aim_of(0));  // the first hand is that of the page that steers
  EXPECT_TRUE(comes_true([&] { return refused(Refusal::kNotSteering) == 1; }));
  first->say(aim_of(1));  // even that page takes no hand from another
  EXPECT_TRUE(comes_true([&] { return refused(Refusal::kNotSteering) == 2; }));
  second->say("{\"do\":\"leave\",\"hand\":1}");
  EXPECT_TRUE(comes_true([&] {
    first->say(aim_of(1));
    return server->take(request);
  }));
  EXPECT_EQ(request.what, Request::What::kAim);
  while (server->take(request)) continue;
  second.reset();  // its page is gone: the hand rests, and is free again
  ASSERT_TRUE(comes_true([&] { return server->take(request) && request.what == Request::What::kRest; }));
  EXPECT_EQ(request.hand, 2u);
  EXPECT_TRUE(passes(*first, 2));
}

ChartSample sample_of(std::uint64_t index) {
  ChartSample sample;
  sample.frame.index = index;
  sample.frame.values[0] = static_cast<float>(index);
  return sample;
}

/// Reads frames until sample `last` has come; acknowledges them only if wanted. The indices, in order.
std::vector<std::uint32_t> samples_until(RawPage& page, std::uint32_t last, bool acknowledges, int wait_ms,
                                         std::string* newest_picture = nullptr) {
  std::vector<std::uint32_t> indices;
  while (indices.empty() || indices.back() != last) {
    const RawPage::Message message = page.next(wait_ms);
    if (message.kind == 0 || message.kind == 8) break;
    if (message.kind != 2) continue;
    const std::uint32_t rows = word_at(message.payload, 3), numbers = word_at(message.payload, 4);
    const std::size_t picture = word_at(message.payload, 6);
    if (newest_picture && picture > 0) *newest_picture = message.payload.substr(32, picture);
    for (std::uint32_t row = 0; row < rows; ++row)
      indices.push_back(word_at(message.payload, 8 + picture / 4 + row * (numbers + 1)));
    if (acknowledges)
      page.say("{\"do\":\"ack\",\"seq\":" + std::to_string(word_at(message.payload, 1)) + "}");
  }
  return indices;
}

/// The owner may be busy for seconds, as while it builds a scene.
TEST_F(ServerThread, AStopIsKnownBeforeTheOwnerTakesIt) {
  auto page = open_page();
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 1; }));
  EXPECT_FALSE(server->stop_asked());
  page->say("{\"do\":\"stop\"}");
  ASSERT_TRUE(comes_true([&] { return server->stop_asked().load(); }));
  Request request;
  ASSERT_TRUE(server->take(request));
  EXPECT_TRUE(server->stop_asked());
  page->say("{\"do\":\"resume\"}");
  ASSERT_TRUE(comes_true([&] { return server->take(request); }));
  EXPECT_FALSE(server->stop_asked());
  // A stop behind a request to resume holds, though the owner takes the other first.
  page->say("{\"do\":\"resume\"}");
  page->say("{\"do\":\"stop\"}");
  ASSERT_TRUE(comes_true([&] { return server->stop_asked().load(); }));
  ASSERT_TRUE(server->take(request));
  EXPECT_EQ(request.what, Request::What::kResume);
  EXPECT_TRUE(server->stop_asked());
}

TEST_F(ServerThread, ASlowPageGetsTheNewestPictureAndEverySample) {
  server->begin_run(1, "{\"type\":\"run\"}", "geometry");
  auto page = open_page();
  ASSERT_TRUE(page->accepted());
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 1; }));
  EXPECT_EQ(page->next(3000).payload, "{\"type\":\"run\"}");
  for (std::uint64_t i = 0; i < 3000; i += 10) {
    std::vector<ChartSample> samples;
    for (std::uint64_t k = 0; k < 10; ++k) samples.push_back(sample_of(i + k));
    std::string picture(8, 'p');
    std::memcpy(picture.data(), &i, sizeof i);
    server->show(samples, picture, i);
  }
  // Two messages are on their way and no more, however long the page waits.
  EXPECT_TRUE(comes_true([&] { return server->status().frames_sent == 2; }));
  std::string picture;
  std::vector<std::uint32_t> seen = samples_until(*page, 2999, true, 2000, &picture);
  EXPECT_LE(server->status().frames_sent, 5u);
  ASSERT_EQ(seen.size(), 3000u);
  for (std::uint32_t i = 0; i < 3000; ++i) ASSERT_EQ(seen[i], i);
  EXPECT_EQ(word_at(picture, 0), 2990u);  // none of the old ones
  EXPECT_EQ(server->status().samples_lost, 0u);
}

TEST_F(ServerThread, BeyondTheBoundSamplesAreLostAndCounted) {
  server->begin_run(1, "{}", "");
  auto page = open_page();
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 1; }));
  const std::uint64_t count = History::kRoom + 5000;
  std::vector<ChartSample> one{sample_of(0)};
  server->show(one, "", 0);
  EXPECT_TRUE(comes_true([&] { return server->status().frames_sent == 1; }));
  for (std::uint64_t i = 1; i < count; i += 1000) {
    std::vector<ChartSample> samples;
    for (std::uint64_t k = i; k < std::min(i + 1000, count); ++k) samples.push_back(sample_of(k));
    server->show(samples, "", 0);
  }
  const std::vector<std::uint32_t> seen =
      samples_until(*page, static_cast<std::uint32_t>(count - 1), true, 2000);
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back(), count - 1);
  EXPECT_GT(server->status().samples_lost, 0u);
  EXPECT_EQ(seen.size() + server->status().samples_lost, count);
}

/// A picture whose sample the page is too late for would be shown beside the numbers of another frame: the
/// samples of a long pause push it out of the history, and a page that comes anew is not given it.
TEST_F(ServerThread, NoPictureComesWithoutTheSampleOfItsFrame) {
  server->begin_run(1, "{}", "");
  auto page = open_page();
  ASSERT_TRUE(comes_true([&] { return server->status().pages == 1; }));
  std::uint64_t next = 0;
  const auto show = [&](std::uint64_t count, std::uint64_t pictured) {
    std::vector<ChartSample> samples;
    while (samples.size() < count) samples.push_back(sample_of(next++));
    std::string picture(8, 'p');
    std::memcpy(picture.data(), &pictured, sizeof pictured);
    server->show(samples, picture, pictured);
    std::string got;
    samples_until(*page, static_cast<std::uint32_t>(next - 1), true, 2000, &got);
    return got.empty() ? std::uint32_t{0} : word_at(got, 0);
  };
  EXPECT_EQ(show(10, 9), 9u);
  EXPECT_EQ(show(History::kRoom + 100, 20), 0u) << "pushed out by what came with it";
  const std::uint64_t whole = next + 9;
  EXPECT_EQ(show(10, whole), whole);
  const std::uint64_t old = next;
  EXPECT_EQ(show(History::kForNewcomers + 10, old), old);
  auto newcomer = open_page();
  std::string got;
  EXPECT_EQ(samples_until(*newcomer, static_cast<std::uint32_t>(next - 1), true, 2000, &got).size(),
            History::kForNewcomers);
  EXPECT_EQ(got, "") << "of a sample from before it came";
}

TEST_F(ServerThread, ManyPagesButNotTooMany) {
  std::vector<std::unique_ptr<RawPage>> pages;
  for (int i = 0; i < Server::kMostPages; ++i) {
    pages.push_back(open_page());
    ASSERT_TRUE(pages.back()->accepted()) << i;
    ASSERT_TRUE(comes_true([&] { return server->status().pages == i + 1; }));
  }
  EXPECT_EQ(status_of(open_page()->answer), 503);
  EXPECT_EQ(refused(Refusal::kTooMany), 1u);
}

TEST_F(ServerThread, StatusTellsThePageWhatItIsAndWhatWasRefused) {
  server->begin_run(1, "{\"type\":\"run\"}", "");
  auto page = open_page();
  page->say("nonsense");
  ASSERT_TRUE(comes_true([&] { return refused(Refusal::kMalformed) == 1; }));
  server->send_status("{\"stopped\":false}");
  Json status;
  while (!status.contains("refused") || status["refused"]["malformed"] != 1) {
    const RawPage::Message message = page->next(3000);
    ASSERT_NE(message.kind, 0);
    const Json json = Json::parse(message.payload, nullptr, false);
    if (json.is_object() && json.value("type", "") == "status") status = json;
    server->send_status("{\"stopped\":false}");
  }
  EXPECT_EQ(status["steering"], true);
  EXPECT_EQ(status["pages"], 1);
}

TEST(Server, APortThatIsTakenIsToldWithACure) {
  Result<std::unique_ptr<Server>> first = Server::start(0);
  ASSERT_TRUE(first);
  const Result<std::unique_ptr<Server>> second = Server::start((*first)->port());
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message().find("without --port"), std::string::npos) << second.error().message();
}

TEST(Access, OnlyThisMachinesOwnNamesPass) {
  EXPECT_TRUE(own_host("127.0.0.1:8000", 8000));
  EXPECT_TRUE(own_host("localhost:8000", 8000));
  for (const char* host : {"", "localhost", "127.0.0.1", "127.0.0.1:80000", "localhost:8000.example",
                           "example:8000", "[::1]:8000"})
    EXPECT_FALSE(own_host(host, 8000)) << host;
  EXPECT_TRUE(own_origin("http://localhost:8000", 8000));
  for (const char* origin :
       {"", "null", "https://localhost:8000", "http://localhost:8001", "localhost:8000", "file://"})
    EXPECT_FALSE(own_origin(origin, 8000)) << origin;
}

TEST(Access, TokensAreLongAndDiffer) {
  const std::string a = new_token(), b = new_token();
  EXPECT_EQ(a.size(), 32u);
  EXPECT_NE(a, b);
  EXPECT_TRUE(same_secret(a, a));
  EXPECT_FALSE(same_secret(a, b));
  EXPECT_FALSE(same_secret(a, a.substr(1)));
}

TEST(Access, ARateLimitPassesABurstAndThenTheRate) {
  RateLimit limit(10.0, 5.0);
  const RateLimit::Clock::time_point start(std::chrono::seconds(1));
  int passed = 0;
  for (int i = 0; i < 100; ++i) passed += limit.pass(start) ? 1 : 0;
  EXPECT_EQ(passed, 5);
  for (int i = 1; i <= 100; ++i) passed += limit.pass(start + std::chrono::milliseconds(10 * i)) ? 1 : 0;
  EXPECT_NEAR(passed, 15, 1);  // one second later: ten more, but for rounding
}

TEST(Request, EveryFormIsReadAndNothingElse) {
  const Result<Request> aim =
      parse_request("{\"do\":\"aim\",\"hand\":0,\"p\":[1,2,3],\"q\":[1,0,0,0],\"buttons\":1}");
  ASSERT_TRUE(aim);
  EXPECT_EQ(aim->what, Request::What::kAim);
  EXPECT_EQ(aim->p[2], 3.0);
  EXPECT_TRUE(aim->steers());
  const Result<Request> set =
      parse_request("{\"do\":\"set\",\"key\":\"coupling.stiffness_N_per_m\",\"value\":700}");
  ASSERT_TRUE(set);
  EXPECT_EQ(set->key, "coupling.stiffness_N_per_m");
  EXPECT_EQ(set->value, 700.0);
  EXPECT_FALSE(parse_request("{\"do\":\"stop\"}")->steers());
  for (const char* text :
       {"", "null", "7", "{\"do\":7}", "{\"do\":\"set\",\"key\":\"a\"}",
        "{\"do\":\"set\",\"key\":\"a\",\"value\":\"7\"}", "{\"do\":\"set\",\"key\":\"a\",\"value\":1e999}",
        "{\"do\":\"aim\",\"hand\":0,\"p\":[1,2],\"q\":[1,0,0,0],\"buttons\":1}",
        "{\"do\":\"aim\",\"hand\":0,\"p\":[1,2,3],\"q\":[0,0,0,0],\"buttons\":1}",
        "{\"do\":\"aim\",\"hand\":0,\"p\":[1,2,3],\"q\":[1,0,0,0],\"buttons\":-1}",
        "{\"do\":\"aim\",\"hand\":0,\"p\":[1,2,null],\"q\":[1,0,0,0],\"buttons\":1}",
        "{\"do\":\"aim\",\"p\":[1,2,3],\"q\":[1,0,0,0],\"buttons\":1}", "{\"do\":\"leave\",\"hand\":1000}",
        "{\"do\":\"scene\",\"name\":\"gears\",\"p q\":1}"})
    EXPECT_FALSE(parse_request(text)) << text;
  EXPECT_FALSE(parse_request("{\"do\":\"scene\",\"name\":\"" + std::string(300, 'x') + "\"}"));
}

}  // namespace
}  // namespace tactum
