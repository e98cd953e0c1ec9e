#include "flirt/features/detect.hpp"

#include "flirt/features/curve_smoothing.hpp"
#include "flirt/features/geodesic.hpp"
#include "flirt/features/normal.hpp"
#include "flirt/features/scan_curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flirt {
namespace {

constexpr std::array<std::string_view, 4> detector_names{"curvature", "range", "normal-edge", "normal-blob"};

template <class Params>
concept SignalDetector = !std::same_as<Params, CurvatureParams>;

/// Working memory of all detectors.
struct Work {
  ScanCurveReader reader{};
  std::vector<double> response{};
  std::vector<std::uint32_t> peaks{};
  std::vector<Candidate> candidates{};
  DuplicateWork duplicates{};
  std::vector<Keypoint> keypoints{};
  // Curvature.
  CurveSmoother smoother{};
  AlignedVector<double> arc{};
  std::vector<SmoothedCurve> smoothed_curves{};  ///< one per scale
  // Signals.
  std::vector<double> extended{};
  std::vector<double> smoothed{};
  std::vector<double> normals{};  ///< rad, unwrapped
  std::vector<double> x{};        ///< m, of points at smoothed ranges
  std::vector<double> y{};        ///< m
};

/// What is computed once from the parameters.
struct Plan {
  std::vector<double> scales{};
  double reach{0};                             ///< of the curvature detector's Gaussian, in t
  std::vector<std::vector<double>> kernels{};  ///< of the signal detectors, one per scale
};

Plan make_plan(const CurvatureParams& params) {
  return {scale_bank(params.scales), gaussian_reach(params.lost_mass), {}};
}

template <SignalDetector Params>
Plan make_plan(const Params& params) {
  Plan plan{scale_bank(params.scales), 0.0, {}};
  for (const double t : plan.scales) { plan.kernels.push_back(smoothing_kernel(params.smoothing, t)); }
  return plan;
}

Point2 point_at(const ScanCurve& curve, std::size_t i) {
  return {curve.x[i], curve.y[i]};
}

double direction(Point2 from, Point2 to) {
  return wrap_angle(std::atan2(to.y - from.y, to.x - from.x));
}

/// Adds the peaks of one scale to the candidates.
void collect(const ScanCurve& curve, const SelectionParams& params, std::size_t level, Work& work) {
  for (const std::uint32_t peak : work.peaks) {
    const std::uint32_t point = params.foreground_shift ? foreground_point(curve, peak, params.foreground_jump) : peak;
    if (!curve.hit[point]) { continue; }
    work.candidates.push_back({peak, point, work.response[peak], static_cast<std::uint8_t>(level)});
  }
}

Keypoint keypoint_of(const ScanCurve& curve, const Candidate& candidate, double t, double theta, double support) {
  const Point2 point = point_at(curve, candidate.point);
  return {.sensor_from_keypoint = {point.x, point.y, wrap_angle(theta)},
          .scale = static_cast<float>(t),
          .support_radius = static_cast<float>(support),
          .response = static_cast<float>(candidate.response),
          .beam = curve.beams[candidate.point],
          .level = candidate.level};
}

std::uint32_t anchor_of(const Candidate& candidate, Anchor anchor) {
  return anchor == Anchor::peak ? candidate.peak : candidate.point;
}

void trace_scale(double t, const Work& work, ScaleTrace& scale) {
  scale.t = t;
  scale.response = work.response;
  scale.peaks = work.peaks;
}

void trace_points(const ScanCurve& curve, std::span<const double> signal, DetectorTrace& trace) {
  trace = {};
  trace.beams = curve.beams;
  for (std::size_t i = 0; i < curve.size(); ++i) { trace.points.push_back(point_at(curve, i)); }
  trace.signal.assign(signal.begin(), signal.end());
}

// Curvature detector.

/// Drops the candidates that lie within `margin` · t of the first or the last point of an open curve.
void drop_near_ends(const ScanCurve& curve, const Plan& plan, double margin, std::vector<Candidate>& candidates) {
  if (curve.closed || curve.size() == 0) { return; }
  const Point2 first = point_at(curve, 0);
  const Point2 last = point_at(curve, curve.size() - 1);
  std::erase_if(candidates, [&](const Candidate& candidate) {
    const double distance = margin * plan.scales[candidate.level];
    const Point2 point = point_at(curve, candidate.point);
    return std::min(squared_norm(point - first), squared_norm(point - last)) < distance * distance;
  });
}

/// The curve at every scale, into work.smoothed_curves.
void smooth_curve(const ScanCurve& curve, const CurvatureParams& params, const Plan& plan, Work& work) {
  work.smoothed_curves.resize(plan.scales.size());
  if (params.geodesic == Geodesic::arc_length) {
    const double length = arc_lengths(curve.x, curve.y, curve.closed, work.arc);
    work.smoother.set_curve(curve.x, curve.y, work.arc, curve.closed, length);
    for (std::size_t level = 0; level < plan.scales.size(); ++level) {
      work.smoother.smooth(plan.scales[level], plan.reach, work.smoothed_curves[level]);
    }
    return;
  }
  const std::vector<CurveEdge> edges = spanning_tree_edges(curve.x, curve.y, params.spanning_trees);
  const double widest = plan.scales.empty() ? 0.0 : *std::ranges::max_element(plan.scales);
  const GeodesicNeighbours neighbours = shortest_paths(edges, curve.size(), plan.reach * widest);
  for (std::size_t level = 0; level < plan.scales.size(); ++level) {
    smooth_over(neighbours, curve.x, curve.y, plan.scales[level], plan.reach, work.smoothed_curves[level]);
  }
}

void run(const ScanCurve& curve, const CurvatureParams& params, const Plan& plan, Work& work, DetectorTrace* trace) {
  smooth_curve(curve, params, plan, work);
  if (trace != nullptr) { trace_points(curve, curve.ranges, *trace); }
  const PeakSearch search{.extrema = Extrema::maxima, .margin = 1, .closed = curve.closed};
  for (std::size_t level = 0; level < plan.scales.size(); ++level) {
    const SmoothedCurve& smoothed = work.smoothed_curves[level];
    damped_displacement(curve.x, curve.y, smoothed, plan.scales[level], work.response);
    find_peaks(work.response, params.peaks, search, work.peaks);
    collect(curve, params.selection, level, work);
    if (trace == nullptr) { continue; }
    ScaleTrace& scale = trace->scales.emplace_back();
    trace_scale(plan.scales[level], work, scale);
    for (std::size_t i = 0; i < curve.size(); ++i) { scale.smoothed_curve.push_back({smoothed.x[i], smoothed.y[i]}); }
  }
  drop_near_ends(curve, plan, params.end_margin, work.candidates);
  drop_duplicates(curve, params.selection, work.duplicates, work.candidates);
  for (const Candidate& candidate : work.candidates) {
    const SmoothedCurve& smoothed = work.smoothed_curves[candidate.level];
    const std::uint32_t anchor = anchor_of(candidate, params.selection.anchor);
    const double theta = direction(point_at(curve, candidate.point), {smoothed.x[anchor], smoothed.y[anchor]});
    const double t = plan.scales[candidate.level];
    work.keypoints.push_back(keypoint_of(curve, candidate, t, theta, params.support_factor * t));
  }
}

// Signal detectors.

/// Normals of the curve, unwrapped, into work.normals. Returns what one turn adds to them.
template <SignalDetector Params>
double find_normals(const ScanCurve& curve, const Params& params, const Plan& plan, Work& work) {
  std::span<const double> x = curve.x;
  std::span<const double> y = curve.y;
  if (params.normal.smooth_ranges && !plan.kernels.empty()) {
    const Continuation continuation{.border = params.smoothing.border, .closed = curve.closed};
    extend(curve.ranges, plan.kernels[0].size() - 1, continuation, work.extended);
    convolve(work.extended, plan.kernels[0], work.smoothed);
    work.x.resize(curve.size());
    work.y.resize(curve.size());
    for (std::size_t i = 0; i < curve.size(); ++i) {
      work.x[i] = work.smoothed[i] * curve.cosines[i];
      work.y[i] = work.smoothed[i] * curve.sines[i];
    }
    x = work.x;
    y = work.y;
  }
  estimate_normals(x, y, params.normal.window, curve.closed, work.normals);
  return unwrap(work.normals);
}

/// Half width, in beams, of the neighbourhood that belongs to scale t: of the scan's ends where nothing is detected
/// (one beam more), and of the support region. The authors' program cuts its kernels there, too. A kernel cut by mass
/// is wider, and sees the mirrored continuation from further inside: where a straight wall's ranges end steeply the
/// range detector then finds a point about 3 √t from the end. Leaving out the whole kernel loses more:
/// docs/concepts.md.
std::size_t half_width(double t) {
  return static_cast<std::size_t>(std::ceil(t));
}

/// Distance from a candidate to the farthest point within the half width of its anchor.
double support_radius(const ScanCurve& curve, const Candidate& candidate, std::size_t anchor, double t) {
  const std::size_t n = curve.size();
  const std::size_t width = std::min(half_width(t), (n - 1) / 2);
  const std::size_t first = curve.closed ? anchor + n - width : n + anchor - std::min(anchor, half_width(t));
  const std::size_t last = curve.closed ? anchor + n + width : n + std::min(anchor + half_width(t), n - 1);
  double farthest = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    farthest = std::max(farthest, norm(point_at(curve, i % n) - point_at(curve, candidate.point)));
  }
  return farthest;
}

