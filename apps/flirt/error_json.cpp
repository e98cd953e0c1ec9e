#include "apps/flirt/error_json.hpp"

namespace flirt::app {

nlohmann::ordered_json summary_json(const ErrorSummary& summary) {
  if (summary.count == 0) {  // nothing to compare is no perfect score
    return {{"rmse", nullptr}, {"mean", nullptr}, {"sd", nullptr}, {"median", nullptr}, {"max", nullptr}, {"count", 0}};
  }
  return {{"rmse", summary.rmse},     {"mean", summary.mean}, {"sd", summary.deviation},
          {"median", summary.median}, {"max", summary.max},   {"count", summary.count}};
}

nlohmann::ordered_json error_json(const TrajectoryError& error) {
  return {{"translation_m", summary_json(error.translation)}, {"rotation_deg", summary_json(error.rotation_degrees)}};
}

nlohmann::ordered_json relations_json(const RelationsError& error, std::string_view source) {
  return {{"source", source},
          {"count", error.difference.translation.count},
          {"skipped", error.skipped},
          {"difference", error_json(error.difference)},
          {"motion", error_json(error.motion)}};
}

nlohmann::ordered_json quality_json(const MapQuality& quality) {
  return {{"point_to_line_rms_m",
           quality.pairs > 0 ? nlohmann::ordered_json(quality.point_to_line_rms) : nlohmann::ordered_json(nullptr)},
          {"pairs", quality.pairs},
          {"points", quality.points},
          {"occupied_cells", quality.occupied_cells}};
}

}  // namespace flirt::app
