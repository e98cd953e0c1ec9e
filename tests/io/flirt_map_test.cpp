#include "flirt/io/flirt_map.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/io/file.hpp"
#include "flirt/map/localize.hpp"

#include "tests/support/map_examples.hpp"
#include "tests/support/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace flirt {
namespace {

using testing::HasSubstr;

// Where things are in the file, as its format says.
constexpr std::size_t header_bytes = 32;
constexpr std::size_t entry_bytes = 48;
constexpr std::size_t byte_order_at = 8;
constexpr std::size_t version_at = 12;
constexpr std::size_t file_bytes_at = 16;
constexpr std::size_t sections_at = 24;
constexpr std::size_t checksum_at = 28;
constexpr std::size_t entry_offset_at = 24;
constexpr std::size_t entry_bytes_at = 32;
constexpr std::size_t entry_element_at = 40;
constexpr std::size_t entry_flags_at = 44;

class FlirtMapFile : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path path() const { return folder_ / "map.flirt"; }

  /// The bytes of a map's file.
  std::string bytes_of(const PlaceMap& map) const {
    EXPECT_TRUE(write_place_map(path(), map).has_value());
    return read_file(path()).value();
  }
  /// What the reader says about these bytes; empty when it accepts them.
  std::string complaint(std::string_view bytes) const {
    EXPECT_TRUE(write_file_atomically(path(), bytes).has_value());
    const Result<PlaceMap> map = read_place_map(path());
    return map ? "" : map.error().message;
  }

 private:
  std::filesystem::path folder_{std::filesystem::temp_directory_path() /
                                ("flirt_map_test_" + std::to_string(getpid()))};
};

template <class T>
T get(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// The same bytes with size and checksum made right, as a writer with a bug or an ill will would leave them.
std::string sealed(std::string bytes) {
  put<std::uint64_t>(bytes, file_bytes_at, bytes.size());
  put<std::uint32_t>(bytes, checksum_at, 0);
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  put(bytes, checksum_at, static_cast<std::uint32_t>(crc));
  return bytes;
}

std::size_t entry_at(const std::string& bytes, std::string_view name) {
  const auto sections = get<std::uint32_t>(bytes, sections_at);
  for (std::size_t i = 0; i < sections; ++i) {
    const std::size_t at = header_bytes + i * entry_bytes;
    if (std::string_view(bytes.c_str() + at) == name) { return at; }
  }
  ADD_FAILURE() << "no section " << name;
  return header_bytes;
}

/// All bytes of the header and of the table of sections, the first and last of each section, and some drawn from all:
/// every byte of the file would take a minute.
std::vector<std::size_t> places_in(const std::string& bytes) {
  const auto sections = get<std::uint32_t>(bytes, sections_at);
  std::vector<std::size_t> places(header_bytes + sections * entry_bytes);
  std::iota(places.begin(), places.end(), 0U);
  for (std::size_t i = 0; i < sections; ++i) {
    const std::size_t entry = header_bytes + i * entry_bytes;
    const auto begin = get<std::uint64_t>(bytes, entry + entry_offset_at);
    const auto size = get<std::uint64_t>(bytes, entry + entry_bytes_at);
    if (size > 0) { places.insert(places.end(), {begin, begin + size - 1}); }
  }
  Rng rng(1);
  for (int i = 0; i < 300; ++i) { places.push_back(rng.below(static_cast<std::uint32_t>(bytes.size()))); }
  return places;
}

/// The file with one more section, of 5 bytes, at its end.
std::string with_section(const std::string& bytes, const std::string& name, std::uint32_t flags) {
  const auto aligned = [](std::size_t at) { return (at + 63) / 64 * 64; };
  const auto sections = get<std::uint32_t>(bytes, sections_at);
  const std::size_t table_end = header_bytes + sections * entry_bytes;
  const std::size_t shift = aligned(table_end + entry_bytes) - aligned(table_end);
  std::string more = bytes.substr(0, table_end) + std::string(entry_bytes, '\0');
  more.resize(aligned(more.size()));
  more += bytes.substr(aligned(table_end));
  more.resize(aligned(more.size()));
  std::copy(name.begin(), name.end(), more.begin() + static_cast<std::ptrdiff_t>(table_end));
  put<std::uint64_t>(more, table_end + entry_offset_at, more.size() - shift);
  put<std::uint64_t>(more, table_end + entry_bytes_at, 5);
  put<std::uint32_t>(more, table_end + entry_element_at, 1);
  put<std::uint32_t>(more, table_end + entry_flags_at, flags);
  put<std::uint32_t>(more, sections_at, sections + 1);
  more += "extra";
  for (std::size_t i = 0; i <= sections; ++i) {
    const std::size_t at = header_bytes + i * entry_bytes + entry_offset_at;
    put<std::uint64_t>(more, at, get<std::uint64_t>(more, at) + shift);
  }
  return sealed(more);
}

TEST_F(FlirtMapFile, ReadsBackBitByBit) {
  for (const MapVariances variances : {MapVariances::leave_out, MapVariances::keep}) {
    const PlaceMap map = small_map(variances);
    ASSERT_TRUE(write_place_map(path(), map).has_value());
    const Result<PlaceMap> read = read_place_map(path());
    ASSERT_TRUE(read.has_value()) << read.error().message;
    EXPECT_TRUE(equal_columns(map, *read));
    EXPECT_EQ(bytes_of(*read), bytes_of(map));
  }
}

TEST_F(FlirtMapFile, KeepsHowFeaturesWereMade) {
  FeatureParams params{.detector = RangeParams{}, .descriptor = ShapeContextParams{}};
  visit_fields(std::get<RangeParams>(params.detector), [](auto& value, const Field&) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) { value += 0.1; }
  });
  const PlaceMap map = PlaceMapBuilder(params).build();
  ASSERT_TRUE(write_place_map(path(), map).has_value());
  const Result<PlaceMap> read = read_place_map(path());
  ASSERT_TRUE(read.has_value()) << read.error().message;
  ASSERT_TRUE(std::holds_alternative<RangeParams>(read->feature_params().detector));
  ASSERT_TRUE(std::holds_alternative<ShapeContextParams>(read->feature_params().descriptor));
  std::vector<double> expected;
  std::vector<double> found;
  const auto collect_into = [](std::vector<double>& values) {
    return [&values](const auto& value, const Field&) { values.push_back(static_cast<double>(value)); };
  };
  visit_fields(std::get<RangeParams>(params.detector), collect_into(expected));
  visit_fields(std::get<RangeParams>(read->feature_params().detector), collect_into(found));
  EXPECT_EQ(found, expected);
}

