#include "apps/flirt/param_flags.hpp"

#include "flirt/io/file.hpp"

#include "apps/flirt/command.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace flirt::app {
namespace {

std::string number_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// The value of a TOML node in the form in which a flag would give it; a string stays in its quotes where it is none.
std::string node_text(const toml::node& node, const ParamField& field) {
  if (const auto* text = node.as_string(); text != nullptr && field.get().is_string()) { return text->get(); }
  if (const auto* number = node.as_integer()) { return std::to_string(number->get()); }  // 0x10 is 16
  std::ostringstream out;
  node.visit([&out](const auto& value) { out << value; });
  return out.str();
}

std::string location(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line) + ": ";
}

toml::table parse_file(const std::string& file) {
  const std::string text = value_or_quit(read_file(file));
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw BadInput(location(file, error.source()) + std::string(error.description()));
  }
}

}  // namespace

std::string kebab_case(std::string_view name) {
  std::string result(name);
  std::replace(result.begin(), result.end(), '_', '-');
  return result;
}

namespace detail {

void reject(const ParamField& field, const std::string& expected, const std::string& found) {
  throw UsageError(field.flag + ": expected " + expected + ", found '" + found + "'");
}

std::string describe_range(const Field& field) {
  const bool has_min = std::isfinite(field.min);
  const bool has_max = std::isfinite(field.max);
  if (has_min && has_max) { return ", " + number_text(field.min) + " to " + number_text(field.max); }
  if (has_min) { return ", at least " + number_text(field.min); }
  if (has_max) { return ", at most " + number_text(field.max); }
  return "";
}

double parse_number(const ParamField& field, const std::string& text, const Field& range) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) { reject(field, "a number", text); }
  if (!(value >= range.min && value <= range.max)) { reject(field, "a number in range" + describe_range(range), text); }
  return value;
}

std::uint64_t parse_unsigned(const ParamField& field, const std::string& text, const Field& range) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) { reject(field, "a whole number of 0 or more", text); }
  if (const auto number = static_cast<double>(value); number < range.min || number > range.max) {
    reject(field, "a whole number in range" + describe_range(range), text);
  }
  return value;
}

bool parse_switch(const ParamField& field, const std::string& text) {
  if (text == "true") { return true; }
  if (text == "false") { return false; }
  reject(field, "true or false", text);
}

}  // namespace detail

void ParamFlags::bind(CLI::App& command, const std::shared_ptr<ParamField>& field, const std::string& help) {
  fields_.push_back(field);
  command
      .add_option_function<std::string>(
          field->flag, [field](const std::string& text) { field->flag_text = text; }, help)
      ->group(field->group + " parameters");
}

void ParamFlags::resolve(const Session& session, std::initializer_list<std::string_view> seeded) const {
  if (const std::string& config = session.config; !config.empty()) {
    const toml::table parsed = parse_file(config);
    for (const auto& [group, node] : parsed) {
      const auto* table = node.as_table();
      if (table == nullptr) {
        throw BadInput(location(config, node.source()) + "expected a table like [ransac], found the key '" +
                       std::string(group.str()) + "'");
      }
      if (std::ranges::find(fields_, group.str(), &ParamField::group) == fields_.end()) {
        throw BadInput(location(config, node.source()) + "expected parameters of this command, found the table [" +
                       std::string(group.str()) + "]");
      }
      for (const auto& [key, value] : *table) {
        const auto match = std::find_if(fields_.begin(), fields_.end(), [&](const auto& field) {
          return field->group == group.str() && field->name == key.str();
        });
        if (match == fields_.end()) {
          throw BadInput(location(config, value.source()) + "expected a parameter of this command, found '" +
                         std::string(group.str()) + "." + std::string(key.str()) + "'");
        }
        (*match)->file_location = location(config, value.source());
        try {
          (*match)->set(node_text(value, **match));
        } catch (const UsageError& error) { throw BadInput((*match)->file_location + error.what()); }
      }
    }
  }
  for (const auto& field : fields_) {
    const bool is_seeded = field->name == "seed" && std::ranges::find(seeded, field->group) != seeded.end();
    if (is_seeded && session.is_seed_given) { field->set(std::to_string(session.seed)); }
    if (field->flag_text) { field->set(*field->flag_text); }
  }
}

void ParamFlags::expect_none(std::string_view group, const std::string& needed) const {
  for (const auto& field : fields_) {
    if (field->group != group) { continue; }
    const std::string message = field->flag + ": expected only with " + needed;
    if (field->flag_text) { throw UsageError(message); }
    if (!field->file_location.empty()) { throw BadInput(field->file_location + message); }
  }
}

nlohmann::ordered_json ParamFlags::json() const {
  nlohmann::ordered_json result = nlohmann::ordered_json::object();
  for (const auto& field : fields_) { result[field->group][field->name] = field->get(); }
  return result;
}

}  // namespace flirt::app
