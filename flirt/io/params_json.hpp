// flirt/io/params_json.hpp: parameter structs as JSON objects, {"field": value}, exact to the last bit.
#pragma once

#include "flirt/core/fields.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>

namespace flirt {

/// Every field of `params` by name; enums by the names of their values.
template <class Params>
[[nodiscard]] nlohmann::ordered_json json_from_params(const Params& params) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  visit_fields(params, [&json](const auto& value, const Field& field) {
    if constexpr (std::is_enum_v<std::decay_t<decltype(value)>>) {
      json[std::string(field.name)] = to_string(value);
    } else {
      json[std::string(field.name)] = value;
    }
  });
  return json;
}

namespace detail {

template <class Value>
[[nodiscard]] bool read_value(const nlohmann::ordered_json& json, Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    for (const auto& [candidate, name] : enum_names(Value{})) {
      if (json.is_string() && json.get_ref<const std::string&>() == name) {
        value = candidate;
        return true;
      }
    }
    return false;
  } else if constexpr (std::is_same_v<Value, bool>) {
    if (json.is_boolean()) { value = json.get<bool>(); }
    return json.is_boolean();
  } else if constexpr (std::is_integral_v<Value>) {
    const bool fits =
        json.is_number_unsigned()
            ? json.get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<Value>::max())
            : std::is_signed_v<Value> && json.is_number_integer() &&
                  json.get<std::int64_t>() >= static_cast<std::int64_t>(std::numeric_limits<Value>::min());
    if (fits) { value = json.get<Value>(); }
    return fits;
  } else {
    if (json.is_number()) { value = json.get<Value>(); }
    return json.is_number();
  }
}

}  // namespace detail

/// Sets every field of `params` from `json`. Empty when all fields were there, of the right kind and in range, and no
/// others; else a sentence naming the first that was not.
template <class Params>
[[nodiscard]] std::string params_from_json(const nlohmann::ordered_json& json, Params& params) {
  if (!json.is_object()) { return "expected parameters, found " + json.dump(); }
  std::string complaint;
  std::size_t fields = 0;
  visit_fields(params, [&](auto& value, const Field& field) {
    ++fields;
    const auto found = json.find(std::string(field.name));
    if (!complaint.empty()) { return; }
    if (found == json.end()) {
      complaint = "expected the parameter " + std::string(field.name) + ", found none";
    } else if (!detail::read_value(*found, value)) {
      complaint = "expected a value of " + std::string(field.name) + ", found " + found->dump();
    }
  });
  if (complaint.empty() && json.size() != fields) {
    complaint = "expected " + std::to_string(fields) + " parameters, found " + std::to_string(json.size());
  }
  return complaint.empty() ? out_of_range(params) : complaint;
}

}  // namespace flirt
