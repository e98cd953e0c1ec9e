// The two functions of Highway's shared library that the probe needs. The library itself, when loaded, reads the clock
// by an instruction (rdtscp) that valgrind refuses on processors that hide it, some virtual ones: so it is left out.

#include <hwy/highway.h>

namespace hwy {

std::int64_t SupportedTargets() {
  const bool wide = __builtin_cpu_supports("avx2") > 0 && __builtin_cpu_supports("fma") > 0;
  return HWY_STATIC_TARGET | (wide ? HWY_AVX2 : 0);
}

ChosenTarget& GetChosenTarget() {
  static ChosenTarget target;
  return target;
}

}  // namespace hwy
