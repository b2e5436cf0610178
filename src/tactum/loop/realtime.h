#pragma once
/// The privileges that the operating system grants a thread that must wake on time. Nothing here is required:
/// a loop without privileges runs, later and less evenly, and reports so.

#include <string>
#include <vector>

namespace tactum::inline v0_1 {

struct LoopPrivileges {
  bool realtime = false;               ///< scheduled before ordinary threads (SCHED_FIFO)
  bool memory_locked = false;          ///< no page fault waits for a disk
  bool wake_up_tolerance = false;      ///< the kernel does not gather our wake-ups with others
  std::vector<std::string> sentences;  ///< granted privileges, and the remedy for each that was refused
};

/// The privileges to request.
struct RealtimeSettings {
  bool realtime = true;
  int priority = 70;  ///< of SCHED_FIFO, 1 to 99; above user work, below the kernel's own interrupt threads
  bool lock_memory = true;
};

/// Requests them for the calling thread, touches its stack so that no frame does it first, and returns what
/// was granted. The memory lock is the process's and stays.
LoopPrivileges acquire_privileges(const RealtimeSettings& settings);

}  // namespace tactum::inline v0_1
