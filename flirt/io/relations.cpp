#include "flirt/io/relations.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/text.hpp"

#include <array>
#include <cmath>
#include <string>

namespace flirt {
namespace {

Result<Relation> parse_line(std::string_view line) {
  Words words(line);
  std::array<double, 8> fields{};
  for (double& field : fields) {
    const std::string_view word = words.next();
    const auto number = number_from<double>(word);
    if (!number || !std::isfinite(*number)) { return fail("expected 8 finite numbers, found " + in_quotes(word)); }
    field = *number;
  }
  if (!words.rest().empty()) { return fail("expected 8 numbers, found more: " + in_quotes(words.rest())); }
  if (std::hypot(fields[2], fields[3]) > farthest_pose) {
    return fail("expected a motion of less than 10 000 km, found more");
  }
  return Relation{fields[0], fields[1], {fields[2], fields[3], wrap_angle(fields[7])}};
}

}  // namespace

Result<std::vector<Relation>> read_relations(const std::filesystem::path& path) {
  auto lines = LineReader::open(path);
  if (!lines) { return tl::unexpected(lines.error()); }
  std::vector<Relation> relations;
  while (true) {
    const auto line = lines->next();
    if (!line) { return tl::unexpected(line.error()); }
    if (!*line) { return relations; }
    const std::string_view text = Words((*line)->text).rest();
    if (text.empty() || text.starts_with('#')) { continue; }
    const auto relation = parse_line(text);
    if (!relation) {
      return fail(lines->name() + ':' + std::to_string((*line)->number) + ": " + relation.error().message);
    }
    relations.push_back(*relation);
  }
}

}  // namespace flirt
