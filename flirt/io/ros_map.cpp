#include "flirt/io/ros_map.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/pgm.hpp"
#include "flirt/io/png.hpp"
#include "flirt/io/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace flirt {
namespace {

// --- The part of YAML that grid maps use: `key: value`, lists [a, b] or lines `- a`, comments, quotes ----------------

struct Entry {
  std::string value{};
  std::size_t line{0};
};
using Entries = std::map<std::string, Entry, std::less<>>;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view spaces = " \t\r";
  const std::size_t begin = text.find_first_not_of(spaces);
  if (begin == std::string_view::npos) { return {}; }
  return text.substr(begin, text.find_last_not_of(spaces) - begin + 1);
}

/// The line without its comment: a # at the start or after a space, outside quotes.
std::string_view without_comment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) { quote = 0; }
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) {
      return line.substr(0, i);
    }
  }
  return line;
}

std::string_view without_quotes(std::string_view value) {
  const bool is_quoted =
      value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.front() == value.back();
  return is_quoted ? value.substr(1, value.size() - 2) : value;
}

Error at(std::string_view name, std::size_t line, const std::string& expected, std::string_view found) {
  const std::string place = line == 0 ? std::string(name) : std::string(name) + ':' + std::to_string(line);
  return {place + ": expected " + expected + ", found " + (found.empty() ? "nothing" : in_quotes(found))};
}

/// Takes one line into the entries; `- a` lines are gathered as a list in the entry before.
Result<void> take_line(std::string_view line, std::size_t number, std::string_view name, Entries& entries,
                       Entry*& last) {
  const std::string_view text = trimmed(without_comment(line));
  if (text.empty() || text == "---" || text == "..." || text.starts_with('%')) { return {}; }
  if (text.starts_with("- ")) {
    if (last == nullptr || !(last->value.empty() || last->value.starts_with(','))) {
      return tl::unexpected(at(name, number, "a line \"key: value\"", text));
    }
    last->value.append(",").append(trimmed(text.substr(2)));
    return {};
  }
  const std::size_t colon = text.find(':');
  const bool is_entry =
      colon != std::string_view::npos && colon > 0 && (colon + 1 == text.size() || text[colon + 1] == ' ');
  if (!is_entry) { return tl::unexpected(at(name, number, "a line \"key: value\"", text)); }
  const auto [place, is_new] = entries.try_emplace(std::string(trimmed(text.substr(0, colon))));
  if (!is_new) { return tl::unexpected(at(name, number, "each key once", place->first)); }
  place->second = {std::string(trimmed(text.substr(colon + 1))), number};
  last = &place->second;
  return {};
}

Result<Entries> parse_entries(std::string_view text, std::string_view name) {
  Entries entries;
  Entry* last = nullptr;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    if (auto good = take_line(text.substr(0, length), number, name, entries, last); !good) {
      return tl::unexpected(good.error());
    }
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return entries;
}

// --- From entries to metadata ----------------------------------------------------------------------------------------

/// Hands out values by key; keeps the first complaint.
class EntryReader {
 public:
  EntryReader(const Entries& entries, std::string_view name) : entries_(entries), name_(name) {}

  /// Nothing when the key is missing; that is a complaint when it is required.
  const Entry* find(std::string_view key, bool is_required) {
    const auto place = entries_.find(key);
    if (place != entries_.end()) { return &place->second; }
    if (is_required) { complain(0, "the key " + std::string(key), {}); }
    return nullptr;
  }
  double number(std::string_view key, double otherwise, double low, double high, bool is_required = false) {
    const Entry* const entry = find(key, is_required);
    if (entry == nullptr) { return otherwise; }
    const auto value = number_from<double>(without_quotes(entry->value));
    if (value && *value >= low && *value <= high) { return *value; }
    complain(entry->line, std::string(key) + " from " + std::to_string(low) + " to " + std::to_string(high),
             entry->value);
    return otherwise;
  }
  Pose2 pose(std::string_view key) {
    const Entry* const entry = find(key, true);
    if (entry == nullptr) { return {}; }
    std::vector<double> numbers;
    for (std::string_view rest = list_body(entry->value); !rest.empty();) {
      const std::size_t length = std::min(rest.find(','), rest.size());
      numbers.push_back(number_from<double>(trimmed(rest.substr(0, length))).value_or(std::nan("")));
      rest.remove_prefix(std::min(length + 1, rest.size()));
    }
    const Pose2 pose =
        numbers.size() == 3 ? Pose2{numbers[0], numbers[1], wrap_angle(numbers[2])} : Pose2{std::nan("")};
    if (!is_finite(pose)) { complain(entry->line, std::string(key) + " as [x, y, yaw]", entry->value); }
    return pose;
  }
  bool truth(std::string_view key, bool otherwise) {
    const Entry* const entry = find(key, false);
    if (entry == nullptr) { return otherwise; }
    const std::string_view value = without_quotes(entry->value);
    if (value == "1" || value == "true" || value == "True") { return true; }
    if (value == "0" || value == "false" || value == "False") { return false; }
    complain(entry->line, std::string(key) + " as 0 or 1", value);
    return otherwise;
  }
  void complain(std::size_t line, const std::string& expected, std::string_view found) {
    if (!complaint_) { complaint_ = at(name_, line, expected, found); }
  }
  [[nodiscard]] const std::optional<Error>& complaint() const { return complaint_; }

