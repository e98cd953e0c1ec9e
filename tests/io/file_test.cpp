#include "flirt/io/file.hpp"

#include "tests/io/gzip.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace flirt {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// All lines of a file, or those before an error and then its message.
std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  auto reader = LineReader::open(path);
  if (!reader) { return {reader.error().message}; }
  while (true) {
    const auto line = reader->next();
    if (!line) {
      lines.push_back("error: " + line.error().message);
      return lines;
    }
    if (!*line) { return lines; }
    EXPECT_EQ((*line)->number, lines.size() + 1);
    lines.emplace_back((*line)->text);
  }
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(LineReader, EndsLinesAtAnyKindOfLineEnd) {
  const TemporaryFolder folder;
  EXPECT_THAT(lines_of(folder.file("a", "one\ntwo\r\nthree\rfour\n")), ElementsAre("one", "two", "three", "four"));
  EXPECT_THAT(lines_of(folder.file("b", "one\n\ntwo")), ElementsAre("one", "", "two"));
  EXPECT_THAT(lines_of(folder.file("c", "one\r")), ElementsAre("one"));
  EXPECT_THAT(lines_of(folder.file("d", "")), ElementsAre());
}

TEST(LineReader, KeepsPairsOfLineEndsTogetherAcrossItsBuffer) {
  const TemporaryFolder folder;
  constexpr std::size_t chunk = 1U << 16U;
  for (std::size_t length = chunk - 3; length <= chunk + 1; ++length) {
    const std::string first(length, 'x');
    EXPECT_THAT(lines_of(folder.file("a", first + "\r\nb\r\n")), ElementsAre(first, "b")) << length;
  }
}

TEST(LineReader, ReadsLinesLongerThanItsBuffer) {
  const TemporaryFolder folder;
  const std::string huge(3'000'000, 'y');
  EXPECT_THAT(lines_of(folder.file("a", "a\n" + huge + "\nb\n")), ElementsAre("a", huge, "b"));
}

TEST(LineReader, TellsALastLineWithoutEnd) {
  const TemporaryFolder folder;
  auto reader = LineReader::open(folder.file("a", "one\ntwo"));
  EXPECT_EQ((*reader->next())->end, LineEnd::newline);
  EXPECT_EQ((*reader->next())->end, LineEnd::end_of_file);
  EXPECT_FALSE(reader->next()->has_value());
  EXPECT_FALSE(reader->next()->has_value());
}

TEST(LineReader, GoesBackToAMarkHoweverMuchWasRead) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 30000; ++i) { text += "line " + std::to_string(i) + '\n'; }  // several buffers
  auto reader = LineReader::open(folder.file("a", text));
  EXPECT_EQ((*reader->next())->text, "line 0");
  reader->mark();
  for (int i = 1; i < 20000; ++i) { ASSERT_EQ((*reader->next())->text, "line " + std::to_string(i)); }
  reader->rewind();
  for (int i = 1; i < 30000; ++i) {
    const auto line = *reader->next();
    ASSERT_EQ(line->text, "line " + std::to_string(i));
    ASSERT_EQ(line->number, static_cast<std::size_t>(i) + 1);
  }
  EXPECT_FALSE(reader->next()->has_value());
}

TEST(LineReader, RefusesALineOfMoreThan64Megabytes) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("bomb.gz", gzipped("one\n" + std::string(65U << 20U, '\0')));
  EXPECT_THAT(lines_of(path),
              ElementsAre("one", "error: " + path.string() + ":2: expected a line of up to 64 MB, found a longer one"));
}

TEST(ReadFile, StopsReadingWhatNeverEnds) {
  EXPECT_THAT(read_file("/dev/zero").error().message, HasSubstr("/dev/zero: expected up to 256 MB"));
  EXPECT_EQ(read_file("/dev/null").value(), "");
}

TEST(LineReader, ReadsGzipAsIfItWerePlain) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("a.gz", gzipped("one\ntwo\n"));
  EXPECT_THAT(lines_of(path), ElementsAre("one", "two"));
  EXPECT_TRUE(LineReader::open(path)->is_gzip());
  EXPECT_FALSE(LineReader::open(folder.file("a", "one\n"))->is_gzip());
}

