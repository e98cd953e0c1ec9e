// flirt/io/text.hpp: words and numbers of a line of text, without copies and independent of the locale.
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace flirt {

/// The words of a text between spaces and tabs, one after the other.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  /// The next word; empty at the end.
  std::string_view next() {
    skip_spaces();
    std::size_t length = 0;
    while (length < rest_.size() && !is_space(rest_[length])) { ++length; }
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }
  /// What follows the last word handed out.
  [[nodiscard]] std::string_view rest() {
    skip_spaces();
    return rest_;
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t'; }
  void skip_spaces() {
    while (!rest_.empty() && is_space(rest_.front())) { rest_.remove_prefix(1); }
  }
  std::string_view rest_;
};

/// The number that the whole word spells, or nothing. Accepts a leading +, and inf and nan for floating point.
template <class Number>
  requires std::integral<Number> || std::floating_point<Number>
[[nodiscard]] std::optional<Number> number_from(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') { word.remove_prefix(1); }
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc{} || end != word.data() + word.size() || word.empty()) { return std::nullopt; }
  return number;
}

/// Appends the shortest text that reads back as the same number.
template <class Number>
  requires std::integral<Number> || std::floating_point<Number>
void append_number(std::string& text, Number number) {
  std::array<char, 40> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  text.append(buffer.data(), result.ptr);
}

/// That text alone, for messages.
[[nodiscard]] inline std::string number_text(double number) {
  std::string text;
  append_number(text, number);
  return text;
}

/// How far a pose in a file may lie from the origin, m: a quarter of the way around the earth. Farther ones are broken,
/// and would not fit the grids.
inline constexpr double farthest_pose = 1e7;

/// A word as it stands in a message: in quotes, cut when long, without control characters.
[[nodiscard]] inline std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 40;
  if (word.empty()) { return "the end of the line"; }
  std::string text("'");
  for (const char c : word.substr(0, longest)) { text += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c; }
  return text + (word.size() > longest ? "...'" : "'");
}

}  // namespace flirt
