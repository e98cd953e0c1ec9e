// tests/support/numbers.hpp: numbers that tests of every module need.
#pragma once

#include <limits>
#include <numbers>

namespace flirt {

inline constexpr double pi = std::numbers::pi;
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

}  // namespace flirt
