// flirt/features/detect.hpp: interest points of a scan: the papers' four detectors.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/features/features.hpp"
#include "flirt/features/peaks.hpp"
#include "flirt/features/scale_space.hpp"
#include "flirt/features/selection.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace flirt {

/// How distances along the curve are measured.
enum class Geodesic {
  arc_length,      ///< along the polyline from point to point
  spanning_trees,  ///< shortest paths over disjoint minimum spanning trees: bridges gaps, O(n²), for comparison
};
constexpr auto enum_names(Geodesic /*tag*/) {
  return std::to_array<std::pair<Geodesic, std::string_view>>(
      {{Geodesic::arc_length, "arc-length"}, {Geodesic::spanning_trees, "spanning-trees"}});
}

/// Curvature of the scan's curve: maxima of F = z e^−z, z = 2 |x − S̃| / t, over the smoothed curve S̃ (P1 §2.1,
/// P2 §II-C). t is the standard deviation of the Gaussian along the curve, m: only then does F peak at curvature 1 / t
/// (to second order in t: there |x − S̃| is t²/2 times the curvature).
struct CurvatureParams {
  ScaleParams scales{.count = 5, .base = 0.2, .step = 1.4};  ///< t, m
  PeakParams peaks{};                                        ///< of F, which is at most 1/e
  SelectionParams selection{};
  Geodesic geodesic{Geodesic::arc_length};
  int spanning_trees{3};       ///< number of disjoint trees, when those are used
  double lost_mass{1e-6};      ///< share of the Gaussian that is cut off; 0: nothing
  double end_margin{2.0};      ///< in t: no keypoint this close to the first or last point of an open scan
  double support_factor{2.0};  ///< support radius in t
};

/// How surface normals are estimated (P2 §II-B).
struct NormalParams {
  int window{3};             ///< points in the least-squares fit, odd
  bool smooth_ranges{true};  ///< smooth the ranges at the finest scale before
};

/// Blobs in the ranges: extrema of their second derivative over the beams (P2 §II-A, eq. 3).
struct RangeParams {
  ScaleParams scales{.count = 5, .base = 1.6, .step = 1.4};  ///< t, beams² (variance)
  SmoothingParams smoothing{};
  PeakParams peaks{};  ///< of the second derivative, m
  SelectionParams selection{};
  NormalParams normal{};  ///< which gives a keypoint its direction
};

/// Edges in the direction of the normals: extrema of their first derivative over the beams (P2 §II-B, eq. 5).
struct NormalEdgeParams {
  ScaleParams scales{.count = 5, .base = 1.6, .step = 1.4};  ///< t, beams² (variance)
  SmoothingParams smoothing{};
  PeakParams peaks{};  ///< of the first derivative, rad
  SelectionParams selection{};
  NormalParams normal{};
};

/// Blobs in the direction of the normals: extrema of their second derivative over the beams (P2 §II-B, eq. 3).
struct NormalBlobParams {
  ScaleParams scales{.count = 5, .base = 1.6, .step = 1.4};  ///< t, beams² (variance)
  SmoothingParams smoothing{};
  PeakParams peaks{};  ///< of the second derivative, rad
  SelectionParams selection{};
  NormalParams normal{};
};

using DetectorParams = std::variant<CurvatureParams, RangeParams, NormalEdgeParams, NormalBlobParams>;

/// "curvature", "range", "normal-edge" or "normal-blob".
[[nodiscard]] std::string_view detector_name(const DetectorParams& params);

/// The detector of that name with its default parameters.
[[nodiscard]] std::optional<DetectorParams> detector_from_name(std::string_view name);

/// What a detector saw at one scale.
struct ScaleTrace {
  double t{0};                            ///< the scale, m (curvature) or beams²
  std::vector<double> smoothed_signal{};  ///< of the signal detectors: m or rad
  std::vector<Point2> smoothed_curve{};   ///< of the curvature detector: m, sensor frame
  std::vector<double> response{};         ///< F, or the derivative of the smoothed signal
  std::vector<std::uint32_t> peaks{};     ///< indices into DetectorTrace::beams, before any selection
};

/// Everything on the way from a scan to its keypoints; one element per point of the curve where nothing else is said.
struct DetectorTrace {
  std::vector<std::uint32_t> beams{};  ///< indices into Scan::ranges, in order of increasing angle
  std::vector<Point2> points{};        ///< m, sensor frame
  std::vector<double> signal{};        ///< ranges (m) for curvature and range, unwrapped normals (rad) otherwise
  std::vector<ScaleTrace> scales{};    ///< finest first
};

/// A detector with all the memory that it needs: detecting does not allocate once scans of the same size have been seen
/// (with Geodesic::arc_length and without a trace). Not for use by several threads at once.
class Detector {
 public:
  explicit Detector(DetectorParams params = {});
  ~Detector();
  Detector(Detector&&) noexcept;
  Detector& operator=(Detector&&) noexcept;
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  /// Keypoints in order of scale (finest first), then of angle; valid until the next call. Empty when fewer than three
  /// beams have a return. Of a full turn the first and the last beam are neighbours. Curvature by arc length:
  /// O(scales · beams · beams within reach); by spanning trees O(beams²); the others O(scales · beams · √t).
  [[nodiscard]] std::span<const Keypoint> detect(const Scan& scan, DetectorTrace* trace = nullptr);

  [[nodiscard]] const DetectorParams& params() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Keypoints of one scan, see Detector::detect.
[[nodiscard]] std::vector<Keypoint> detect(const Scan& scan, const DetectorParams& params = {},
                                           DetectorTrace* trace = nullptr);

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, CurvatureParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.scales, visit);
  visit_fields(params.peaks, visit);
  visit_fields(params.selection, visit);
  visit(params.geodesic, Field{"geodesic", "", "how distances along the curve are measured"});
  visit(params.spanning_trees, Field{"spanning_trees", "", "number of disjoint trees", 1, 32});
  visit(params.lost_mass, Field{"lost_mass", "1", "share of the Gaussian that is cut off", 0.0, 0.5});
  visit(params.end_margin, Field{"end_margin", "t", "no keypoint this close to the ends of the scan", 0.0, 1e3});
  visit(params.support_factor, Field{"support_factor", "t", "radius of the support region", 1e-3, 1e3});
}

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, NormalParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.window, Field{"normal_window", "beams", "points in the fit of a normal", 3, 999});
  visit(params.smooth_ranges, Field{"smooth_ranges", "", "smooth the ranges at the finest scale before"});
}

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, RangeParams> ||
           std::same_as<std::remove_const_t<Params>, NormalEdgeParams> ||
           std::same_as<std::remove_const_t<Params>, NormalBlobParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.scales, visit);
  visit_fields(params.smoothing, visit);
  visit_fields(params.peaks, visit);
  visit_fields(params.selection, visit);
  visit_fields(params.normal, visit);
}

}  // namespace flirt
