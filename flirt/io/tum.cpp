#include "flirt/io/tum.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace flirt {
namespace {

Result<StampedPose> parse_line(std::string_view line) {
  Words words(line);
  std::array<double, 8> fields{};
  for (double& field : fields) {
    const std::string_view word = words.next();
    const auto number = number_from<double>(word);
    if (!number || !std::isfinite(*number)) { return fail("expected 8 finite numbers, found " + in_quotes(word)); }
    field = *number;
  }
  if (!words.rest().empty()) { return fail("expected 8 numbers, found more: " + in_quotes(words.rest())); }
  const auto [stamp, x, y, z, qx, qy, qz, qw] = fields;
  const double length = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
  if (std::abs(length - 1.0) > 0.01) {
    return fail("expected a quaternion of length 1, found one of length " + std::to_string(length));
  }
  if (std::hypot(x, y) > farthest_pose) {
    return fail("expected a place within 10 000 km of the origin, found one farther away");
  }
  const double heading = std::atan2(2 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz);
  return StampedPose{stamp, {x, y, wrap_angle(heading)}};
}

/// With six decimals or more, as the stamps of logs have.
void append_stamp(std::string& text, double stamp) {
  constexpr std::size_t decimals = 6;
  std::string number;
  append_number(number, stamp);
  if (number.find_first_not_of("-.0123456789") == std::string::npos) {  // no exponent
    if (number.find('.') == std::string::npos) { number += '.'; }
    const std::size_t found = number.size() - number.find('.') - 1;
    number.append(decimals - std::min(found, decimals), '0');
  }
  text += number;
}

}  // namespace

std::string to_tum(std::span<const StampedPose> trajectory) {
  std::string text;
  for (const auto& [stamp, pose] : trajectory) {
    append_stamp(text, stamp);
    for (const double number : {pose.x, pose.y, 0.0, 0.0, 0.0, std::sin(pose.theta / 2), std::cos(pose.theta / 2)}) {
      text += ' ';
      append_number(text, number);
    }
    text += '\n';
  }
  return text;
}

Result<void> write_tum(const std::filesystem::path& path, std::span<const StampedPose> trajectory) {
  return write_file_atomically(path, to_tum(trajectory));
}

Result<std::vector<StampedPose>> read_tum(const std::filesystem::path& path) {
  auto lines = LineReader::open(path);
  if (!lines) { return tl::unexpected(lines.error()); }
  std::vector<StampedPose> trajectory;
  while (true) {
    const auto line = lines->next();
    if (!line) { return tl::unexpected(line.error()); }
    if (!*line) { return trajectory; }
    const std::string_view text = Words((*line)->text).rest();
    if (text.empty() || text.starts_with('#')) { continue; }
    const auto pose = parse_line(text);
    if (!pose) { return fail(lines->name() + ':' + std::to_string((*line)->number) + ": " + pose.error().message); }
    trajectory.push_back(*pose);
  }
}

}  // namespace flirt
