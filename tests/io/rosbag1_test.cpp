#include "flirt/io/rosbag1.hpp"

#include "flirt/io/recording.hpp"

#include "tests/io/bag_files.hpp"
#include "tests/support/data.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flirt {
namespace {

using bag::read_rosbag1;
using bag::Serialization;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::array bag_packings{Packing::outside, Packing::none, Packing::bz2, Packing::lz4};

TEST(Rosbag1, HoldsTheSameMessagesInOrderWhateverTheCompression) {
  for (const std::size_t n : {0U, 1U, 7U, 500U}) {
    const auto messages = example_messages(n, Serialization::ros1);
    for (const Packing packing : bag_packings) {
      const BagOutcome outcome = outcome_of(read_rosbag1, rosbag1_file(messages, {.packing = packing}));
      EXPECT_EQ(outcome.complaint, "");
      EXPECT_EQ(outcome.messages, messages) << n;
    }
  }
}

TEST(Rosbag1, ReadsABagThatWasNeverClosed) {
  const auto messages = example_messages(5, Serialization::ros1);
  for (const Packing packing : bag_packings) {
    const BagOutcome outcome =
        outcome_of(read_rosbag1, rosbag1_file(messages, {.packing = packing, .finished = false}));
    EXPECT_EQ(outcome.complaint, "");
    EXPECT_EQ(outcome.messages, messages);
  }
}

TEST(Rosbag1, ReadsTheChunkThatItsRecorderHadNotClosedYet) {
  // The recorder writes a chunk's header with sizes of 0, then its records, and comes back to the header at the end.
  const auto messages = example_messages(4, Serialization::ros1);
  std::string file = rosbag1_file(messages, {.packing = Packing::outside, .finished = false});
  const std::size_t first_connection = file.find("op=\x07") - 8;
  file.insert(first_connection,
              rosbag1_record({{"op", "\x05"}, {"compression", "none"}, {"size", std::string(4, '\0')}}, ""));
  EXPECT_EQ(outcome_of(read_rosbag1, file).messages, messages);
}

TEST(Rosbag1, SaysThatARecordingWasCutInACompressedChunk) {
  const auto messages = example_messages(4, Serialization::ros1);
  const std::string file = rosbag1_file(messages, {.packing = Packing::lz4, .finished = false});
  const BagOutcome outcome =
      outcome_of(read_rosbag1,
                 file + rosbag1_record({{"op", "\x05"}, {"compression", "lz4"}, {"size", std::string(4, '\0')}}, "") +
                     "the first blocks of a frame");
  EXPECT_EQ(outcome.messages, messages);
  EXPECT_EQ(outcome.complaint, "test.bag: at byte " + std::to_string(file.size()) +
                                   ": expected a chunk that its recorder has closed, found one without data: the "
                                   "recording was cut");
}

TEST(Rosbag1, CutAnywhereHandsOutWhatIsWholeAndSaysWhereItWasCut) {
  const auto messages = example_messages(5, Serialization::ros1);
  for (const Packing packing : bag_packings) {
    const std::string file = rosbag1_file(messages, {.packing = packing});
    std::size_t most = 0;
    std::size_t quiet = 0;
    for (std::size_t size = 0; size < file.size(); ++size) {
      const BagOutcome outcome = outcome_of(read_rosbag1, std::string_view(file).substr(0, size));
      ASSERT_TRUE(are_some_of(outcome.messages, std::span(messages).first(outcome.messages.size()))) << size;
      ASSERT_GE(outcome.messages.size(), most) << size;
      most = outcome.messages.size();
      quiet += outcome.complaint.empty() ? 1U : 0U;
    }
    EXPECT_EQ(most, messages.size());
    EXPECT_LT(quiet, 20U) << "only a cut between two records goes unseen";
  }
}

TEST(Rosbag1, SurvivesAnyDamagedByte) {
  const auto messages = example_messages(5, Serialization::ros1);
  for (const Packing packing : bag_packings) {
    const std::string file = rosbag1_file(messages, {.packing = packing});
    std::size_t complaints = 0;
    for (std::size_t place = 0; place < file.size(); ++place) {
      for (const unsigned flip : {0x01U, 0x80U, 0xFFU}) {
        std::string damaged = file;
        damaged[place] = static_cast<char>(static_cast<unsigned char>(damaged[place]) ^ flip);
        const BagOutcome outcome = outcome_of(read_rosbag1, damaged);
        ASSERT_LE(outcome.messages.size(), messages.size());
        complaints += outcome.complaint.empty() ? 0U : 1U;
      }
    }
    EXPECT_GT(complaints, file.size() / 2);
  }
}

TEST(Rosbag1, NamesTheFileAndTheByteOfWhatIsWrong) {
  const auto messages = example_messages(2, Serialization::ros1);
  const auto complaint = [](std::string_view file) { return outcome_of(read_rosbag1, file).complaint; };
  const std::string start = rosbag1_file({}, {.finished = false});
  const std::string at = "test.bag: at byte " + std::to_string(start.size()) + ": expected ";
  const std::string size = little_endian(std::uint32_t{100});
  EXPECT_EQ(complaint(""),
            "test.bag: at byte 0: expected a ROS bag, which begins with #ROSBAG V2.0, found another file");
  EXPECT_EQ(complaint(start + "\x09"), at + "4 bytes of a record's header, found 1: cut short or damaged");
  EXPECT_EQ(complaint(start + "\xFF\xFF\xFF\xFF"),
            at + "4294967295 bytes of a record's header, found 0: cut short or damaged");
  EXPECT_EQ(complaint(start + sized("") + sized("")), at + "a header field op of 1 byte, found none");
  EXPECT_EQ(complaint(start + sized(sized("op")) + sized("")), at + "a header field with =, found none");
  EXPECT_EQ(complaint(start + rosbag1_record({{"op", "\x02"}}, "")),
            at + "a message's field conn of 4 bytes, found none");
  EXPECT_EQ(complaint(start + rosbag1_record({{"op", "\x02"}, {"conn", size}}, "")),
            at + "a connection before its messages, found none for 100");
  EXPECT_EQ(complaint(start + rosbag1_record({{"op", "\x05"}, {"compression", "rar"}, {"size", size}}, "x")),
            at + "compression none, bz2, lz4 or zstd, found 'rar'");
  EXPECT_EQ(complaint(start + rosbag1_record({{"op", "\x05"}, {"compression", "none"}, {"size", size}}, "x")),
            at + "100 bytes in a chunk, found 1");
  EXPECT_EQ(complaint(start + rosbag1_record({{"op", "\x05"}, {"compression", "bz2"}, {"size", size}},
                                             packed("twelve bytes", Packing::bz2))),
            at + "100 bytes in bz2 data, found 12");
  EXPECT_EQ(complaint(start + rosbag1_record({{"op", "\x05"}, {"compression", "lz4"}, {"size", size}},
                                             packed(std::string(101, 'x'), Packing::lz4))),
            at + "100 bytes in lz4 data, found more");
  EXPECT_EQ(complaint(start + rosbag1_record({{"op", "\x05"}, {"compression", "lz4"}, {"size", size}}, "no lz4 data")),
            at + "100 bytes in lz4 data, found damage");
}

TEST(Rosbag1, TakesNoMemoryForASizeThatTheDataDoNotHold) {
  const std::string size = little_endian(std::uint32_t{0xFFFFFFFF});
  for (const Packing packing : {Packing::bz2, Packing::lz4}) {
    const std::string record =
        rosbag1_record({{"op", "\x05"}, {"compression", std::string(packing_name(packing, ""))}, {"size", size}},
                       packed("little", packing));
    EXPECT_THAT(outcome_of(read_rosbag1, "#ROSBAG V2.0\n" + record).complaint,
                HasSubstr("expected 4294967295 bytes in "));
  }
}

TEST(Rosbag1, RefusesChunksInsideChunks) {
  std::string record = rosbag1_record({{"op", "\x07"}, {"conn", "1234"}}, "");
  for (int i = 0; i < 2; ++i) {
    const std::string size = little_endian(static_cast<std::uint32_t>(record.size()));
    record = rosbag1_record({{"op", "\x05"}, {"compression", "none"}, {"size", size}}, record);
  }
  EXPECT_THAT(outcome_of(read_rosbag1, "#ROSBAG V2.0\n" + record).complaint, HasSubstr("no chunk inside a chunk"));
}

TEST(Rosbag1, PassesOnWhatTheSinkSays) {
  const std::string file = rosbag1_file(example_messages(5, Serialization::ros1));
  int taken = 0;
  const auto sink = [&taken](const bag::Message&) -> Result<void> {
    if (++taken == 3) { return fail("enough"); }
    return {};
  };
  EXPECT_EQ(read_rosbag1("test.bag", std::as_bytes(std::span(file)), sink, {}).error().message, "enough");
  EXPECT_EQ(taken, 3);
}

TEST(Rosbag1, TellsHowFarItHasCome) {
  const std::string file = rosbag1_file(example_messages(50, Serialization::ros1));
  std::vector<double> shares;
  const auto keep = [&shares](double done) { shares.push_back(done); };
  std::vector<BagMessage> messages;
  ASSERT_TRUE(read_rosbag1("test.bag", std::as_bytes(std::span(file)), keep_in(messages), keep));
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

TEST(Rosbag1, ReadsRealBags) {
  struct RealBag {
    std::string_view file;
    std::size_t scans;
    std::size_t beams;
  };
  for (const auto& [file, scans, beams] : {RealBag{"leg_tracker/positive_1.bag", 400, 768},
                                           RealBag{"leg_tracker/demo_stationary_simple_environment.bag", 1265, 512}}) {
    const auto path = data_file(file);
    if (!path) { GTEST_SKIP() << "no real bags here: " << file; }
    std::map<std::string, std::size_t, std::less<>> counts;
    const std::size_t least_bytes = 16 + 7 * 4 + 2 * 4 + beams * 4;  // header, numbers, lengths of lists, ranges
    const auto count = [&counts, least_bytes](const bag::Message& message) -> Result<void> {
      ++counts[std::string(message.type)];
      if (message.type == "sensor_msgs/LaserScan") { EXPECT_GE(message.bytes.size(), least_bytes); }
      return {};
    };
    const Result<std::string> format = bag::read_recording(*path, count, {});
    ASSERT_TRUE(format) << format.error().message;
    EXPECT_EQ(*format, "ROS 1 bag");
    EXPECT_EQ(counts["sensor_msgs/LaserScan"], scans);
  }
}

}  // namespace
}  // namespace flirt
