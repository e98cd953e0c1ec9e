// apps/flirt/feature_flags.hpp: --detector, --descriptor and the parameters of each, for every command that makes
// features.
#pragma once

#include "flirt/features/extract.hpp"

#include "apps/flirt/param_flags.hpp"

#include <string>

namespace flirt::app {

/// Choice of detector and descriptor with their parameters: flags --curvature-…, --beta-grid-… and so on.
class FeatureFlags {
 public:
  /// Adds the flags to `command`; the parameters are resolved with `params`. Both objects must outlive the parsing.
  void add(CLI::App& command, ParamFlags& params);
  /// What was asked for; call after `params.resolve`. Parameters of what was not asked for are refused, and scales that
  /// are too coarse (UsageError).
  [[nodiscard]] FeatureParams features() const;

 private:
  const ParamFlags* params_{nullptr};
  std::string detector_{"curvature"};
  std::string descriptor_{"beta-grid"};
  CurvatureParams curvature_;
  RangeParams range_;
  NormalEdgeParams normal_edge_;
  NormalBlobParams normal_blob_;
  BetaGridParams beta_grid_;
  ShapeContextParams shape_context_;
};

}  // namespace flirt::app
