// tactum devices, and tactum feel on a device, as programs; the makers' libraries are stand-ins.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "program.h"
#include "support/standin_files.h"

namespace tactum::devices_test {

using testing::ended;
using testing::ProgramRun;
using testing::run_tactum;

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// No maker's library and no daemon, whatever the machine has.
struct NothingThere {
  SetVariable dhd{"TACTUM_FORCE_DIMENSION_LIBRARY", "/nowhere/libdhd.so"};
  SetVariable hd{"TACTUM_OPENHAPTICS_LIBRARY", "/nowhere/libHD.so"};
  SetVariable spacenav{"SPNAV_SOCKET", "/nowhere/spnav.sock"};
  SetVariable haply{"TACTUM_HAPLY_SERVICE", "127.0.0.1:1"};
};

TEST(Devices, OfADriverThatFindsNothingItIsSaidWhyAndWhatHelps) {
  const NothingThere nothing;
  const ProgramRun run = run_tactum("devices");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* words :
       {"force-dimension", "install the Force Dimension SDK", "3d-systems", "install OpenHaptics", "haply",
        "systemctl start haply-inverse-service", "spacemouse", "apt install spacenavd", "simulated:touch"})
    EXPECT_TRUE(holds(run.out, words)) << words << "\n" << run.out;
}

TEST(Devices, AConnectedOneIsListedWithSerialAndLimits) {
  const NothingThere nothing;
  const SetVariable dhd("TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd"));
  const ProgramRun run = run_tactum("devices");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* words :
       {"force-dimension:10042", "sigma.7, serial 10042", "12 N, 0.2 N m", "senses rotation"})
    EXPECT_TRUE(holds(run.out, words)) << words << "\n" << run.out;
}

TEST(Devices, TheRulesForUdevArePrinted) {
  const ProgramRun run = run_tactum("devices --print-udev");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(holds(run.out, "/etc/udev/rules.d/71-")) << run.out;
  EXPECT_TRUE(holds(run.out, "ATTR{idVendor}==\"1451\", MODE=\"0660\""));
  EXPECT_FALSE(holds(run.out, "0666")) << "nobody else may open them";
}

TEST(Devices, AFirstTouchIsRehearsedAndItsProfileWritten) {
  const testing::ScratchFolder folder;
  const std::string profile = folder / "profile.toml";
  const ProgramRun run = run_tactum("devices --try omega.6 --yes --profile '" + profile + "'");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  for (const char* words : {"A rehearsal", "axes: x is toward you",
                            "a force up (+z) moved the handle up (+z)", "damping 0.", "stable in any hand"})
    EXPECT_TRUE(holds(run.out, words)) << words << "\n" << run.out;
  EXPECT_TRUE(holds(testing::content(profile), "device = \"simulated omega.6\""))
      << testing::content(profile);
}

TEST(Devices, AFirstTouchNeedsAPersonOrAWord) {
  const ProgramRun run = run_tactum("devices --try omega.6 </dev/null");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(holds(run.err, "--yes")) << run.err;
}

/// The stand-in's handle does not move, so nothing but zero may be sent to it.
TEST(Devices, AFirstTouchOfADeviceThatNobodyMovesSendsNoForce) {
  const testing::ScratchFolder folder;
  const SetVariable dhd("TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd"));
  const SetVariable record("TACTUM_STANDIN_RECORD", folder / "record");
  const ProgramRun run = run_tactum("devices --try force-dimension --yes --patience 0.2 --profile '" +
                                    (folder / "p.toml") + "'");
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_TRUE(holds(run.out, "new samples a second")) << run.out;
  EXPECT_TRUE(holds(run.out, "No profile is written")) << run.out;
  std::istringstream lines(testing::content(folder / "record"));
  std::string line, end;
  while (std::getline(lines, line)) {
    std::istringstream numbers(line);
    double x = 0.0, y = 0.0, z = 0.0;
    if (numbers >> x >> y >> z) {
      EXPECT_EQ(std::abs(x) + std::abs(y) + std::abs(z), 0.0);
    } else {
      end = line;
    }
  }
  EXPECT_EQ(end, "forces off at the end, 0 rules broken");
}

TEST(Doctor, EveryFindingStandsInALineAndADeviceThatIsNotThereHasItsCure) {
  const NothingThere nothing;
  const ProgramRun good = run_tactum("doctor --duration 0.1 --device touch");
  for (const char* words : {"real-time scheduling", "memory lock", "cores", "clock", "power saving",
                            "share of real-time threads", "wake-ups", "simulated touch"})
    EXPECT_TRUE(holds(good.out, words)) << words << "\n" << good.out;
  const ProgramRun bad = run_tactum("doctor --duration 0.1 --device force-dimension");
  EXPECT_EQ(bad.exit_code, 2) << bad.err;
  EXPECT_TRUE(holds(bad.out, "wake-ups")) << bad.out;
  EXPECT_TRUE(holds(bad.out, "install the Force Dimension SDK")) << bad.out;
}

