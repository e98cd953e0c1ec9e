#include "flirt/io/carmen_lines.hpp"

#include "flirt/io/log_oddities.hpp"
#include "flirt/io/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace flirt::carmen {
namespace {

constexpr double farthest_laser = 1000;    // m, from its robot
constexpr std::size_t most_beams = 20000;  // memory of smoothing a scan grows with their square

/// Reads one field after the other; keeps the first complaint and then answers zeros.
class FieldReader {
 public:
  explicit FieldReader(std::string_view fields) : words_(fields) {}

  double number(std::string_view name) {
    const std::string_view word = words_.next();
    const auto value = number_from<double>(word);
    if (!value) { complain("a number for ", name, word); }
    return value.value_or(0.0);
  }
  double finite(std::string_view name) {
    const std::string_view word = words_.next();
    const auto value = number_from<double>(word);
    if (!value || !std::isfinite(*value)) {
      complain("a finite number for ", name, word);
      return 0.0;
    }
    return *value;
  }
  /// How many fields follow; never more than the line can hold.
  std::size_t count(std::string_view name) {
    const std::string_view word = words_.next();
    const auto value = number_from<std::uint64_t>(word);
    if (!value) {
      complain("a count for ", name, word);
      return 0;
    }
    const std::size_t most = (words_.rest().size() + 1) / 2;  // a field and a space are two characters
    if (*value > most && complaint_.empty()) {
      complaint_ = "expected " + std::string(word) + ' ' + std::string(name) + ", found at most " +
                   std::to_string(most) + " fields in the line";
    }
    if (*value > most_beams && complaint_.empty()) {
      complaint_ =
          "expected up to " + std::to_string(most_beams) + ' ' + std::string(name) + ", found " + std::string(word);
    }
    return complaint_.empty() ? static_cast<std::size_t>(*value) : 0;
  }
  Pose2 pose(std::string_view name) {
    const std::string_view words = words_.rest();
    const double x = finite(name);
    const double y = finite(name);
    if (std::hypot(x, y) > farthest_pose) { complain("a place within 10 000 km for ", name, words); }
    return {x, y, wrap_angle(finite(name))};
  }
  std::string_view word(std::string_view name) {
    const std::string_view word = words_.next();
    if (word.empty()) { complain("a word for ", name, word); }
    return word;
  }
  void skip_numbers(std::size_t n, std::string_view name) {
    for (std::size_t i = 0; i < n && complaint_.empty(); ++i) { number(name); }
  }
  void expect_end() {
    const std::string_view rest = words_.rest();
    if (!rest.empty()) { complain("the end of the line after ", "the logger stamp", rest); }
  }
  void complain(std::string_view what, std::string_view name, std::string_view found) {
    if (complaint_.empty()) {
      complaint_ = "expected " + std::string(what) + std::string(name) + ", found " + in_quotes(found);
    }
  }
  /// A whole sentence, or nothing.
  void complain(std::string sentence) {
    if (complaint_.empty()) { complaint_ = std::move(sentence); }
  }
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