TEST(LineReader, HandsOutWhatComesBeforeACutInGzipDataAndThenFails) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 20000; ++i) { text += "line " + std::to_string(i * 7919 % 10007) + '\n'; }
  const std::string zipped = gzipped(text);
  const auto lines = lines_of(folder.file("a.gz", zipped.substr(0, zipped.size() / 2)));
  ASSERT_GT(lines.size(), 5000U);
  EXPECT_THAT(lines.back(), HasSubstr("gzip data that is cut short"));
  EXPECT_THAT(lines.back(), HasSubstr("a.gz:" + std::to_string(lines.size())));
}

TEST(LineReader, ReportsBrokenGzipData) {
  const TemporaryFolder folder;
  std::string zipped = gzipped(std::string(1000, 'a') + "\n" + std::string(1000, 'b'));
  zipped[zipped.size() - 6] = static_cast<char>(zipped[zipped.size() - 6] ^ 0x55);  // the check sum
  EXPECT_THAT(lines_of(folder.file("a.gz", zipped)).back(), HasSubstr("broken data"));
}

TEST(LineReader, ReportsMissingFilesAndFolders) {
  const TemporaryFolder folder;
  EXPECT_THAT(lines_of(folder.path() / "none"), ElementsAre(HasSubstr("none: expected a file, found nothing")));
  EXPECT_THAT(lines_of(folder.path()), ElementsAre(HasSubstr("expected a file, found a folder")));
}

TEST(LineReader, CountsTheShareThatWasRead) {
  const TemporaryFolder folder;
  auto reader = LineReader::open(folder.file("a", std::string(2'000'000, '\n')));
  ASSERT_TRUE(reader->next());
  EXPECT_GT(reader->share_read(), 0.0);
  EXPECT_LT(reader->share_read(), 0.5);
  while (reader->next()->has_value()) {}
  EXPECT_EQ(reader->share_read(), 1.0);
}

TEST(ReadFile, KeepsEveryByte) {
  const TemporaryFolder folder;
  std::string bytes("\0\r\n\xff", 4);
  bytes.resize(1U << 16U, 'z');  // exactly one chunk
  EXPECT_EQ(read_file(folder.file("a", bytes)).value(), bytes);
  EXPECT_EQ(read_file(folder.file("b", "")).value(), "");
  EXPECT_FALSE(read_file(folder.path()));
  EXPECT_FALSE(read_file(folder.path() / "none"));
}

TEST(WriteFileAtomically, ReplacesTheFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a";
  ASSERT_TRUE(write_file_atomically(path, "first"));
  ASSERT_TRUE(write_file_atomically(path, "second"));
  EXPECT_EQ(read_file(path).value(), "second");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(WriteFileAtomically, LeavesTheOldFileAndNothingHalfWrittenOnFailure) {
  const TemporaryFolder folder;
  EXPECT_FALSE(write_file_atomically(folder.path() / "no" / "such", "x"));
  fs::create_directory(folder.path() / "folder");
  const auto result = write_file_atomically(folder.path() / "folder", "x");
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("found a folder"));
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(WriteFileAtomically, WritesThroughLinksAndIntoDevices) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("a", "old");
  fs::create_symlink(path, folder.path() / "link");
  ASSERT_TRUE(write_file_atomically(folder.path() / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(read_file(path).value(), "new");
  ASSERT_TRUE(write_file_atomically("/dev/null", "x"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(WriteFileAtomically, MakesTheFileThatALinkLeadsTo) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "far");
  fs::create_symlink("far/second", folder.path() / "first");  // as seen from where the link is
  fs::create_symlink(folder.path() / "end", folder.path() / "far" / "second");
  ASSERT_TRUE(write_file_atomically(folder.path() / "first", "new"));
  EXPECT_TRUE(fs::is_symlink(folder.path() / "first"));
  EXPECT_TRUE(fs::is_symlink(folder.path() / "far" / "second"));
  EXPECT_EQ(read_file(folder.path() / "end").value(), "new");
  fs::create_symlink("ring", folder.path() / "ring");
  EXPECT_THAT(write_file_atomically(folder.path() / "ring", "new").error().message,
              HasSubstr("ring: expected to write"));
  fs::create_symlink("no/folder", folder.path() / "nowhere");
  EXPECT_FALSE(write_file_atomically(folder.path() / "nowhere", "new"));
  EXPECT_TRUE(fs::is_symlink(folder.path() / "nowhere"));
}

TEST(WriteFileAtomically, KeepsThePermissionsOfTheOldFile) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("a", "old");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  ASSERT_TRUE(write_file_atomically(path, "new"));
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
}

}  // namespace
}  // namespace flirt
