#include "flirt/io/png.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/io/pgm.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <new>
#include <vector>

namespace flirt {
namespace {

constexpr unsigned unknown_grey = 205;

/// All that a decoding touches. libpng leaves a failing call by longjmp, so nothing with a destructor may live in the
/// function that calls it: it lives here.
struct Decoder {
  std::string_view rest;  ///< bytes not yet read
  std::string complaint{};
  GreyImage image{};
  std::vector<std::uint8_t> rgba{};  ///< the whole image, four bytes a pixel
  std::vector<png_bytep> rows{};
};

void read_bytes(png_structp png, png_bytep target, std::size_t n) {
  auto& decoder = *static_cast<Decoder*>(png_get_io_ptr(png));
  if (decoder.rest.size() < n) { png_error(png, "cut short"); }
  std::memcpy(target, decoder.rest.data(), n);
  decoder.rest.remove_prefix(n);
}

void keep_complaint(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

void ignore_warning(png_structp /*png*/, png_const_charp /*message*/) {}

/// Asks libpng for 8-bit RGBA, whatever the file holds.
void request_rgba(png_structp png, png_infop info) {
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xFF, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

void allocate(Decoder& decoder, std::size_t width, std::size_t height) {
  decoder.image.width = width;
  decoder.image.height = height;
  decoder.rgba.resize(4 * width * height);
  for (std::size_t row = 0; row < height; ++row) { decoder.rows.push_back(&decoder.rgba[4 * width * row]); }
}

/// Calls libpng; every failure inside comes back to the setjmp.
bool decode_rows(Decoder& decoder, png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) { return false; }  // NOLINT(cert-err52-cpp): libpng's only way to report
  png_set_read_fn(png, &decoder, read_bytes);
  png_read_info(png, info);
  const std::size_t width = png_get_image_width(png, info);
  const std::size_t height = png_get_image_height(png, info);
  if (width * height > most_pixels) { png_error(png, "more than 2^28 pixels"); }
  request_rgba(png, info);
  allocate(decoder, width, height);
  png_read_image(png, decoder.rows.data());
  png_read_end(png, nullptr);
  return true;
}

std::uint8_t grey(const std::uint8_t* rgba) {
  const unsigned mean = (unsigned{rgba[0]} + rgba[1] + rgba[2]) / 3;
  const unsigned alpha = rgba[3];
  return static_cast<std::uint8_t>((mean * alpha + unknown_grey * (255 - alpha) + 127) / 255);
}

void append_bytes(png_structp png, png_bytep bytes, std::size_t n) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), n);
}

void flush_nothing(png_structp /*png*/) {}

/// Calls libpng; every failure inside comes back to the setjmp.
bool encode_rows(const GreyImage& image, std::string& bytes, png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) { return false; }  // NOLINT(cert-err52-cpp): libpng's only way to report
  png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_write_fn(png, &bytes, append_bytes, flush_nothing);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (std::size_t row = 0; row < image.height; ++row) { png_write_row(png, &image.pixels[row * image.width]); }
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::string encode_png(const GreyImage& image) {
  FLIRT_ASSERT(!image.pixels.empty());
  FLIRT_ASSERT(image.pixels.size() == image.width * image.height);
  std::string bytes;
  std::string complaint;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &complaint, keep_complaint, ignore_warning);
  png_infop info = png_create_info_struct(png);
  const bool good = encode_rows(image, bytes, png, info);
  png_destroy_write_struct(&png, &info);
  if (!good) { throw std::bad_alloc(); }  // nothing else is left to fail
  return bytes;
}

Result<GreyImage> decode_png(std::string_view bytes, std::string_view name) {
  const std::string where = std::string(name) + ": expected a PNG image, found ";
  Decoder decoder{.rest = bytes};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoder.complaint, keep_complaint, ignore_warning);
  png_infop info = png_create_info_struct(png);
  const bool good = decode_rows(decoder, png, info);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!good) { return fail(where + "one that is broken: " + decoder.complaint); }
  GreyImage image = std::move(decoder.image);
  image.pixels.resize(image.width * image.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) { image.pixels[i] = grey(&decoder.rgba[4 * i]); }
  return image;
}

}  // namespace flirt
