// flirt/eval/cpu_time.hpp: processor time.
#pragma once

#include <ctime>

namespace flirt {

/// µs that one of the system's clocks shows.
[[nodiscard]] inline double clock_us(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) / 1e3;
}

/// µs of the calling thread alone, so that other threads and other people's work don't count.
[[nodiscard]] inline double thread_cpu_us() {
  return clock_us(CLOCK_THREAD_CPUTIME_ID);
}

/// µs of all threads of this program together.
[[nodiscard]] inline double process_cpu_us() {
  return clock_us(CLOCK_PROCESS_CPUTIME_ID);
}

}  // namespace flirt
