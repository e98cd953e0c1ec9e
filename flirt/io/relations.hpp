// flirt/io/relations.hpp: relative poses between moments of a log, as Kümmerle et al. (2009) publish them:
// `stamp1 stamp2 x y z roll pitch yaw`, the second pose as seen from the first.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/eval/trajectory_metrics.hpp"

#include <filesystem>
#include <vector>

namespace flirt {

/// Reads a plain or gzip file, in its order; # comments and blank lines are skipped, z, roll and pitch are read and not
/// used. Errors: lines of other than eight finite numbers.
[[nodiscard]] Result<std::vector<Relation>> read_relations(const std::filesystem::path& path);

}  // namespace flirt
