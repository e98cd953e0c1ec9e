#include "flirt/io/pgm.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/io/text.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace flirt {
namespace {

/// Header words of a PGM: separated by white space, with comments from # to the end of the line.
class Header {
 public:
  explicit Header(std::string_view bytes) : rest_(bytes) {}

  std::string_view word() {
    while (!rest_.empty() && (is_space(rest_.front()) || rest_.front() == '#')) {
      if (rest_.front() == '#') { rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size() - 1)); }
      rest_.remove_prefix(1);
    }
    std::size_t length = 0;
    while (length < rest_.size() && !is_space(rest_[length]) && rest_[length] != '#') { ++length; }
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }
  std::optional<std::size_t> number() { return number_from<std::size_t>(word()); }
  /// What follows the single white space after the last header word.
  [[nodiscard]] std::string_view body() const { return rest_.empty() ? rest_ : rest_.substr(1); }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }
  std::string_view rest_;
};

std::uint8_t scaled(std::size_t value, std::size_t most) {
  return static_cast<std::uint8_t>((value * 255 + most / 2) / most);
}

/// The pixels of a binary file; nothing when they are cut short or too large.
bool read_binary(std::string_view body, std::size_t most, GreyImage& image) {
  const std::size_t bytes_per_pixel = most < 256 ? 1 : 2;
  const std::size_t n = image.width * image.height;
  if (body.size() < n * bytes_per_pixel) { return false; }
  image.pixels.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t value = 0;
    for (std::size_t k = 0; k < bytes_per_pixel; ++k) {
      value = value * 256 + static_cast<unsigned char>(body[i * bytes_per_pixel + k]);
    }
    if (value > most) { return false; }
    image.pixels.push_back(scaled(value, most));
  }
  return true;
}

bool read_text(Header& header, std::size_t most, GreyImage& image) {
  const std::size_t n = image.width * image.height;
  if (header.body().size() + 2 < 2 * n) { return false; }  // a digit and a space a pixel
  image.pixels.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto value = header.number();
    if (!value || *value > most) { return false; }
    image.pixels.push_back(scaled(*value, most));
  }
  return true;
}

}  // namespace

std::string encode_pgm(const GreyImage& image) {
  FLIRT_ASSERT(image.pixels.size() == image.width * image.height);
  std::string bytes = "P5\n" + std::to_string(image.width) + ' ' + std::to_string(image.height) + "\n255\n";
  bytes.append(image.pixels.begin(), image.pixels.end());
  return bytes;
}

Result<GreyImage> decode_pgm(std::string_view bytes, std::string_view name) {
  const std::string where = std::string(name) + ": expected a PGM image, found ";
  Header header(bytes);
  const std::string_view magic = header.word();
  if (magic != "P2" && magic != "P5") { return fail(where + "one that begins with " + in_quotes(magic)); }
  const auto width = header.number();
  const auto height = header.number();
  const auto most = header.number();
  if (!width || !height || !most) { return fail(where + "one without width, height and largest value"); }
  const bool is_good_size = *width > 0 && *height > 0 && *width <= most_pixels && *height <= most_pixels / *width;
  if (!is_good_size || *most == 0 || *most > 65535) {
    return fail(where + std::to_string(*width) + " x " + std::to_string(*height) + " pixels up to " +
                std::to_string(*most));
  }
  GreyImage image{.width = *width, .height = *height};
  const bool good = magic == "P5" ? read_binary(header.body(), *most, image) : read_text(header, *most, image);
  if (!good) { return fail(where + "one that is cut short or has values above " + std::to_string(*most)); }
  return image;
}

}  // namespace flirt
