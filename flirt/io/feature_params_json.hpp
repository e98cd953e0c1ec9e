// flirt/io/feature_params_json.hpp: how features are made, as JSON.
//
//   {"detector": {"name": "curvature", "params": {…}}, "descriptor": {"name": "beta-grid", "params": {…}}}
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/features/extract.hpp"

#include <nlohmann/json.hpp>

namespace flirt {

[[nodiscard]] nlohmann::ordered_json json_from_feature_params(const FeatureParams& params);

/// Errors: an unknown name, a missing or unknown parameter, a value out of range, scales that are too coarse.
[[nodiscard]] Result<FeatureParams> feature_params_from_json(const nlohmann::ordered_json& json);

}  // namespace flirt
