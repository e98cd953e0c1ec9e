#include "flirt/io/ros_map.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/pgm.hpp"
#include "flirt/io/png.hpp"

#include "tests/support/data.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <string>
#include <vector>

namespace flirt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

GreyImage random_image(std::size_t width, std::size_t height) {
  Rng rng(3);
  GreyImage image{.width = width, .height = height};
  for (std::size_t i = 0; i < width * height; ++i) {
    image.pixels.push_back(static_cast<std::uint8_t>(rng.below(256)));
  }
  return image;
}

/// PNG bytes of any kind, by libpng's simple interface.
std::string png_of(std::uint32_t format, png_uint_32 width, png_uint_32 height, const std::vector<std::uint8_t>& bytes,
                   const std::vector<std::uint8_t>& colours = {}) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = format;
  image.colormap_entries = static_cast<png_uint_32>(colours.size() / 3);
  std::string result(10000, '\0');
  png_alloc_size_t size = result.size();
  EXPECT_NE(png_image_write_to_memory(&image, result.data(), &size, 0, bytes.data(), 0, colours.data()), 0);
  result.resize(size);
  return result;
}

TEST(Png, ReadsBackWhatItWrote) {
  for (const std::size_t width : {1U, 7U, 8U, 300U}) {
    const GreyImage image = random_image(width, 5);
    EXPECT_EQ(decode_png(encode_png(image), "a").value(), image);
  }
}

TEST(Png, TakesTheMeanOfColours) {
  const auto pixels = decode_png(png_of(PNG_FORMAT_RGB, 2, 1, {10, 20, 60, 255, 255, 255}), "a").value().pixels;
  EXPECT_THAT(pixels, ElementsAre(30, 255));
}

TEST(Png, TakesTransparentPixelsForUnknown) {
  const auto pixels =
      decode_png(png_of(PNG_FORMAT_RGBA, 3, 1, {0, 0, 0, 0, 0, 0, 0, 255, 254, 254, 254, 255}), "a").value().pixels;
  EXPECT_THAT(pixels, ElementsAre(205, 0, 254));
}

TEST(Png, ReadsPalettes) {
  const auto pixels =
      decode_png(png_of(PNG_FORMAT_RGB_COLORMAP, 4, 1, {0, 1, 2, 1}, {0, 0, 0, 90, 90, 90, 255, 255, 255}), "a")
          .value()
          .pixels;
  EXPECT_THAT(pixels, ElementsAre(0, 90, 255, 90));
}

TEST(Png, RefusesBrokenAndShortBytes) {
  const std::string good = encode_png(random_image(20, 20));
  EXPECT_THAT(decode_png("", "a.png").error().message, HasSubstr("a.png: expected a PNG image"));
  EXPECT_THAT(decode_png("hello hello hello", "a").error().message, HasSubstr("Not a PNG file"));
  for (std::size_t length = 0; length < good.size(); length += 7) {
    EXPECT_FALSE(decode_png(good.substr(0, length), "a")) << length;
  }
  for (std::size_t place = 0; place < good.size(); place += 3) {  // every chunk has a check sum
    std::string bad = good;
    bad[place] = static_cast<char>(bad[place] ^ 0x21);
    static_cast<void>(decode_png(bad, "a"));
  }
}

TEST(Png, WritesImagesOfAnyWidth) {
  const GreyImage wide{1'000'001, 1, std::vector<std::uint8_t>(1'000'001, 7)};
  EXPECT_TRUE(encode_png(wide).starts_with("\x89PNG"));
}

TEST(Png, RefusesSizesBeyondReasonWithoutAllocatingThem) {
  std::string bytes = encode_png(random_image(2, 2));
  const std::string huge("\x00\x0f\x00\x00\x00\x0f\x00\x00", 8);
  bytes.replace(16, 8, huge);
  const auto check = static_cast<png_uint_32>(crc32(0, reinterpret_cast<const Bytef*>(&bytes[12]), 17));
  for (std::size_t i = 0; i < 4; ++i) { bytes[29 + i] = static_cast<char>(check >> (24 - 8 * i)); }
  EXPECT_THAT(decode_png(bytes, "a").error().message, HasSubstr("more than 2^28 pixels"));
}

TEST(Pgm, ReadsBackWhatItWrote) {
  const GreyImage image = random_image(13, 7);
  EXPECT_EQ(decode_pgm(encode_pgm(image), "a").value(), image);
}

TEST(Pgm, ReadsTextWithCommentsAndOtherMaxima) {
  const GreyImage image = decode_pgm("P2 # comment\n# 9 9\n3 2\n15\n0 5 15\n# more\n1 2 3", "a").value();
  EXPECT_EQ(image.width, 3U);
  EXPECT_THAT(image.pixels, ElementsAre(0, 85, 255, 17, 34, 51));
}

