// flirt/core/stopwatch.hpp: where the time goes.
#pragma once

#include <chrono>
#include <utility>

namespace flirt {

/// Microseconds since its construction or its last lap.
class Stopwatch {
 public:
  double lap_us() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::micro>(now - std::exchange(start_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point start_{std::chrono::steady_clock::now()};
};

}  // namespace flirt