TEST_F(FlirtMapFile, AnEmptyMapReadsBack) {
  ASSERT_TRUE(write_place_map(path(), PlaceMapBuilder().build()).has_value());
  const Result<PlaceMap> read = read_place_map(path());
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(read->size(), 0U);
}

TEST_F(FlirtMapFile, AnyChangedByteIsAnError) {
  const std::string good = bytes_of(small_map());
  ASSERT_EQ(complaint(good), "");
  for (const std::size_t i : places_in(good)) {
    for (const int change : {0xff, 0x01}) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ change);
      ASSERT_THAT(complaint(bad), HasSubstr("map.flirt: expected")) << "byte " << i;
    }
  }
}

TEST_F(FlirtMapFile, AnyCutIsAnError) {
  const std::string good = bytes_of(small_map());
  for (const std::size_t length : places_in(good)) {
    ASSERT_THAT(complaint(good.substr(0, length)), HasSubstr("map.flirt: expected")) << "length " << length;
  }
  EXPECT_THAT(complaint(good + "x"), HasSubstr("cut or damaged"));
}

TEST_F(FlirtMapFile, SaysWhatIsWrongWithTheHeader) {
  const std::string good = bytes_of(small_map());
  EXPECT_THAT(complaint(""), HasSubstr("found 0 bytes"));
  EXPECT_THAT(complaint(std::string(4096, 'x')), HasSubstr("found another file"));
  std::string other = good;
  put<std::uint32_t>(other, byte_order_at, 0x04030201);
  EXPECT_THAT(complaint(sealed(other)), HasSubstr("big-endian"));
  other = good;
  put<std::uint32_t>(other, version_at, 3);
  EXPECT_THAT(complaint(sealed(other)), HasSubstr("expected map format version 2, found 3"));
  other = good;
  put<std::uint32_t>(other, sections_at, 0xffffffff);
  EXPECT_THAT(complaint(sealed(other)), HasSubstr("4294967295 sections"));
}

TEST_F(FlirtMapFile, SizesThatOverflowAreErrors) {
  const std::string good = bytes_of(small_map());
  const std::size_t entry = entry_at(good, "ranges");
  for (const std::uint64_t huge :
       {~std::uint64_t{0}, ~std::uint64_t{63}, std::uint64_t{1} << 63U, std::uint64_t{1} << 40U}) {
    std::string bad = good;
    put(bad, entry + entry_bytes_at, huge);
    EXPECT_THAT(complaint(sealed(bad)), HasSubstr("within the file")) << huge;
    bad = good;
    put(bad, entry + entry_offset_at, huge);
    EXPECT_THAT(complaint(sealed(bad)), HasSubstr("within the file")) << huge;
  }
}

TEST_F(FlirtMapFile, SectionsThatDoNotFitAreErrors) {
  const std::string good = bytes_of(small_map());
  const std::size_t entry = entry_at(good, "ranges");
  std::string bad = good;
  put<std::uint32_t>(bad, entry + entry_element_at, 8);
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("section ranges: expected values of 4 bytes"));
  bad = good;
  put<std::uint64_t>(bad, entry + entry_bytes_at, get<std::uint64_t>(good, entry + entry_bytes_at) - 4);
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("range_begin"));
  bad = good;
  put<std::uint64_t>(bad, entry + entry_offset_at, get<std::uint64_t>(good, entry + entry_offset_at) + 4);
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("multiple of 64"));
  bad = good;
  bad[entry] = 'R';
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("expected a section ranges, found none"));
  bad = good;
  std::copy_n(good.begin() + static_cast<std::ptrdiff_t>(entry_at(good, "beams")), 24,
              bad.begin() + static_cast<std::ptrdiff_t>(entry));
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("found a second beams"));
}

