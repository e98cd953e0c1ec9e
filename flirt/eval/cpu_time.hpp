// flirt/eval/cpu_time.hpp: processor time of one thread.
#pragma once

#include <ctime>

namespace flirt {

/// µs of the calling thread alone, so that other threads and other people's work don't count.
[[nodiscard]] inline double thread_cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) / 1e3;
}

}  // namespace flirt
