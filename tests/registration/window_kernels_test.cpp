#include "flirt/registration/window_kernels.hpp"

#include "flirt/core/rng.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace flirt {
namespace {

template <class Sums>
Sums plain_sums(const std::vector<std::uint8_t>& bytes, const std::vector<std::int32_t>& offsets) {
  Sums sums{};
  for (const std::int32_t offset : offsets) {
    for (std::size_t k = 0; k < sums.size(); ++k) {
      sums[k] = static_cast<std::uint16_t>(sums[k] + bytes[static_cast<std::size_t>(offset) + k]);
    }
  }
  return sums;
}

TEST(WindowKernels, SumAsAPlainLoopDoes) {
  Rng rng(5);
  std::vector<std::uint8_t> bytes(1000);
  for (std::uint8_t& byte : bytes) { byte = static_cast<std::uint8_t>(rng.below(LocalMap::largest + 1)); }
  for (const std::size_t count : {0U, 1U, 16U, 17U, 18U, 100U, 4369U}) {
    std::vector<std::int32_t> offsets(count);
    for (std::int32_t& offset : offsets) { offset = static_cast<std::int32_t>(rng.below(900)); }
    EXPECT_EQ(window::sum_rows(bytes.data(), offsets), plain_sums<window::RowSums>(bytes, offsets)) << count;
    EXPECT_EQ(window::sum_tiles(bytes.data(), offsets), plain_sums<window::TileSums>(bytes, offsets)) << count;
  }
  const std::vector<std::uint8_t> highest(100, LocalMap::largest);
  EXPECT_THAT(window::sum_rows(highest.data(), std::vector<std::int32_t>(4369, 3)), testing::Each(65535));
}

TEST(WindowKernels, FindRowsWhereTheMapHasThem) {
  const LocalMap map;
  std::vector<CellIndex> cells;
  Rng rng(6);
  for (int i = 0; i < 100; ++i) {
    cells.push_back({static_cast<std::int32_t>(rng.below(5000)) - 2500, static_cast<std::int32_t>(rng.below(9)) - 4});
  }
  std::vector<std::int32_t> offsets(cells.size());
  window::row_offsets(cells, -7, 12, offsets);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(map.values() + offsets[i], map.row({cells[i].x - 7, cells[i].y + 12}));
  }
}

}  // namespace
}  // namespace flirt
