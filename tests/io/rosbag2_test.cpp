#include "flirt/io/rosbag2.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/recording.hpp"

#include "tests/io/bag_files.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flirt {
namespace {

namespace fs = std::filesystem;

using bag::files_of_recording;
using bag::is_recording;
using bag::read_recording;
using bag::read_sqlite_bag;
using bag::Serialization;
using testing::ElementsAre;
using testing::HasSubstr;

BagOutcome outcome_of_db3(const fs::path& path) {
  BagOutcome outcome;
  if (auto done = read_sqlite_bag(path, keep_in(outcome.messages), {}); !done) {
    outcome.complaint = done.error().message;
  }
  return outcome;
}

BagOutcome outcome_of_recording(const fs::path& path) {
  BagOutcome outcome;
  const Result<std::string> format = read_recording(path, keep_in(outcome.messages), {});
  if (!format) { outcome.complaint = format.error().message; }
  return outcome;
}

TEST(Rosbag2, HandsOutMessagesByTheirStamps) {
  const TemporaryFolder folder;
  for (const std::size_t n : {0U, 1U, 300U}) {
    const auto messages = example_messages(n, Serialization::cdr);
    const fs::path path = folder.path() / (std::to_string(n) + ".db3");
    write_db3(path, messages);
    const BagOutcome outcome = outcome_of_db3(path);
    EXPECT_EQ(outcome.complaint, "");
    EXPECT_EQ(outcome.messages, messages);
  }
}

TEST(Rosbag2, KeepsTheOrderOfEqualStamps) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db3";
  const auto messages = example_messages(6, Serialization::cdr);
  write_db3(path, messages);
  run_sql(path, "UPDATE messages SET timestamp = 5;");
  const std::vector<BagMessage> stored(messages.rbegin(), messages.rend());
  EXPECT_EQ(outcome_of_db3(path).messages, stored);
}

TEST(Rosbag2, SkipsTopicsThatAreSerializedOtherwise) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db3";
  const auto messages = example_messages(3, Serialization::cdr);
  write_db3(path, messages);
  run_sql(path, "UPDATE topics SET serialization_format = 'protobuf' WHERE name = '/odom';");
  EXPECT_THAT(outcome_of_db3(path).messages, ElementsAre(messages[0], messages[2]));
}

TEST(Rosbag2, ReadsFilesOfAnyNameAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  const auto messages = example_messages(3, Serialization::cdr);
  const fs::path path = folder.path() / "a b?mode=memory#50%20.db3";
  write_db3(path, messages);
  run_sql(path, "PRAGMA journal_mode = WAL;");
  EXPECT_EQ(outcome_of_db3(path).messages, messages);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(Rosbag2, ReadsWhatARecorderLeftInItsWriteAheadLog) {
  const TemporaryFolder folder;
  const auto messages = example_messages(9, Serialization::cdr);
  const fs::path path = folder.path() / "a.db3";
  write_db3(path, messages);
  sqlite3* recorder = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &recorder), SQLITE_OK);
  sqlite3_db_config(recorder, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);  // as if it was killed
  const char* const statements = "PRAGMA journal_mode = WAL; DELETE FROM messages WHERE topic_id = 2;";
  EXPECT_EQ(sqlite3_exec(recorder, statements, nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_EQ(outcome_of_db3(path).messages.size(), 5U) << "while it runs";
  sqlite3_close(recorder);
  EXPECT_GT(fs::file_size(path.string() + "-wal"), 0U);
  EXPECT_EQ(outcome_of_db3(path).messages.size(), 5U) << "afterwards";
}

TEST(Rosbag2, ComplainsOfWhatIsNoRecording) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db3";
  run_sql(path, "CREATE TABLE topics(id); CREATE VIEW messages AS SELECT 1;");
  EXPECT_EQ(outcome_of_db3(path).complaint,
            path.string() + ": expected a recording of ROS 2 with tables topics and messages, found none");
  EXPECT_THAT(outcome_of_db3(folder.file("text.db3", std::string(5000, 'x'))).complaint,
              HasSubstr("text.db3: expected a readable recording, found: file is not a database"));
  EXPECT_THAT(outcome_of_db3(folder.file("empty.db3", "")).complaint, HasSubstr("expected a recording of ROS 2"));
  EXPECT_THAT(outcome_of_db3(folder.path() / "none.db3").complaint, HasSubstr("expected a regular file, found"));
  run_sql(folder.path() / "other.db3", "CREATE TABLE topics(id); CREATE TABLE messages(id);");
  EXPECT_THAT(outcome_of_db3(folder.path() / "other.db3").complaint, HasSubstr("found: no such column: name"));
}

