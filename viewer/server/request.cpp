#include "viewer/server/request.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace tactum {
namespace {

using Json = nlohmann::json;
using What = Request::What;

constexpr double kFarthest_m = 1000.0;
constexpr std::size_t kLongestName = 200;
constexpr std::uint32_t kMostHands = 16;

/// The keys of each request beside `do`, separated by blanks.
struct Form {
  const char* name;
  What what;
  const char* keys;
};
constexpr Form kForms[] = {
    {"ack", What::kAck, "seq"},        {"steer", What::kSteer, ""},
    {"release", What::kRelease, ""},   {"stop", What::kStop, ""},
    {"resume", What::kResume, ""},     {"aim", What::kAim, "hand p q buttons"},
    {"rest", What::kRest, "hand"},     {"leave", What::kLeave, "hand"},
    {"set", What::kSet, "key value"},  {"unset", What::kUnset, "key"},
    {"reset", What::kReset, ""},       {"scene", What::kScene, "name"},
    {"device", What::kDevice, "name"}, {"grip", What::kGrip, "name"},
    {"record", What::kRecord, ""},     {"end", What::kEnd, ""},
    {"seek", What::kSeek, "frame"},    {"play", What::kPlay, "value"},
};

Error malformed(const std::string& what, const std::string& where = "") { return {what, "", "", where}; }

template <std::size_t N>
bool read(const Json& json, double limit, std::array<double, N>& out) {
  if (!json.is_array() || json.size() != N) return false;
  for (std::size_t i = 0; i < N; ++i) {
    if (!json[i].is_number()) return false;
    out[i] = json[i].get<double>();
    if (!(std::abs(out[i]) <= limit)) return false;
  }
  return true;
}

bool read(const Json& json, std::uint32_t& out) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > 0xffffffffu) return false;
  out = json.get<std::uint32_t>();
  return true;
}

bool read(const Json& json, std::string& out) {
  if (!json.is_string() || json.get_ref<const std::string&>().size() > kLongestName) return false;
  out = json.get<std::string>();
  return true;
}

bool read(const Json& json, double& out) {
  if (!json.is_number()) return false;
  out = json.get<double>();
  return std::isfinite(out);
}

/// Null: no limit.
bool read_value(const Json& json, double& out) {
  if (!json.is_null()) return read(json, out);
  out = std::numeric_limits<double>::infinity();
  return true;
}

bool read_key(const std::string& key, const Json& value, Request& request) {
  if (key == "seq") return read(value, request.sequence);
  if (key == "buttons") return read(value, request.buttons);
  if (key == "hand") return read(value, request.hand) && request.hand < kMostHands;
  if (key == "frame") return read(value, request.frame);
  if (key == "key") return read(value, request.key);
  if (key == "name") return read(value, request.name);
  if (key == "value") return read_value(value, request.value);
  if (key == "p") return read(value, kFarthest_m, request.p);
  if (key != "q" || !read(value, 1.1, request.q)) return false;
  double squared = 0.0;
  for (double component : request.q) squared += component * component;
  return std::abs(squared - 1.0) < 0.1;  // near enough to a rotation to be meant as one
}

bool is_listed(std::string_view keys, const std::string& key) {
  const std::string list = " " + std::string(keys) + " ";
  return key.find(' ') == std::string::npos && list.find(" " + key + " ") != std::string::npos;
}

std::size_t count_of(std::string_view keys) {
  std::size_t count = keys.empty() ? 0 : 1;
  for (char letter : keys) count += letter == ' ' ? 1 : 0;
  return count;
}

}  // namespace

Result<Request> parse_request(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return malformed("not a JSON object");
  const auto named = json.find("do");
  if (named == json.end() || !named->is_string()) return malformed("no \"do\"");
  for (const Form& form : kForms) {
    if (*named != form.name) continue;
    Request request;
    request.what = form.what;
    for (const auto& [key, value] : json.items()) {
      if (key == "do") continue;
      if (!is_listed(form.keys, key)) return malformed("unknown key", key);
      if (!read_key(key, value, request)) return malformed("wrong value", key);
    }
    if (json.size() != 1 + count_of(form.keys)) return malformed("a key is missing", form.name);
    return request;
  }
  return malformed("unknown request");
}

}  // namespace tactum
