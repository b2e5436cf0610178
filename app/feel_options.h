#pragma once
/// The options of tactum feel.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "bridge_run.h"

namespace tactum {

struct FeelOptions {
  std::vector<std::string> scenes{"gears"};  // one, or one or two meshes
  std::string save_scene;
  std::string tool;  // of a URDF or MJCF file
  bool strict = false;
  double duration_s = 0.0;
  std::uint64_t updates = 0;
  int replays = 1;
  std::vector<std::string> devices;  // of the first hand, of the second ...; missing ones are the scene's
  std::string hand;
  std::string response;
  std::string settings;
  std::string json;
  std::string trace;
  std::string record;
  bool trace_bodies = false;
  bool virtual_clock = false;
  bool referee = false;
  bool view = false;
  BridgeOptions bridge;
  int port = 0;
  double wait_s = 0.0;
};

/// The options that say what is felt, and how long.
void add_what_is_felt(CLI::App* command, FeelOptions* options);
/// --record and --trace, with what belongs to them.
CLI::Option* add_record(CLI::App* command, FeelOptions* options);
CLI::Option* add_trace(CLI::App* command, FeelOptions* options);
/// --bridge, with what belongs to it.
CLI::Option* add_bridge(CLI::App* command, FeelOptions* options);
/// The options of the page; returns that of waiting for it.
CLI::Option* add_page(CLI::App* command, FeelOptions* options, CLI::Option* view);

}  // namespace tactum