/// Finds the response of one scale into work.response: first derivative of the normals, or second of either signal.
template <SignalDetector Params>
void respond(std::span<const double> signal, const Continuation& continuation, const Params& params,
             std::span<const double> kernel, double t, Work& work) {
  extend(signal, kernel.size() - 1, continuation, work.extended);
  convolve(work.extended, kernel, work.smoothed);
  extend(work.smoothed, 1, continuation, work.extended);
  if constexpr (std::same_as<Params, NormalEdgeParams>) {
    first_difference(work.extended, params.smoothing.normalised ? std::sqrt(t) : 1.0, work.response);
  } else {
    second_difference(work.extended, params.smoothing.normalised ? t : 1.0, work.response);
  }
}

template <SignalDetector Params>
void run(const ScanCurve& curve, const Params& params, const Plan& plan, Work& work, DetectorTrace* trace) {
  if (curve.size() == 0) {
    if (trace != nullptr) { *trace = {}; }
    return;
  }
  constexpr bool over_ranges = std::same_as<Params, RangeParams>;
  const double turn = find_normals(curve, params, plan, work);
  const std::span<const double> signal = over_ranges ? std::span<const double>(curve.ranges) : work.normals;
  const Continuation continuation{
      .border = params.smoothing.border, .closed = curve.closed, .turn_offset = over_ranges ? 0.0 : turn};
  if (trace != nullptr) { trace_points(curve, signal, *trace); }
  for (std::size_t level = 0; level < plan.scales.size(); ++level) {
    const double t = plan.scales[level];
    respond(signal, continuation, params, plan.kernels[level], t, work);
    const PeakSearch search{.extrema = Extrema::both, .margin = half_width(t), .closed = curve.closed};
    find_peaks(work.response, params.peaks, search, work.peaks);
    collect(curve, params.selection, level, work);
    if (trace == nullptr) { continue; }
    ScaleTrace& scale = trace->scales.emplace_back();
    trace_scale(t, work, scale);
    scale.smoothed_signal = work.smoothed;
  }
  drop_duplicates(curve, params.selection, work.duplicates, work.candidates);
  for (const Candidate& candidate : work.candidates) {
    const std::uint32_t anchor = anchor_of(candidate, params.selection.anchor);
    const double t = plan.scales[candidate.level];
    const double support = support_radius(curve, candidate, anchor, t);
    work.keypoints.push_back(keypoint_of(curve, candidate, t, work.normals[anchor], support));
  }
}

}  // namespace