TEST(Doctor, MeasuresADevicesLink) {
  const SetVariable dhd("TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd"));
  const ProgramRun run = run_tactum("doctor --duration 0.1 --device force-dimension --json -");
  const auto findings = nlohmann::json::parse(run.out);
  EXPECT_TRUE(holds(findings.back()["found"], "read and write take")) << run.out;
  EXPECT_TRUE(holds(findings.back()["found"], "0 of 1")) << run.out;
}

TEST(Doctor, TheLimitsArePrinted) {
  const ProgramRun run = run_tactum("doctor --print-limits");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(holds(run.out, "/etc/security/limits.d/71-")) << run.out;
  EXPECT_TRUE(holds(run.out, "@plugdev - rtprio 90"));
}

TEST(Devices, GearsAreFeltOnADevice) {
  const testing::ScratchFolder folder;
  const SetVariable dhd("TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd"));
  const SetVariable sweep("TACTUM_STANDIN_SWEEP", "1");
  const SetVariable record("TACTUM_STANDIN_RECORD", folder / "record");
  const ProgramRun run = run_tactum("feel gears --device force-dimension --duration 1");
  EXPECT_TRUE(ended(run)) << run.err;
  EXPECT_TRUE(holds(run.out, "force-dimension sigma.7")) << run.out;
  EXPECT_FALSE(holds(run.out, "hand medium")) << "no simulated hand holds it";
  std::istringstream lines(testing::content(folder / "record"));
  int frames = 0;
  double last_N = -1.0, strongest_N = 0.0, strongest_Nm = 0.0;
  std::string line, end;
  while (std::getline(lines, line)) {
    std::istringstream numbers(line);
    double x = 0.0, y = 0.0, z = 0.0;
    if (!(numbers >> x >> y >> z)) {
      end = line;
      continue;
    }
    double tx = 0.0, ty = 0.0, tz = 0.0;
    numbers >> tx >> ty >> tz;
    strongest_Nm = std::max(strongest_Nm, std::sqrt(tx * tx + ty * ty + tz * tz));
    last_N = std::sqrt(x * x + y * y + z * z);
    strongest_N = std::max(strongest_N, last_N);
    if (frames++ == 0) {
      EXPECT_EQ(last_N, 0.0) << "the first wrench";
    }
  }
  EXPECT_GT(frames, 10);
  EXPECT_GT(strongest_Nm, 0.0);
  EXPECT_LE(strongest_Nm, 0.2000001);
  EXPECT_LE(strongest_N, 12.000001);
  EXPECT_EQ(last_N, 0.0) << "the last wrench";
  EXPECT_EQ(end, "forces off at the end, 0 rules broken");
}

/// A run on a device in another process, and the largest force that the device told when the run had ended.
struct RunOnADevice {
  ProgramRun run;
  std::string said;
  int device_status = -1;
  double largest_N = 0.0;
};
RunOnADevice felt_plate(const std::string& device, int port) {
  RunOnADevice felt;
  std::thread process([&] {
    FILE* output = popen((device + " 30 " + std::to_string(port) + " 2>&1").c_str(), "r");
    char line[256];
    while (std::fgets(line, sizeof line, output) != nullptr) felt.said += line;
    felt.device_status = pclose(output);
  });
  felt.run = run_tactum("feel block-on-plate --duration 4 --device network:" + std::to_string(port));
  process.join();
  std::sscanf(felt.said.c_str(), "largest force %lf N", &felt.largest_N);
  return felt;
}

/// A machine that is busy with something else may refuse a device, or let it hold for want of packets, as it
/// has to: one of five runs is enough.
void expect_a_felt_plate(const std::string& device, const std::string& name) {
  RunOnADevice felt;
  for (int i = 0; i < 5 && !(ended(felt.run) && felt.largest_N > 0.1); ++i)
    felt = felt_plate(device, 20000 + getpid() % 20000 + i);
  EXPECT_TRUE(ended(felt.run)) << felt.run.err;
  EXPECT_TRUE(holds(felt.run.out, name)) << felt.run.out;
  EXPECT_EQ(felt.device_status, 0) << felt.said;
  EXPECT_GT(felt.largest_N, 0.1) << felt.said;
}

/// The example in C, as a process of its own.
TEST(Devices, APlateIsFeltOnADeviceInAnotherProcess) {
  expect_a_felt_plate(testing::built_program("examples/example_network_device"), "network example");
}

/// The example in JavaScript, over WebSocket, where this machine's node has WebSockets.
TEST(Devices, APlateIsFeltOnADeviceInJavaScript) {
  const std::string node = "node --no-warnings --experimental-websocket ";
  if (std::system((node + "-e 'process.exit(globalThis.WebSocket ? 0 : 1)' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "no node with WebSockets";
  expect_a_felt_plate(node + "examples/network_device.mjs", "network example in JavaScript");
}

TEST(Devices, ARealOneHasNoVirtualClock) {
  const SetVariable dhd("TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd"));
  const ProgramRun run = run_tactum("feel gears --device force-dimension --virtual-clock --updates 10");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(holds(run.err, "real time")) << run.err;
}

}  // namespace tactum::devices_test