TEST(Rosbag2, SurvivesCutsAndDamagedBytes) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.db3";
  const auto messages = example_messages(12, Serialization::cdr);
  write_db3(path, messages);
  run_sql(path, "PRAGMA page_size = 512; VACUUM;");
  const std::string file = read_file(path).value();
  ASSERT_LT(file.size(), 10000U);
  std::size_t complaints = 0;
  for (std::size_t place = 0; place < file.size(); ++place) {
    std::string damaged = file;
    damaged[place] = static_cast<char>(static_cast<unsigned char>(damaged[place]) ^ (place % 2 == 0 ? 0xFFU : 0x01U));
    const BagOutcome outcome = outcome_of_db3(folder.file("damaged.db3", damaged));
    complaints += outcome.complaint.empty() ? 0U : 1U;
  }
  EXPECT_GT(complaints, file.size() / 20);
  for (std::size_t size = 0; size < file.size(); size += size < 1024 ? 1 : 61) {
    const BagOutcome outcome = outcome_of_db3(folder.file("cut.db3", std::string_view(file).substr(0, size)));
    ASSERT_TRUE(are_some_of(outcome.messages, messages)) << size;
    ASSERT_NE(outcome.complaint, "") << size;
  }
}

TEST(Rosbag2, ListsFilesAsMetadataDoes) {
  const TemporaryFolder folder;
  for (const std::string_view name : {"b_0.db3", "b_1.db3", "c 2.db3"}) { (void)folder.file(name, ""); }
  (void)folder.file("metadata.yaml",
                    "info:\r\n  relative_file_paths:\r\n    - b_1.db3\r\n\r\n    # a comment\r\n    - \"c 2.db3\"\r\n"
                    "    - 'b_0.db3'\r\n  topics:\r\n    - other.db3\r\n");
  EXPECT_THAT(files_of_recording(folder.path()).value(),
              ElementsAre(folder.path() / "b_1.db3", folder.path() / "c 2.db3", folder.path() / "b_0.db3"));
}

TEST(Rosbag2, FindsFilesThatAreListedWithTheFoldersName) {
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "walk";
  fs::create_directory(recording);
  (void)folder.file("walk/walk_0.db3", "");
  write_metadata(recording, std::array<std::string, 1>{"walk/walk_0.db3"});
  EXPECT_THAT(files_of_recording(recording).value(), ElementsAre(recording / "walk_0.db3"));
}

TEST(Rosbag2, ComplainsOfAFolderThatIsNotWhole) {
  const TemporaryFolder folder;
  const auto complaint = [&folder] { return files_of_recording(folder.path()).error().message; };
  EXPECT_EQ(complaint(), folder.path().string() + ": expected a recording with a metadata.yaml, found none");
  write_metadata(folder.path(), {});
  EXPECT_THAT(complaint(), HasSubstr("metadata.yaml: expected files below relative_file_paths, found none"));
  write_metadata(folder.path(), std::array<std::string, 1>{"a.db3"});
  EXPECT_EQ(complaint(),
            (folder.path() / "a.db3").string() + ": expected the file that metadata.yaml lists, found none");
  (void)folder.file("metadata.yaml", "relative_file_paths:\n- a.db3\ncompression_mode: MESSAGE\n");
  EXPECT_THAT(complaint(), HasSubstr("found compression_mode: MESSAGE: run ros2 bag convert"));
}

