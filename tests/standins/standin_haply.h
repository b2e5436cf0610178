#pragma once
/// A stand-in for Haply's Inverse Service 3.5, with one Inverse3 and a VerseGrip: a server on a port of its
/// own, whose WebSocket is Boost's and no code of ours. To each message it answers with the state of its
/// devices, once; what it does not know it passes over.
///
///   a force is taken as `vector` or as `values`, whichever it understands, and lasts for kHolds_s
///   on its way to the motors: the damper (half, while the force reverses often), the gate (its gain, at the
///   same time), the damping, the scale; `current_cursor_force` is what is left
///   the settings of a session end with it
///   the grip tells its orientation fifty times a second, and the same until the next time
///
/// It serves one connection at a time.

#include <array>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace tactum::standin {

using Triple = std::array<double, 3>;  // x, y, z: right, forward, up

class HaplyService {
 public:
  /// A command that is older than this moves no motor [s].
  static constexpr double kHolds_s = 0.02;

  /// What there is, to be changed while the lock of locked() lives.
  struct World {
    std::string version = "3.5.2";  // of GET /version; empty: that is not found
    bool takes_vector = true, takes_values = true;
    bool takes_settings = true;
    bool begins = true;  // sends the list of devices at once
    std::string preset = "defaults", basis = "YXZ";
    double gate_gain = 0.7, damping = 2.0, scale = 1.0;
    bool connected = true, calibrated = true, ready = true, powered = true;
    Triple position{}, velocity{};
    bool has_grip = false;
    std::array<double, 4> turn_wxyz{1, 0, 0, 0};  // of the grip, which tells it every grip_every_s
    double turning_rad_per_s = 0.0;               // it turns by itself, about z
    double grip_every_s = 0.02;
    int grip_readings = 0;  // that it has told
    std::array<bool, 3> buttons{};
    bool counts_buttons = false;  // names them button_0 and so on
    std::string nonsense{};       // answers this instead
    bool silent = false;          // answers nothing
    // What happened.
    std::vector<Triple> commands;  // forces that were understood
    int messages = 0;              // of this session
    int of_damper = 0;             // commands that it cut
    std::string profile{};
    std::vector<std::string> broken_rules;
  };

  HaplyService();
  ~HaplyService();
  HaplyService(const HaplyService&) = delete;
  HaplyService& operator=(const HaplyService&) = delete;

  int port() const noexcept { return port_; }
  std::string place() const { return "127.0.0.1:" + std::to_string(port_); }
  bool has_session() const noexcept { return session_; }

  struct Locked {
    World& world;
    std::unique_lock<std::mutex> lock;
    World* operator->() { return &world; }
  };
  Locked locked() { return {world_, std::unique_lock<std::mutex>(mutex_)}; }

  /// What the motors exert now: zero, too, when the last command is too old, or there is no session.
  Triple motors();

  /// From now on every message waits for its answer until answer_one(), or until answer_all() ends that.
  void answer_by_hand();
  /// Answers the message that waits, and returns when the next one waits, or the session has ended.
  void answer_one();
  void answer_all();

 private:
  struct Server;
  void serve();
  std::string answer_to(const std::string& message);
  std::string state_text(bool with_config) const;
  void take_force(const Triple& F);
  bool wait_to_answer();
  void read_grip();

  World world_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Triple motors_{};
  std::vector<Triple> lately_;  // for the damper
  double commanded_s_ = -1.0;
  std::array<double, 4> read_turn_{1, 0, 0, 0};
  double read_s_ = -1.0;
  int port_ = 0;
  bool by_hand_ = false, waits_ = false, may_answer_ = false;
  std::atomic<bool> session_{false}, ends_{false};
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

}  // namespace tactum::standin