TEST_F(FlirtMapFile, DamagedParametersAreErrors) {
  const std::string good = bytes_of(small_map());
  const auto offset = get<std::uint64_t>(good, entry_at(good, "feature_params") + entry_offset_at);
  std::string bad = good;
  bad[offset] = 'x';
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("expected JSON"));
  bad = good;
  const std::size_t name = good.find("\"curvature\"", offset);
  ASSERT_NE(name, std::string::npos);
  bad[name + 1] = 'k';
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("kurvature"));
  const FeatureParams endless{.detector = RangeParams{.scales = {.count = 12, .base = 1.6, .step = 10.0}}};
  EXPECT_THAT(complaint(bytes_of(PlaceMapBuilder(endless).build())), HasSubstr("detector: scale_base"));
}

TEST_F(FlirtMapFile, DescriptorsThatNoScanHasAreErrors) {
  const std::string good = bytes_of(small_map());
  const auto begin = [&good](std::string_view section) {
    return get<std::uint64_t>(good, entry_at(good, section) + entry_offset_at);
  };
  const std::size_t row = begin("descriptor_rows");
  const std::size_t root = begin("descriptor_roots");
  for (const float value : {0.7F, -0.5F, 1e30F, std::numeric_limits<float>::quiet_NaN()}) {
    for (const std::size_t at : {row, row + 64, root, root + 64}) {
      std::string bad = good;
      put(bad, at, value);
      EXPECT_THAT(complaint(sealed(bad)), HasSubstr("expected rows of 0 or more that sum to 1")) << value << ' ' << at;
    }
  }
  std::string bad = good;  // still sums to 1, but not of parts
  put(bad, row, get<float>(good, row) + 2);
  put(bad, row + 4, get<float>(good, row + 4) - 2);
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("found others at 0"));
  bad = good;
  put(bad, begin("support_radius"), std::numeric_limits<float>::infinity());
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("column support_radius: expected finite numbers"));
  bad = good;
  put(bad, begin("beams") + 8, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(complaint(sealed(bad)), HasSubstr("column beams: expected finite angles"));
}

TEST_F(FlirtMapFile, UnknownSectionsAreSkippedWhenOptional) {
  const std::string good = bytes_of(small_map());
  const std::string more = with_section(good, "evidence_grid", 1);
  ASSERT_EQ(complaint(more), "");
  EXPECT_TRUE(equal_columns(*read_place_map(path()), small_map()));
  EXPECT_THAT(complaint(with_section(good, "evidence_grid", 0)), HasSubstr("evidence_grid"));
}

TEST_F(FlirtMapFile, TheMapOutlivesItsName) {
  ASSERT_TRUE(write_place_map(path(), small_map()).has_value());
  const Result<PlaceMap> read = read_place_map(path());
  ASSERT_TRUE(read.has_value());
  ASSERT_TRUE(write_place_map(path(), PlaceMapBuilder().build()).has_value());
  EXPECT_TRUE(equal_columns(*read, small_map()));
}

TEST_F(FlirtMapFile, MissingFilesAndFoldersAreErrors) {
  EXPECT_THAT(read_place_map(path()).error().message, HasSubstr("map.flirt: expected a readable file"));
  EXPECT_THAT(read_place_map(path().parent_path()).error().message, HasSubstr("expected a regular file"));
  EXPECT_FALSE(write_place_map(path() / "no" / "folder", small_map()).has_value());
}

TEST_F(FlirtMapFile, LocalizesLikeTheMapItWasWrittenFrom) {
  const std::vector<Pose2> poses = poses_around(1.2, 6);
  const PlaceMap built = build_place_map(log_of(furnished_room(), poses)).value();
  ASSERT_TRUE(write_place_map(path(), built).has_value());
  const Result<PlaceMap> opened = read_place_map(path());
  ASSERT_TRUE(opened.has_value()) << opened.error().message;
  const Scan query = scan_of(furnished_room(), {0.4, 0.3, 1.0}, turn_beams(), turn_beam_count);
  const LocalizationResult from_built = localize(built, query);
  const LocalizationResult from_file = localize(*opened, query);
  ASSERT_FALSE(from_built.hypotheses.empty());
  ASSERT_EQ(from_file.hypotheses.size(), from_built.hypotheses.size());
  for (std::size_t i = 0; i < from_built.hypotheses.size(); ++i) {
    EXPECT_EQ(from_file.hypotheses[i].map_from_sensor, from_built.hypotheses[i].map_from_sensor);
    EXPECT_EQ(from_file.hypotheses[i].score, from_built.hypotheses[i].score);
  }
}

}  // namespace
}  // namespace flirt