 private:
  Words words_;
  std::string complaint_{};
};

/// Significant digits as written: 1071078718.46 has 12, 1.07108e+09 has 6.
int significant_digits(std::string_view number) {
  int digits = 0;
  for (const char c : number) {
    if (c == 'e' || c == 'E') { break; }
    const bool is_digit = c >= '0' && c <= '9';
    if (is_digit && (digits > 0 || c != '0')) { ++digits; }
  }
  return digits;
}

std::vector<double> read_ranges(FieldReader& fields) {
  const std::size_t n = fields.count("ranges");
  std::vector<double> ranges(n);
  for (double& range : ranges) { range = fields.number("a range"); }
  return ranges;
}

/// Reads "stamp host logger_stamp" and the end of the line.
void read_stamp(FieldReader& fields, ScanLine& line) {
  const std::string_view word = fields.word("the stamp");
  const auto stamp = number_from<double>(word);
  if (!stamp || !std::isfinite(*stamp)) { fields.complain("a finite number for ", "the stamp", word); }
  if (stamp && std::abs(*stamp) > 1e12) { fields.complain("at most 1e12 s for ", "the stamp", word); }
  line.stamp = stamp.value_or(0.0);
  line.stamp_digits = significant_digits(word);
  fields.word("the host");
  fields.number("the logger stamp");
  fields.expect_end();
}

/// Reads the head that ROBOTLASER and RAWLASER share, the ranges and the remissions.
void read_configured_ranges(FieldReader& fields, ScanLine& line) {
  fields.number("the laser type");
  line.beams.angle_min = fields.finite("the start angle");
  fields.number("the field of view");
  line.beams.angle_step = fields.finite("the angular step");
  const double declared_max = fields.number("the longest range");
  line.beams.range_max =
      declared_max > 0 && std::isfinite(declared_max) ? declared_max : 0.0;  // nonsense: not declared
  fields.number("the accuracy");
  fields.number("the remission mode");
  line.ranges = read_ranges(fields);
  fields.complain(wrong_angles(line.beams, line.ranges.size()));
  fields.skip_numbers(fields.count("remissions"), "a remission");
}

Result<StampedPose> parse_pose_line(std::string_view text, std::string_view skipped) {
  FieldReader fields(text);
  StampedPose result;
  result.pose = fields.pose("the pose");
  fields.skip_numbers(3, skipped);
  result.stamp = fields.finite("the stamp");
  fields.word("the host");
  fields.number("the logger stamp");
  fields.expect_end();
  if (!fields.complaint().empty()) { return fail(fields.complaint()); }
  return result;
}

/// "ROBOTLASER" followed by a number.
bool is_numbered(std::string_view kind, std::string_view stem) {
  if (!kind.starts_with(stem) || kind.size() == stem.size()) { return false; }
  kind.remove_prefix(stem.size());
  return std::all_of(kind.begin(), kind.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::optional<Layout> layout_of(std::string_view kind) {
  if (kind == "FLASER" || kind == "RLASER") { return Layout::flaser; }
  if (is_numbered(kind, "ROBOTLASER")) { return Layout::robotlaser; }
  if (is_numbered(kind, "RAWLASER")) { return Layout::rawlaser; }
  return std::nullopt;
}

Result<ScanLine> parse_scan(std::string_view text, Layout layout) {
  FieldReader fields(text);
  ScanLine line;
  if (layout == Layout::flaser) {
    line.ranges = read_ranges(fields);
    line.beams = beams_without_angles(line.ranges.size());
    line.first_pose = fields.pose("the pose");
    line.second_pose = fields.pose("the odometry");
  } else {
    read_configured_ranges(fields, line);
    if (layout == Layout::robotlaser) {
      line.first_pose = fields.pose("the laser's pose");
      line.second_pose = fields.pose("the robot's pose");
      if (const double apart = distance(*line.first_pose, *line.second_pose); apart > farthest_laser) {
        fields.complain("the laser within 1 km of ", "the robot", std::to_string(apart) + " m");
      }
      fields.skip_numbers(5, "a velocity or safety distance");
    }
  }
  read_stamp(fields, line);
  if (!fields.complaint().empty()) { return fail(fields.complaint()); }
  return line;
}

Result<StampedPose> parse_odometry(std::string_view text) {
  return parse_pose_line(text, "a velocity");
}

Result<StampedPose> parse_true_pose(std::string_view text) {
  return parse_pose_line(text, "the odometry");
}

Beams beams_without_angles(std::size_t n) {
  struct Scanner {
    std::size_t beams;
    double first;  ///< degrees
    double step;   ///< degrees
  };
  constexpr std::array<Scanner, 4> scanners{
      {{401, -50, 0.25}, {541, -135, 0.5}, {682, -681 * 180.0 / 1024, 360.0 / 1024}, {1081, -135, 0.25}}};
  for (const Scanner& scanner : scanners) {
    if (scanner.beams == n) { return {radians_from_degrees(scanner.first), radians_from_degrees(scanner.step), 0, 0}; }
  }
  if (n < 2) { return {}; }  // a single beam points ahead
  const std::size_t steps = n % 2 == 0 ? n : n - 1;
  return {radians_from_degrees(-90), radians_from_degrees(180.0 / static_cast<double>(steps)), 0, 0};
}

}  // namespace flirt::carmen
