// A detector that has seen a scan of a size allocates nothing for the next.
#include "flirt/features/detect.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <numbers>

namespace {
std::atomic<std::size_t> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* const pointer = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (pointer == nullptr) { std::abort(); }
  return pointer;
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* pointer) noexcept {
  std::free(pointer);
}
void operator delete(void* pointer, std::size_t /*size*/) noexcept {
  std::free(pointer);
}
void operator delete(void* pointer, std::align_val_t /*alignment*/) noexcept {
  std::free(pointer);
}
void operator delete(void* pointer, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept {
  std::free(pointer);
}

namespace flirt {
namespace {

TEST(Detector, AllocatesNothingOnceItHasSeenAScanOfTheSize) {
  Scan scan{.beams = {.angle_min = -1.5, .angle_step = 0.01, .range_max = 30}};
  for (int i = 0; i < 361; ++i) {
    scan.ranges.push_back(3.0 + 0.5 * std::abs(std::sin(0.05 * i)) + (std::sin(0.07 * i) > 0.3 ? 1.5 : 0.0));
  }
  for (const DetectorParams& params : {DetectorParams{CurvatureParams{}}, DetectorParams{RangeParams{}},
                                       DetectorParams{NormalEdgeParams{}}, DetectorParams{NormalBlobParams{}}}) {
    Detector detector(params);
    const std::size_t found = detector.detect(scan).size();
    EXPECT_GT(found, 0U) << detector_name(params);
    const std::size_t before = allocations;
    EXPECT_EQ(detector.detect(scan).size(), found);
    EXPECT_EQ(allocations, before) << detector_name(params);
  }
}

}  // namespace
}  // namespace flirt