 private:
  /// "[a, b]" and ",a,b" (gathered from `- a` lines) without what is around.
  static std::string_view list_body(std::string_view value) {
    if (value.starts_with(',')) { return value.substr(1); }
    const bool is_flow = value.size() >= 2 && value.front() == '[' && value.back() == ']';
    return is_flow ? value.substr(1, value.size() - 2) : std::string_view{};
  }
  const Entries& entries_;
  std::string_view name_;
  std::optional<Error> complaint_{};
};

constexpr std::array<std::pair<GridMapMode, std::string_view>, 3> modes{
    {{GridMapMode::trinary, "trinary"}, {GridMapMode::scale, "scale"}, {GridMapMode::raw, "raw"}}};

GridMapMode mode_of(EntryReader& reader) {
  const Entry* const entry = reader.find("mode", false);
  if (entry == nullptr) { return GridMapMode::trinary; }
  for (const auto& [mode, name] : modes) {
    if (without_quotes(entry->value) == name) { return mode; }
  }
  reader.complain(entry->line, "mode trinary, scale or raw", entry->value);
  return GridMapMode::trinary;
}

std::string_view name_of(GridMapMode mode) {
  for (const auto& [candidate, name] : modes) {
    if (candidate == mode) { return name; }
  }
  return {};
}

void append_entry(std::string& text, std::string_view key, double value) {
  text.append(key).append(": ");
  append_number(text, value);
  text += '\n';
}

}  // namespace

Result<GreyImage> read_grey_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) { return tl::unexpected(bytes.error()); }
  const std::string name = path.string();
  if (bytes->starts_with("P2") || bytes->starts_with("P5")) { return decode_pgm(*bytes, name); }
  if (bytes->starts_with("\x89PNG")) { return decode_png(*bytes, name); }
  return fail(name + ": expected a PGM (P2, P5) or PNG image, found another file");
}

Result<void> write_grey_image(const std::filesystem::path& path, const GreyImage& image) {
  return write_file_atomically(path, path.extension() == ".pgm" ? encode_pgm(image) : encode_png(image));
}

Result<GridMapMetadata> parse_grid_map_yaml(std::string_view text, std::string_view name) {
  const auto entries = parse_entries(text, name);
  if (!entries) { return tl::unexpected(entries.error()); }
  EntryReader reader(*entries, name);
  GridMapMetadata metadata;
  if (const Entry* const image = reader.find("image", true)) { metadata.image = without_quotes(image->value); }
  metadata.resolution = reader.number("resolution", metadata.resolution, 1e-6, 1e3, true);
  metadata.origin = reader.pose("origin");
  metadata.negate = reader.truth("negate", metadata.negate);
  metadata.occupied_thresh = reader.number("occupied_thresh", metadata.occupied_thresh, 0, 1);
  metadata.free_thresh = reader.number("free_thresh", metadata.free_thresh, 0, metadata.occupied_thresh);
  metadata.mode = mode_of(reader);
  if (reader.complaint()) { return tl::unexpected(*reader.complaint()); }
  if (metadata.image.empty()) {
    return tl::unexpected(at(name, entries->find("image")->second.line, "a file name", {}));
  }
  return metadata;
}

std::string grid_map_yaml(const GridMapMetadata& metadata) {
  std::string text = "image: " + metadata.image + '\n';
  append_entry(text, "resolution", metadata.resolution);
  text += "origin: [";
  append_number(text, metadata.origin.x);
  text += ", ";
  append_number(text, metadata.origin.y);
  text += ", ";
  append_number(text, metadata.origin.theta);
  text += "]\n";
  append_entry(text, "negate", metadata.negate ? 1 : 0);
  append_entry(text, "occupied_thresh", metadata.occupied_thresh);
  append_entry(text, "free_thresh", metadata.free_thresh);
  return text.append("mode: ").append(name_of(metadata.mode)).append("\n");
}

Result<GridMapImage> read_grid_map(const std::filesystem::path& yaml_path) {
  const auto text = read_file(yaml_path);
  if (!text) { return tl::unexpected(text.error()); }
  auto metadata = parse_grid_map_yaml(*text, yaml_path.string());
  if (!metadata) { return tl::unexpected(metadata.error()); }
  auto image = read_grey_image(yaml_path.parent_path() / metadata->image);
  if (!image) { return tl::unexpected(image.error()); }
  return GridMapImage{*std::move(image), *std::move(metadata)};
}

Result<void> write_grid_map(const std::filesystem::path& yaml_path, const GridMapImage& map) {
  return write_grey_image(yaml_path.parent_path() / map.metadata.image, map.image).and_then([&] {
    return write_file_atomically(yaml_path, grid_map_yaml(map.metadata));
  });
}

}  // namespace flirt