struct Detector::State {
  DetectorParams params;
  Plan plan;
  Work work;
};

Detector::Detector(DetectorParams params) : state_(std::make_unique<State>()) {
  state_->plan = std::visit([](const auto& alternative) { return make_plan(alternative); }, params);
  state_->params = params;
}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

const DetectorParams& Detector::params() const {
  return state_->params;
}

std::span<const Keypoint> Detector::detect(const Scan& scan, DetectorTrace* trace) {
  Work& work = state_->work;
  work.candidates.clear();
  work.keypoints.clear();
  const auto detect_with = [&](const auto& params) {
    const ScanCurve& curve = work.reader.read(scan, params.selection.no_return);
    run(curve, params, state_->plan, work, trace);
  };
  std::visit(detect_with, state_->params);
  return work.keypoints;
}

std::vector<Keypoint> detect(const Scan& scan, const DetectorParams& params, DetectorTrace* trace) {
  Detector detector(params);
  const std::span<const Keypoint> keypoints = detector.detect(scan, trace);
  return {keypoints.begin(), keypoints.end()};
}

std::string_view detector_name(const DetectorParams& params) {
  return detector_names[params.index()];
}

std::optional<DetectorParams> detector_from_name(std::string_view name) {
  const std::array<DetectorParams, 4> defaults{CurvatureParams{}, RangeParams{}, NormalEdgeParams{},
                                               NormalBlobParams{}};
  for (const DetectorParams& params : defaults) {
    if (detector_name(params) == name) { return params; }
  }
  return std::nullopt;
}

}  // namespace flirt
