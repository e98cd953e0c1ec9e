#include "apps/flirt/feature_flags.hpp"

#include "apps/flirt/command.hpp"

#include <variant>

namespace flirt::app {

void FeatureFlags::add(CLI::App& command, ParamFlags& params) {
  command.add_option("--detector", detector_, "curvature, range, normal-edge or normal-blob (default curvature)")
      ->check(CLI::IsMember({"curvature", "range", "normal-edge", "normal-blob"}));
  command.add_option("--descriptor", descriptor_, "beta-grid or shape-context (default beta-grid)")
      ->check(CLI::IsMember({"beta-grid", "shape-context"}));
  params.add(command, "curvature", curvature_);
  params.add(command, "range", range_);
  params.add(command, "normal-edge", normal_edge_);
  params.add(command, "normal-blob", normal_blob_);
  params.add(command, "beta-grid", beta_grid_);
  params.add(command, "shape-context", shape_context_);
}

FeatureParams FeatureFlags::features() const {
  FeatureParams features;
  if (detector_ == "range") {
    features.detector = range_;
  } else if (detector_ == "normal-edge") {
    features.detector = normal_edge_;
  } else if (detector_ == "normal-blob") {
    features.detector = normal_blob_;
  } else {
    features.detector = curvature_;
  }
  const std::string complaint =
      std::visit([](const auto& params) { return too_coarse(params.scales); }, features.detector);
  if (!complaint.empty()) { throw UsageError("--detector " + detector_ + ": " + complaint); }
  if (descriptor_ == "shape-context") {
    features.descriptor = shape_context_;
  } else {
    features.descriptor = beta_grid_;
  }
  return features;
}

}  // namespace flirt::app
