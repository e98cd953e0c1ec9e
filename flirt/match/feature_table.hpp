// flirt/match/feature_table.hpp: the features of one scan with the columns that matching reads.
#pragma once

#include "flirt/features/extract.hpp"
#include "flirt/match/columns.hpp"

#include <utility>

namespace flirt {

/// Owner of all that `columns` shows; moving it leaves them valid.
struct FeatureTable {
  Features features{};
  KeypointTable keypoints{};

  [[nodiscard]] FeatureColumns columns() const { return {keypoints.columns(), rows_of(features.descriptors)}; }
};

[[nodiscard]] inline FeatureTable feature_table(Features features) {
  KeypointTable keypoints = table_of(features.keypoints);
  return {std::move(features), std::move(keypoints)};
}

}  // namespace flirt
