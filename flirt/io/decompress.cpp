#include "flirt/io/decompress.hpp"

#include "flirt/io/text.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <string>
#include <utility>

namespace flirt {
namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{4} << 30U;
constexpr std::size_t first_bytes = std::size_t{1} << 20U;

enum class Outcome : std::uint8_t { more, end, damage };

struct Step {
  std::size_t consumed{0};
  std::size_t produced{0};
  Outcome outcome{Outcome::damage};
};

class Bz2 {
 public:
  static constexpr std::string_view name = "bz2";
  Bz2() : is_ready_(BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK) {}
  ~Bz2() { BZ2_bzDecompressEnd(&stream_); }
  /// For the next stream.
  void restart() {
    BZ2_bzDecompressEnd(&stream_);
    stream_ = {};
    is_ready_ = BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK;
  }
  Bz2(const Bz2&) = delete;
  Bz2& operator=(const Bz2&) = delete;

  Step step(std::span<const std::byte> input, std::span<std::byte> output) {
    if (!is_ready_) { return {}; }
    constexpr std::size_t most = std::size_t{1} << 30U;  // the library counts in 32 bits
    const auto in = static_cast<unsigned>(std::min(input.size(), most));
    const auto out = static_cast<unsigned>(std::min(output.size(), most));
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(input.data()));
    stream_.avail_in = in;
    stream_.next_out = reinterpret_cast<char*>(output.data());
    stream_.avail_out = out;
    const int code = BZ2_bzDecompress(&stream_);
    const Outcome outcome = code == BZ_STREAM_END ? Outcome::end : code == BZ_OK ? Outcome::more : Outcome::damage;
    return {in - stream_.avail_in, out - stream_.avail_out, outcome};
  }

 private:
  bz_stream stream_{};
  bool is_ready_;
};

class Lz4 {
 public:
  static constexpr std::string_view name = "lz4";
  Lz4() { LZ4F_createDecompressionContext(&context_, LZ4F_VERSION); }
  ~Lz4() { LZ4F_freeDecompressionContext(context_); }
  void restart() {}  // it goes on with the next frame by itself
  Lz4(const Lz4&) = delete;
  Lz4& operator=(const Lz4&) = delete;

  Step step(std::span<const std::byte> input, std::span<std::byte> output) {
    if (context_ == nullptr) { return {}; }
    std::size_t in = input.size();
    std::size_t out = output.size();
    const std::size_t hint = LZ4F_decompress(context_, output.data(), &out, input.data(), &in, nullptr);
    if (LZ4F_isError(hint) != 0) { return {}; }
    return {in, out, hint == 0 ? Outcome::end : Outcome::more};
  }

 private:
  LZ4F_dctx* context_{nullptr};
};

class Zstd {
 public:
  static constexpr std::string_view name = "zstd";
  Zstd() = default;
  ~Zstd() { ZSTD_freeDStream(stream_); }
  void restart() {}  // it goes on with the next frame by itself
  Zstd(const Zstd&) = delete;
  Zstd& operator=(const Zstd&) = delete;

  Step step(std::span<const std::byte> input, std::span<std::byte> output) {
    if (stream_ == nullptr) { return {}; }
    ZSTD_inBuffer in{input.data(), input.size(), 0};
    ZSTD_outBuffer out{output.data(), output.size(), 0};
    const std::size_t hint = ZSTD_decompressStream(stream_, &out, &in);
    if (ZSTD_isError(hint) != 0) { return {}; }
    return {in.pos, out.pos, hint == 0 ? Outcome::end : Outcome::more};
  }

 private:
  ZSTD_DStream* stream_{ZSTD_createDStream()};
};

template <class Decoder>
Result<Unpacked> decode(std::span<const std::byte> input, std::size_t expected_bytes) {
  const auto complaint = [expected_bytes](const std::string& found) {
    return fail(std::to_string(expected_bytes) + " bytes in " + std::string(Decoder::name) + " data, found " + found);
  };
  Decoder decoder;
  const std::size_t most = expected_bytes + 1;  // one more, to see that there is more
  std::vector<std::byte> output(std::min(most, first_bytes));
  std::size_t produced = 0;
  for (Outcome outcome = Outcome::more; outcome != Outcome::end || (produced < expected_bytes && !input.empty());) {
    if (outcome == Outcome::end) { decoder.restart(); }
    if (produced == output.size()) { output.resize(std::min(most, 2 * output.size())); }
    const Step step = decoder.step(input, std::span(output).subspan(produced));
    outcome = step.outcome;
    if (outcome == Outcome::damage) { return complaint("damage"); }
    input = input.subspan(step.consumed);
    produced += step.produced;
    if (produced > expected_bytes) { return complaint("more"); }
    const bool is_stuck = step.consumed == 0 && step.produced == 0;
    if (is_stuck && (outcome == Outcome::more || !input.empty())) { return complaint("data cut short"); }
  }
  if (produced != expected_bytes) { return complaint(std::to_string(produced)); }
  Unpacked unpacked{std::move(output), {}};
  unpacked.bytes = std::span(unpacked.memory).first(produced);
  return unpacked;
}

}  // namespace

Result<Unpacked> decompress(std::string_view compression, std::span<const std::byte> input,
                            std::uint64_t expected_bytes) {
  if (expected_bytes > most_bytes) {
    return fail("up to 4 GiB in a chunk, found " + std::to_string(expected_bytes) + " bytes announced");
  }
  const auto bytes = static_cast<std::size_t>(expected_bytes);
  if (compression == Bz2::name) { return decode<Bz2>(input, bytes); }
  if (compression == Lz4::name) { return decode<Lz4>(input, bytes); }
  if (compression == Zstd::name) { return decode<Zstd>(input, bytes); }
  if (!compression.empty() && compression != "none") {
    return fail("compression none, bz2, lz4 or zstd, found " + in_quotes(compression));
  }
  if (input.size() != bytes) {
    return fail(std::to_string(bytes) + " bytes in a chunk, found " + std::to_string(input.size()));
  }
  return Unpacked{{}, input};
}

}  // namespace flirt
