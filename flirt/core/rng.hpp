// flirt/core/rng.hpp: small, fast, seeded random numbers that are the same on every platform.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace flirt {

/// xoshiro256++ (Blackman and Vigna 2019), seeded through splitmix64. Not for cryptography.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) {
    for (std::uint64_t& word : state_) {
      seed += 0x9e3779b97f4a7c15ULL;
      word = mix(seed);
    }
  }
  /// An independent stream: equal (seed, stream) give equal numbers, whichever thread asks.
  Rng(std::uint64_t seed, std::uint64_t stream) : Rng(mix(seed + 0x632be59bd9b4e019ULL) ^ mix(stream)) {}

  std::uint64_t bits() {
    const std::uint64_t result = rotate(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = rotate(state_[3], 45);
    return result;
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in {0, …, n − 1}; n > 0. The bias, below n / 2³², is accepted.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((bits() >> 32U) * std::uint64_t{n}) >> 32U);
  }
  /// Standard normal (Box and Muller); two uniforms a draw, no state kept between draws.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  double normal(double mean, double deviation) { return mean + deviation * normal(); }

 private:
  static std::uint64_t rotate(std::uint64_t x, unsigned k) { return (x << k) | (x >> (64U - k)); }
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }
  std::uint64_t state_[4]{};
};

}  // namespace flirt
