// tests/support/print.hpp: how parameters of parameterised tests read in names and messages. Include it in every test
// of a module that has such tests on the library's types.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"

#include <cstddef>
#include <ostream>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace flirt {

template <class E>
  requires std::is_enum_v<E> && requires(E value) { enum_names(value); }
void PrintTo(const E& value, std::ostream* out) {
  *out << to_string(value);
}

inline void PrintTo(const Pose2& pose, std::ostream* out) {
  *out << "{" << pose.x << ", " << pose.y << ", " << pose.theta << "}";
}

/// The fields of a parameter struct that differ from their defaults: "{estimate raw-ratio}".
template <class Params>
  requires std::is_class_v<Params> && requires(const Params& params) {
    visit_fields(params, [](const auto& /*value*/, const Field& /*field*/) {});
  }
void PrintTo(const Params& params, std::ostream* out) {
  Params reference{};
  std::vector<std::string> usual;
  const auto text = [](const auto& value) -> std::string {
    if constexpr (std::is_enum_v<std::decay_t<decltype(value)>>) {
      return std::string(to_string(value));
    } else {
      std::ostringstream written;
      written << value;
      return written.str();
    }
  };
  visit_fields(reference, [&](const auto& value, const Field& /*field*/) { usual.push_back(text(value)); });
  std::size_t i = 0;
  const char* separator = "{";
  visit_fields(params, [&](const auto& value, const Field& field) {
    if (text(value) == usual[i++]) { return; }
    *out << separator << field.name << " " << text(value);
    separator = ", ";
  });
  *out << (*separator == '{' ? "{}" : "}");
}

}  // namespace flirt
