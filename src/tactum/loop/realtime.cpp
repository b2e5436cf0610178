#include "tactum/loop/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace tactum::inline v0_1 {
namespace {

constexpr unsigned long kWakeUpTolerance_ns = 1;   // the kernel's default is 50 us
constexpr std::size_t kStackToTouch = 512 * 1024;  // bytes; a walk down the trees of two surfaces uses 200 KB
constexpr std::size_t kPage = 4096;

void touch_stack() noexcept {
  volatile unsigned char block[kStackToTouch];
  for (std::size_t i = 0; i < kStackToTouch; i += kPage) block[i] = 0;
  static_cast<void>(block[0]);
}

void ask_realtime(int priority, LoopPrivileges& got) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
  got.realtime = error == 0;
  got.sentences.push_back(got.realtime
                              ? "real-time scheduling: SCHED_FIFO, priority " + std::to_string(priority)
                              : "no real-time scheduling (" + std::string(std::strerror(error)) +
                                    "): other programs can delay frames; allow it with 'sudo tactum doctor "
                                    "--install-limits'");
}

void ask_locked_memory(LoopPrivileges& got) {
  // Under a finite limit, locking future memory would make later allocations fail, so then it is not
  // requested.
  rlimit limit{};
  const bool unlimited =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  int error = unlimited ? 0 : EPERM;
  // On fault: pages are locked once touched; the gigabytes that a program only reserves are not.
  if (unlimited && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0) error = errno;
  got.memory_locked = error == 0;
  got.sentences.push_back(got.memory_locked
                              ? "memory locked: no frame waits for a page from disk"
                              : "memory not locked (" + std::string(std::strerror(error)) +
                                    "): frames can wait for the disk when memory is short; allow it with "
                                    "'sudo tactum doctor --install-limits'");
}

}  // namespace

LoopPrivileges acquire_privileges(const RealtimeSettings& settings) {
  LoopPrivileges got;
  if (settings.realtime) {
    ask_realtime(settings.priority, got);
  } else {
    got.sentences.push_back("no real-time scheduling: not asked for");
  }
  if (settings.lock_memory) {
    ask_locked_memory(got);
  } else {
    got.sentences.push_back("memory not locked: not asked for");
  }
  got.wake_up_tolerance = prctl(PR_SET_TIMERSLACK, kWakeUpTolerance_ns, 0, 0, 0) == 0;
  got.sentences.push_back(got.wake_up_tolerance ? "timer slack: 1 ns" : "timer slack: the system's default");
  touch_stack();
  return got;
}

}  // namespace tactum::inline v0_1