TEST(Rosbag2, SaysHowToUnpackFilesThatAreCompressedAsAWhole) {
  const TemporaryFolder folder;
  const auto messages = example_messages(3, Serialization::cdr);
  write_db3(folder.path() / "plain.db3", messages);
  const std::string packed_file = packed(read_file(folder.path() / "plain.db3").value(), Packing::zstd);
  const fs::path path = folder.file("a.db3.zstd", packed_file);
  write_metadata(folder.path(), std::array<std::string, 1>{"a.db3.zstd"});
  EXPECT_TRUE(is_recording(path));
  for (const fs::path& which : {folder.path(), path}) {
    EXPECT_EQ(outcome_of_recording(which).complaint,
              path.string() + ": expected a file that is not compressed as a whole, found one that is: run zstd -d " +
                  path.string());
  }
  fs::rename(folder.path() / "plain.db3", folder.path() / "a.db3");
  EXPECT_EQ(outcome_of_recording(folder.path()).messages, messages) << "it was unpacked beside the packed one";
}

TEST(Recording, ReadsSplitFilesOneAfterTheOther) {
  const TemporaryFolder folder;
  const auto messages = example_messages(10, Serialization::cdr);
  write_db3(folder.path() / "b_0.db3", std::span(messages).first(4));
  write_db3(folder.path() / "b_1.db3", std::span(messages).subspan(4));
  write_metadata(folder.path(), std::array<std::string, 2>{"b_0.db3", "b_1.db3"});
  std::vector<BagMessage> read;
  std::vector<double> shares;
  EXPECT_EQ(read_recording(folder.path(), keep_in(read), [&shares](double done) { shares.push_back(done); }).value(),
            "ROS 2 bag (sqlite3)");
  EXPECT_EQ(read, messages);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

TEST(Recording, TellsFormatsFromTheirContent) {
  const TemporaryFolder folder;
  const auto ros1 = example_messages(3, Serialization::ros1);
  const auto cdr = example_messages(3, Serialization::cdr);
  const fs::path bag = folder.file("a", rosbag1_file(ros1));
  const fs::path mcap = folder.file("b", mcap_file(cdr));
  write_db3(folder.path() / "c", cdr);
  const auto format = [](const fs::path& path) {
    std::vector<BagMessage> messages;
    const std::string name = read_recording(path, keep_in(messages), {}).value();
    return is_recording(path) ? name + ", " + std::to_string(messages.size()) : "";
  };
  EXPECT_EQ(format(bag), "ROS 1 bag, 3");
  EXPECT_EQ(format(mcap), "MCAP, 3");
  EXPECT_EQ(format(folder.path() / "c"), "ROS 2 bag (sqlite3), 3");
  EXPECT_FALSE(is_recording(folder.path()));
  write_metadata(folder.path(), std::array<std::string, 2>{"b", "b"});
  EXPECT_EQ(format(folder.path()), "MCAP, 6");
}

TEST(Recording, IsNothingElse) {
  const TemporaryFolder folder;
  EXPECT_FALSE(is_recording(folder.path()));
  EXPECT_FALSE(is_recording(folder.path() / "none"));
  EXPECT_FALSE(is_recording(folder.file("empty.bag", "")));
  EXPECT_FALSE(is_recording(folder.file("old.bag", "#ROSBAG V1.2\n")));
  const fs::path log = folder.file("carmen.log", "# a log\n");
  EXPECT_FALSE(is_recording(log));
  EXPECT_EQ(outcome_of_recording(log).complaint,
            log.string() + ": expected a recording of ROS: a ROS 1 bag, MCAP or sqlite3, found another file");
}

TEST(Recording, DoesNotWaitForAPipe) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe.db3.zstd";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(is_recording(pipe));
  EXPECT_THAT(outcome_of_recording(pipe).complaint, HasSubstr("expected a regular file"));
}

}  // namespace
}  // namespace flirt
