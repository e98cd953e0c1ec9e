// flirt/core/fields.hpp: the one description of a parameter struct that feeds flags, TOML, JSON, range checks and docs.
//
// Each parameter struct P has, beside it, one function template found by argument-dependent lookup:
//
//   template <class Params, class Visitor>                        // Params is P or const P
//     requires std::same_as<std::remove_const_t<Params>, RansacParams>
//   void visit_fields(Params& params, Visitor&& visit) {
//     visit(params.inlier_distance, Field{"inlier_distance", "m", "residual below which a match supports", 0.0, 10.0});
//     ...
//   }
//
// Fields are double, float, int, std::uint32_t, std::uint64_t, bool, or an enum. An enum E names its values by
// `constexpr auto enum_names(E)` returning std::array<std::pair<E, std::string_view>, N>.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

namespace flirt {

struct Field {
  std::string_view name;  ///< snake_case, as in the struct
  std::string_view unit;  ///< "m", "rad", "1"; empty for enums, switches and counts
  std::string_view help;
  double min{-std::numeric_limits<double>::infinity()};  ///< smallest allowed value, included
  double max{std::numeric_limits<double>::infinity()};   ///< largest allowed value, included
};

/// The name of an enum value.
template <class E>
  requires std::is_enum_v<E>
[[nodiscard]] constexpr std::string_view to_string(E value) {
  for (const auto& [candidate, name] : enum_names(E{})) {
    if (candidate == value) { return name; }
  }
  return "?";
}

/// Empty when every field is within its range (and no number is NaN), else a sentence naming the first that is not.
template <class Params>
[[nodiscard]] std::string out_of_range(const Params& params) {
  std::string complaint;
  visit_fields(params, [&](const auto& value, const Field& field) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
      const auto number = static_cast<double>(value);
      if (complaint.empty() && !(number >= field.min && number <= field.max)) {
        complaint = std::string(field.name) + ": expected " + std::to_string(field.min) + " to " +
                    std::to_string(field.max) + ", found " + std::to_string(number);
      }
    }
  });
  return complaint;
}

}  // namespace flirt