TEST(Pgm, ReadsSixteenBits) {
  EXPECT_THAT(decode_pgm(std::string("P5 2 1 65535\n\x00\x00\xff\xff", 17), "a").value().pixels, ElementsAre(0, 255));
}

TEST(Pgm, RefusesBrokenFiles) {
  EXPECT_THAT(decode_pgm("P6 1 1 255\nabc", "a.pgm").error().message,
              HasSubstr("a.pgm: expected a PGM image, found one that begins with 'P6'"));
  EXPECT_FALSE(decode_pgm("", "a"));
  EXPECT_FALSE(decode_pgm("P5 2 2 255\nabc", "a"));
  EXPECT_FALSE(decode_pgm("P5 0 2 255\n", "a"));
  EXPECT_FALSE(decode_pgm("P5 -1 2 255\n", "a"));
  EXPECT_FALSE(decode_pgm("P5 99999999999 99999999999 255\n", "a"));
  EXPECT_FALSE(decode_pgm("P5 100000 2000 255\n", "a"));
  EXPECT_FALSE(decode_pgm("P2 2 1 255\n1", "a"));
  EXPECT_FALSE(decode_pgm("P2 2 1 255\n1 256", "a"));
  EXPECT_FALSE(decode_pgm("P2 10000 10000 255\n1 2 3", "a"));
  EXPECT_FALSE(decode_pgm("P5 1 1 0\na", "a"));
}

constexpr std::string_view usual_yaml =
    "image: map.pgm\nresolution: 0.05\norigin: [-10.0, 2.5, 0.1]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: "
    "0.196\n";

TEST(GridMapYaml, ReadsWhatMapSaverWrites) {
  const GridMapMetadata metadata = parse_grid_map_yaml(usual_yaml, "a").value();
  EXPECT_EQ(metadata, (GridMapMetadata{.image = "map.pgm", .resolution = 0.05, .origin = {-10, 2.5, 0.1}}));
}

TEST(GridMapYaml, ReadsCommentsQuotesListsAndOtherKeys) {
  const auto metadata = parse_grid_map_yaml(
                            "%YAML 1.2\n---\n# a map\nimage: \"my #1 map.png\"  # the picture\r\nresolution: "
                            "1e-1\norigin:\n- 1\n- -2.5\n- 0\n"
                            "author: somebody\nnegate: true\nmode: scale\n\n",
                            "a")
                            .value();
  EXPECT_EQ(metadata, (GridMapMetadata{.image = "my #1 map.png",
                                       .resolution = 0.1,
                                       .origin = {1, -2.5, 0},
                                       .negate = true,
                                       .mode = GridMapMode::scale}));
}

TEST(GridMapYaml, ReadsBackWhatItWrote) {
  const GridMapMetadata metadata{.image = "a.png",
                                 .resolution = 0.1234567,
                                 .origin = {-1e-7, 576.5, -3},
                                 .negate = true,
                                 .occupied_thresh = 0.7,
                                 .free_thresh = 0.25,
                                 .mode = GridMapMode::raw};
  EXPECT_EQ(parse_grid_map_yaml(grid_map_yaml(metadata), "a").value(), metadata);
}

TEST(GridMapYaml, RefusesWhatMakesNoSense) {
  const auto error = [](std::string_view text) { return parse_grid_map_yaml(text, "m.yaml").error().message; };
  const std::string usual(usual_yaml);
  EXPECT_THAT(error(""), HasSubstr("m.yaml: expected the key image"));
  EXPECT_THAT(error("image: a\nresolution: 0.05\n"), HasSubstr("expected the key origin"));
  EXPECT_THAT(error("image: a\nresolution: 0\norigin: [0, 0, 0]\n"), HasSubstr("m.yaml:2: expected resolution from"));
  EXPECT_THAT(error("image: a\nresolution: nan\norigin: [0, 0, 0]\n"), HasSubstr("found 'nan'"));
  EXPECT_THAT(error("image: a\nresolution: 1\norigin: [0, 0]\n"),
              HasSubstr("m.yaml:3: expected origin as [x, y, yaw], found '[0, 0]'"));
  EXPECT_THAT(error("image: a\nresolution: 1\norigin: 5\n"), HasSubstr("expected origin as"));
  EXPECT_THAT(error("image:\nresolution: 1\norigin: [0, 0, 0]\n"), HasSubstr("m.yaml:1: expected a file name"));
  EXPECT_THAT(error(usual + "negate: 1\n"), HasSubstr("m.yaml:7: expected each key once, found 'negate'"));
  EXPECT_THAT(error(usual + "mode: best\n"), HasSubstr("expected mode trinary, scale or raw, found 'best'"));
  EXPECT_THAT(error("image: a\nresolution: 1\norigin: [0, 0, 0]\nnegate: 2\n"), HasSubstr("expected negate as 0 or 1"));
  EXPECT_THAT(error("image: a\nresolution: 1\norigin: [0, 0, 0]\noccupied_thresh: 0.2\nfree_thresh: 0.3\n"),
              HasSubstr("free_thresh from"));
  EXPECT_THAT(error(usual + "what is this\n"),
              HasSubstr("m.yaml:7: expected a line \"key: value\", found 'what is this'"));
  EXPECT_THAT(error("- 1\n"), HasSubstr("expected a line"));
}

