// apps/flirt/param_flags.hpp: flags, TOML keys and JSON of any parameter struct, all from its visit_fields.
#pragma once

#include "flirt/core/fields.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flirt::app {

struct Session;

/// One field of one struct, type-erased.
struct ParamField {
  std::string group;  ///< TOML table and flag prefix, kebab-case
  std::string name;   ///< field, snake_case
  std::string flag;   ///< with its dashes
  std::optional<std::string> flag_text;
  std::string file_location;                         ///< "FILE:LINE: " where the configuration file has a value
  std::function<void(const std::string& text)> set;  ///< throws UsageError when text is no such value or out of range
  std::function<nlohmann::ordered_json()> get;
};

enum class FlagNames : std::uint8_t {
  of_group,  ///< --GROUP-FIELD
  plain,     ///< --FIELD
};

/// Parameter structs bound to flags and to keys `field` of the TOML table `[group]`.
class ParamFlags {
 public:
  /// `params` must outlive this object's `resolve`. Fields named in `without` are the command's own affair.
  template <class Params>
  void add(CLI::App& command, const std::string& group, Params& params,
           std::initializer_list<std::string_view> without = {}, FlagNames names = FlagNames::of_group);

  /// Defaults < file < --seed < flags. Call once after parsing. Unknown keys of the file are an error, so that a typing
  /// mistake does not silently do nothing; the top-level tables of other groups are errors, too. `seeded`: groups whose
  /// field `seed` follows --seed.
  void resolve(const Session& session, std::initializer_list<std::string_view> seeded = {}) const;

  /// Refuses values for a group that would have no effect, given by flag (UsageError) or file (BadInput). `needed`:
  /// what they are for. After `resolve`.
  void expect_none(std::string_view group, const std::string& needed) const;

  /// {group: {field: value}} as resolved.
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  void bind(CLI::App& command, const std::shared_ptr<ParamField>& field, const std::string& help);
  std::vector<std::shared_ptr<ParamField>> fields_;
};

/// A value as a person would type it.
inline std::string default_text(const nlohmann::ordered_json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// "inlier_distance" → "inlier-distance".
std::string kebab_case(std::string_view name);

namespace detail {
double parse_number(const ParamField& field, const std::string& text, const Field& range);
std::uint64_t parse_unsigned(const ParamField& field, const std::string& text, const Field& range);
bool parse_switch(const ParamField& field, const std::string& text);
[[noreturn]] void reject(const ParamField& field, const std::string& expected, const std::string& found);
std::string describe_range(const Field& field);

template <class Value>
nlohmann::ordered_json json_of(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return std::string(to_string(value));
  } else {
    return value;
  }
}

template <class Value>
Value parse(const ParamField& field, const std::string& text, const Field& range) {
  if constexpr (std::is_enum_v<Value>) {
    std::string allowed;
    for (const auto& [value, name] : enum_names(Value{})) {
      if (name == text) { return value; }
      allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    }
    reject(field, "one of " + allowed, text);
  } else if constexpr (std::is_same_v<Value, bool>) {
    return parse_switch(field, text);
  } else if constexpr (std::is_unsigned_v<Value>) {
    const std::uint64_t number = parse_unsigned(field, text, range);
    if (number > std::numeric_limits<Value>::max()) { reject(field, "a smaller number", text); }
    return static_cast<Value>(number);
  } else {
    const double number = parse_number(field, text, range);
    const auto value = static_cast<Value>(number);
    if (std::is_integral_v<Value> && static_cast<double>(value) != number) { reject(field, "a whole number", text); }
    return value;
  }
}
}  // namespace detail

template <class Params>
void ParamFlags::add(CLI::App& command, const std::string& group, Params& params,
                     std::initializer_list<std::string_view> without, FlagNames names) {
  visit_fields(params, [&](auto& value, const Field& description) {
    if (std::ranges::find(without, description.name) != without.end()) { return; }
    using Value = std::decay_t<decltype(value)>;
    auto field = std::make_shared<ParamField>();
    field->group = group;
    field->name = std::string(description.name);
    field->flag = (names == FlagNames::plain ? "--" : "--" + group + "-") + kebab_case(field->name);
    field->set = [&value, description, raw = field.get()](const std::string& text) {
      value = detail::parse<Value>(*raw, text, description);
    };
    field->get = [&value] { return detail::json_of(value); };
    std::string help(description.help);
    if (!description.unit.empty() && description.unit != "1") { help += " [" + std::string(description.unit) + "]"; }
    help += detail::describe_range(description);
    if constexpr (std::is_enum_v<Value>) {
      help += " (";
      for (const auto& [candidate, name] : enum_names(Value{})) { help += std::string(name) + " "; }
      help.back() = ')';
    }
    bind(command, field, help + " (default " + default_text(detail::json_of(value)) + ")");
  });
}

}  // namespace flirt::app
