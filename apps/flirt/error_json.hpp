// apps/flirt/error_json.hpp: errors of trajectories as JSON, for all commands that report them.
#pragma once

#include "flirt/eval/map_quality.hpp"
#include "flirt/eval/trajectory_metrics.hpp"

#include <nlohmann/json.hpp>

#include <string_view>

namespace flirt::app {

/// {rmse, mean, sd, median, max, count}; null, but the count, where that is 0.
nlohmann::ordered_json summary_json(const ErrorSummary& summary);
/// {translation_m, rotation_deg}.
nlohmann::ordered_json error_json(const TrajectoryError& error);
/// {source, count, skipped, difference, motion}; `source` is "official" or "derived".
nlohmann::ordered_json relations_json(const RelationsError& error, std::string_view source);
/// {point_to_line_rms_m, pairs, points, occupied_cells}; null without pairs.
nlohmann::ordered_json quality_json(const MapQuality& quality);

}  // namespace flirt::app
