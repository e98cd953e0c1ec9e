#include "flirt/io/segments.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/text.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace flirt {
namespace {

/// The one word of a text without the spaces around it; empty when there are none or several.
std::string_view only_word(std::string_view text) {
  Words words(text);
  const std::string_view word = words.next();
  return words.rest().empty() ? word : std::string_view{};
}

std::optional<PlanSegment> segment_from(std::string_view line) {
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t comma = line.find(',');
    if ((comma == std::string_view::npos) != (i + 1 == numbers.size())) { return std::nullopt; }
    const std::optional<double> number = number_from<double>(only_word(line.substr(0, comma)));
    if (!number || !std::isfinite(*number)) { return std::nullopt; }
    numbers[i] = *number;
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  }
  return PlanSegment{{numbers[0], numbers[1]}, {numbers[2], numbers[3]}, Material::solid};
}

}  // namespace

Result<FloorPlan> read_segments(const std::filesystem::path& path) {
  Result<LineReader> lines = LineReader::open(path);
  if (!lines) { return tl::unexpected(lines.error()); }
  FloorPlan plan;
  while (true) {
    const Result<std::optional<Line>> line = lines->next();
    if (!line) { return tl::unexpected(line.error()); }
    if (!line->has_value()) { break; }
    const std::string_view text = (*line)->text;
    const std::string_view first_word = Words(text).next();
    if (first_word.empty() || first_word.starts_with('#')) { continue; }
    const std::optional<PlanSegment> segment = segment_from(text);
    if (!segment) {
      return fail(lines->name() + ":" + std::to_string((*line)->number) +
                  ": expected a segment as x1,y1,x2,y2, found " + in_quotes(text));
    }
    plan.segments.push_back(*segment);
  }
  if (plan.segments.empty()) {
    return fail(lines->name() + ": expected segments as x1,y1,x2,y2, one a line, found none");
  }
  return plan;
}

}  // namespace flirt
