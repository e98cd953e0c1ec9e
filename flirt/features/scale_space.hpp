// flirt/features/scale_space.hpp: smoothing and differentiating a discrete signal at several scales.
#pragma once

#include "flirt/core/fields.hpp"

#include <array>
#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

/// The scales base · step^level (P2 §IV-B: five of them, step 1.4).
struct ScaleParams {
  int count{5};      ///< number of scales
  double base{1.6};  ///< finest t: m for the curvature detector, beams² (a variance) for the others
  double step{1.4};  ///< factor from one scale to the next
};

/// m or beams²; of the coarsest scale, whose kernel would have more samples than a scan of a log has beams.
inline constexpr double largest_scale = 20000;

/// Empty, or a sentence that says that the coarsest scale is beyond `largest_scale`: each field may be in range, yet
/// not all of them together.
[[nodiscard]] std::string too_coarse(const ScaleParams& params);

/// t of every level, finest first.
[[nodiscard]] std::vector<double> scale_bank(const ScaleParams& params);

enum class SmoothingKernel {
  bessel,    ///< e^−t I_x(t), the discrete counterpart of the Gaussian (P2 eq. 2)
  gaussian,  ///< e^(−x²/2t) at integer x, normalised
};
constexpr auto enum_names(SmoothingKernel /*tag*/) {
  return std::to_array<std::pair<SmoothingKernel, std::string_view>>(
      {{SmoothingKernel::bessel, "bessel"}, {SmoothingKernel::gaussian, "gaussian"}});
}

enum class Truncation {
  mass,        ///< at the smallest half width outside of which at most `lost_mass` lies
  half_width,  ///< at ⌈t⌉ samples, as in the authors' own program
};
constexpr auto enum_names(Truncation /*tag*/) {
  return std::to_array<std::pair<Truncation, std::string_view>>(
      {{Truncation::mass, "mass"}, {Truncation::half_width, "half-width"}});
}

enum class Border {
  mirror_sample,  ///< … 2 1 0 1 2 …: about the outermost sample
  mirror_edge,    ///< … 1 0 0 1 2 …: about the edge beside the outermost sample
};
constexpr auto enum_names(Border /*tag*/) {
  return std::to_array<std::pair<Border, std::string_view>>(
      {{Border::mirror_sample, "mirror-sample"}, {Border::mirror_edge, "mirror-edge"}});
}

/// How a signal over beams is smoothed and differentiated.
struct SmoothingParams {
  SmoothingKernel kernel{SmoothingKernel::bessel};  ///< whose variance is t
  Truncation truncation{Truncation::mass};          ///< where the kernel is cut off; it always keeps sum 1
  double lost_mass{1e-6};                           ///< share of the kernel outside of the cut, with truncation by mass
  Border border{Border::mirror_sample};  ///< continuation at the ends of the scan; a full turn continues around itself
  bool normalised{true};                 ///< multiply first derivatives by √t and second ones by t
};

/// Right half of a symmetric smoothing kernel of variance `t` ≥ 0: weights[x] = weights[−x], sum over all x exactly 1
/// up to rounding. O(t) for the Bessel kernel by backward recurrence, O(√t) for the Gaussian.
[[nodiscard]] std::vector<double> smoothing_kernel(const SmoothingParams& params, double t);

/// How a signal goes on beyond its ends.
struct Continuation {
  Border border{Border::mirror_sample};
  bool closed{false};       ///< circular: sample n is sample 0 plus `turn_offset`
  double turn_offset{0.0};  ///< what one turn adds (a multiple of 2π for an unwrapped angle), in the signal's unit
};

/// `signal` with `width` samples more on each side. `signal` must not be empty. O(n + width).
void extend(std::span<const double> signal, std::size_t width, const Continuation& continuation,
            std::vector<double>& extended);

/// out[i] = Σ_x kernel[|x|] · signal[i + x] (P2 eq. 1). `extended` is the signal with kernel.size() − 1 samples more on
/// each side. O(n · width).
void convolve(std::span<const double> extended, std::span<const double> kernel, std::vector<double>& out);

/// out[i] = factor · (s[i+1] − s[i−1]) / 2 (P2 eq. 6); `extended` has one sample more on each side.
void first_difference(std::span<const double> extended, double factor, std::vector<double>& out);

/// out[i] = factor · (s[i−1] − 2 s[i] + s[i+1]) (P2 eq. 4); `extended` has one sample more on each side.
void second_difference(std::span<const double> extended, double factor, std::vector<double>& out);

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, ScaleParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.count, Field{"scale_count", "", "number of scales", 1, 32});
  visit(params.base, Field{"scale_base", "m or beams²", "finest scale", 1e-3, 1e3});
  visit(params.step, Field{"scale_step", "1", "factor from one scale to the next", 1.0, 10.0});
}

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, SmoothingParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.kernel, Field{"kernel", "", "smoothing kernel over beams"});
  visit(params.truncation, Field{"truncation", "", "where the kernel is cut off"});
  visit(params.lost_mass, Field{"lost_mass", "1", "share of the kernel outside of the cut", 0.0, 0.5});
  visit(params.border, Field{"border", "", "continuation of the signal at the ends of the scan"});
  visit(params.normalised, Field{"normalised", "", "multiply derivatives by the scale"});
}

}  // namespace flirt