TEST(GridMap, IsWrittenAndReadWithItsImage) {
  const TemporaryFolder folder;
  for (const std::string name : {"map.pgm", "map.png"}) {
    const GridMapImage map{random_image(6, 4), {.image = name, .origin = {1, 2, 0}}};
    ASSERT_TRUE(write_grid_map(folder.path() / "map.yaml", map));
    const GridMapImage found = read_grid_map(folder.path() / "map.yaml").value();
    EXPECT_EQ(found.image, map.image);
    EXPECT_EQ(found.metadata, map.metadata);
  }
}

TEST(GridMap, NamesTheMissingImage) {
  const TemporaryFolder folder;
  const auto path = folder.file("map.yaml", usual_yaml);
  EXPECT_THAT(read_grid_map(path).error().message, HasSubstr("map.pgm: expected a file, found nothing"));
  EXPECT_THAT(read_grey_image(path).error().message, HasSubstr("expected a PGM (P2, P5) or PNG image"));
}

TEST(GridMap, TellsCellsLikeMapServer) {
  const GridMapMetadata usual;
  EXPECT_EQ(cell_state(0, usual), CellState::occupied);
  EXPECT_EQ(cell_state(254, usual), CellState::free);
  EXPECT_EQ(cell_state(205, usual), CellState::unknown);
  const GridMapMetadata negated{.negate = true};
  EXPECT_EQ(cell_state(255, negated), CellState::occupied);
  EXPECT_EQ(cell_state(0, negated), CellState::free);
  const GridMapMetadata raw{.mode = GridMapMode::raw};
  EXPECT_EQ(cell_state(100, raw), CellState::occupied);
  EXPECT_EQ(cell_state(0, raw), CellState::free);
  EXPECT_EQ(cell_state(255, raw), CellState::unknown);
}

TEST(GridMap, PutsPixelsWhereTheOriginSays) {
  const GreyImage image = random_image(4, 3);
  const GridMapMetadata metadata{.resolution = 0.5, .origin = {10, 20, 0}};
  EXPECT_EQ(map_point(0, 2, image, metadata), (Point2{10.25, 20.25}));  // lower left
  EXPECT_EQ(map_point(3, 0, image, metadata), (Point2{11.75, 21.25}));  // upper right
}

struct RealMap {
  std::string_view file;
  std::size_t width;
  std::size_t height;
};

TEST(RealMaps, AreRead) {
  for (const RealMap& map :
       {RealMap{"maps/willow/willow-full-0.05.pgm", 1165, 945}, RealMap{"maps/stage/cave.png", 500, 500},
        RealMap{"maps/stage/autolab.png", 809, 689}, RealMap{"maps/stage/hospital_section.png", 1086, 443},
        RealMap{"maps/stage/uoa_robotics_lab.png", 566, 1262}}) {
    const auto path = data_file(map.file);
    if (!path) { GTEST_SKIP() << "no real maps here: " << map.file; }
    const GreyImage image = read_grey_image(*path).value();
    EXPECT_EQ(image.width, map.width) << map.file;
    EXPECT_EQ(image.height, map.height) << map.file;
    const auto dark =
        std::count_if(image.pixels.begin(), image.pixels.end(), [](std::uint8_t pixel) { return pixel < 90; });
    const double share = static_cast<double>(dark) / static_cast<double>(image.pixels.size());
    EXPECT_GT(share, 0.005) << map.file;  // walls, neither none nor all
    EXPECT_LT(share, 0.5) << map.file;
  }
}

TEST(RealMaps, WithYamlHaveWallsAndFreeSpace) {
  for (const std::string_view file : {"simple_rooms", "simple_rooms_no_walls", "frieburg", "hospital_section",
                                      "robocup", "mines", "sparse_obstacles"}) {
    const auto path = data_file("maps/stdr/" + std::string(file) + ".yaml");
    if (!path) { GTEST_SKIP() << "no real maps here: " << file; }
    const GridMapImage map = read_grid_map(*path).value();
    std::size_t occupied = 0;
    std::size_t free = 0;
    for (const std::uint8_t pixel : map.image.pixels) {
      occupied += cell_state(pixel, map.metadata) == CellState::occupied ? 1U : 0U;
      free += cell_state(pixel, map.metadata) == CellState::free ? 1U : 0U;
    }
    EXPECT_GT(occupied, 500U) << file;
    EXPECT_GT(free, map.image.pixels.size() / 10) << file;
  }
}

}  // namespace
}  // namespace flirt
