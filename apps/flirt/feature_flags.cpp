#include "apps/flirt/feature_flags.hpp"

#include "apps/flirt/command.hpp"

#include <fmt/format.h>

#include <array>
#include <span>
#include <variant>
#include <vector>

namespace flirt::app {
namespace {

constexpr std::array detector_choices{"curvature", "range", "normal-edge", "normal-blob"};
constexpr std::array descriptor_choices{"beta-grid", "shape-context"};

/// The parameters of the other choices would have no effect.
void expect_only(const ParamFlags& params, const std::string& flag, const std::string& chosen,
                 std::span<const char* const> choices) {
  for (const std::string choice : choices) {
    if (choice != chosen) { params.expect_none(choice, fmt::format("{} {}", flag, choice)); }
  }
}

}  // namespace

void FeatureFlags::add(CLI::App& command, ParamFlags& params) {
  params_ = &params;
  command.add_option("--detector", detector_, "curvature, range, normal-edge or normal-blob (default curvature)")
      ->check(CLI::IsMember(std::vector<std::string>(detector_choices.begin(), detector_choices.end())));
  command.add_option("--descriptor", descriptor_, "beta-grid or shape-context (default beta-grid)")
      ->check(CLI::IsMember(std::vector<std::string>(descriptor_choices.begin(), descriptor_choices.end())));
  params.add(command, "curvature", curvature_);
  params.add(command, "range", range_);
  params.add(command, "normal-edge", normal_edge_);
  params.add(command, "normal-blob", normal_blob_);
  params.add(command, "beta-grid", beta_grid_);
  params.add(command, "shape-context", shape_context_);
}

FeatureParams FeatureFlags::features() const {
  expect_only(*params_, "--detector", detector_, detector_choices);
  expect_only(*params_, "--descriptor", descriptor_, descriptor_choices);
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
