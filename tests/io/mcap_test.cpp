#include "flirt/io/mcap.hpp"

#include "tests/io/bag_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flirt {
namespace {

using bag::read_mcap;
using bag::Serialization;
using testing::HasSubstr;

constexpr std::array mcap_packings{Packing::outside, Packing::none, Packing::lz4, Packing::zstd};

std::string mcap_complaint(std::string_view file) {
  return outcome_of(read_mcap, file).complaint;
}

std::string mcap_start() {
  return mcap_file({}, {.finished = false});
}

/// A message of channel 1 with the given bytes.
std::string mcap_message(std::string_view bytes) {
  return mcap_record('\x05', little_endian(std::uint16_t{1}) + std::string(20, '\0') + std::string(bytes));
}

std::string mcap_chunk(std::string_view compression, std::uint64_t size, std::uint32_t crc, std::string_view bytes) {
  return mcap_record('\x06', std::string(16, '\0') + little_endian(size) + little_endian(crc) + sized(compression) +
                                 sized<std::uint64_t>(bytes));
}

TEST(Mcap, HoldsTheSameMessagesInOrderWhateverTheCompression) {
  for (const Serialization serialization : {Serialization::ros1, Serialization::cdr}) {
    for (const std::size_t n : {0U, 1U, 7U, 500U}) {
      const auto messages = example_messages(n, serialization);
      for (const Packing packing : mcap_packings) {
        const BagOutcome outcome = outcome_of(read_mcap, mcap_file(messages, {.packing = packing}));
        EXPECT_EQ(outcome.complaint, "");
        EXPECT_EQ(outcome.messages, messages) << n;
      }
    }
  }
}

TEST(Mcap, HandsOutAllOfAnUnfinishedFileAndSaysWhereItEnds) {
  const auto messages = example_messages(5, Serialization::cdr);
  for (const Packing packing : mcap_packings) {
    const std::string file = mcap_file(messages, {.packing = packing, .finished = false});
    const BagOutcome outcome = outcome_of(read_mcap, file);
    EXPECT_EQ(outcome.messages, messages);
    EXPECT_EQ(outcome.complaint, "test.bag: at byte " + std::to_string(file.size()) +
                                     ": expected the end of a recording, found the end of the file: it was cut");
  }
}

TEST(Mcap, CutAnywhereHandsOutWhatIsWholeAndComplains) {
  const auto messages = example_messages(5, Serialization::cdr);
  for (const Packing packing : mcap_packings) {
    const std::string file = mcap_file(messages, {.packing = packing, .finished = false});
    std::size_t most = 0;
    for (std::size_t size = 0; size < file.size(); ++size) {
      const BagOutcome outcome = outcome_of(read_mcap, std::string_view(file).substr(0, size));
      ASSERT_THAT(outcome.complaint, HasSubstr("test.bag: at byte ")) << size;
      ASSERT_TRUE(are_some_of(outcome.messages, std::span(messages).first(outcome.messages.size()))) << size;
      ASSERT_GE(outcome.messages.size(), most) << size;
      most = outcome.messages.size();
    }
    EXPECT_EQ(most, 4U) << "all but those of the last record";
  }
}

TEST(Mcap, HandsOutNothingWrongFromChunksWithADamagedByte) {
  const auto messages = example_messages(5, Serialization::cdr);
  for (const Packing packing : {Packing::none, Packing::lz4, Packing::zstd}) {
    const std::string file = mcap_file(messages, {.packing = packing});
    for (std::size_t place = 0; place < file.size(); ++place) {
      for (const unsigned flip : {0x01U, 0x80U, 0xFFU}) {
        std::string damaged = file;
        damaged[place] = static_cast<char>(static_cast<unsigned char>(damaged[place]) ^ flip);
        ASSERT_TRUE(are_some_of(outcome_of(read_mcap, damaged).messages, messages)) << place;
      }
    }
  }
}

TEST(Mcap, SurvivesAnyDamagedByteOutsideOfChunks) {
  const auto messages = example_messages(5, Serialization::cdr);
  const std::string file = mcap_file(messages, {.packing = Packing::outside});
  for (std::size_t place = 0; place < file.size(); ++place) {
    for (const unsigned flip : {0x01U, 0x80U, 0xFFU}) {
      std::string damaged = file;
      damaged[place] = static_cast<char>(static_cast<unsigned char>(damaged[place]) ^ flip);
      ASSERT_LE(outcome_of(read_mcap, damaged).messages.size(), messages.size());
    }
  }
}

TEST(Mcap, TakesChannelsWithoutSchemaAndSkipsEncodingsItDoesNotKnow) {
  const std::string id = little_endian(std::uint16_t{1});
  const std::string none = little_endian(std::uint16_t{0});
  const auto channel = [&](std::string_view encoding) {
    return mcap_record('\x04', id + none + sized("/scan") + sized(encoding) + sized(""));
  };
  const std::string end = mcap_record('\x0F', std::string(4, '\0'));
  const BagOutcome outcome = outcome_of(
      read_mcap, mcap_start() + channel("cdr") + mcap_message("abc") + channel("json") + mcap_message("{}") + end);
  EXPECT_EQ(outcome.complaint, "");
  EXPECT_THAT(outcome.messages, testing::ElementsAre(BagMessage{"/scan", "", Serialization::cdr, "abc"}));
}

TEST(Mcap, SkipsRecordsOfUnknownKinds) {
  const auto messages = example_messages(3, Serialization::cdr);
  std::string file = mcap_file(messages);
  file.insert(mcap_start().size(),
              mcap_record('\x09', "an attachment") + mcap_record('\x80', "") + mcap_record('\0', "x"));
  const BagOutcome outcome = outcome_of(read_mcap, file);
  EXPECT_EQ(outcome.complaint, "");
  EXPECT_EQ(outcome.messages, messages);
}

TEST(Mcap, TakesChunksOfNothing) {
  const auto messages = example_messages(3, Serialization::cdr);
  for (const Packing packing : {Packing::none, Packing::lz4, Packing::zstd}) {
    std::string file = mcap_file(messages);
    file.insert(mcap_start().size(), mcap_chunk(packing_name(packing, ""), 0, 0, packed("", packing)));
    const BagOutcome outcome = outcome_of(read_mcap, file);
    EXPECT_EQ(outcome.complaint, "");
    EXPECT_EQ(outcome.messages, messages);
  }
}

TEST(Mcap, ReadsNothingAfterTheEndOfTheData) {
  const auto messages = example_messages(3, Serialization::cdr);
  const std::string file = mcap_file(messages);
  EXPECT_EQ(outcome_of(read_mcap, file + "anything").complaint, "");
  EXPECT_EQ(outcome_of(read_mcap, std::string_view(file).substr(0, file.size() - 8)).messages, messages);
}

TEST(Mcap, NamesTheFileAndTheByteOfWhatIsWrong) {
  const std::string at = "test.bag: at byte " + std::to_string(mcap_start().size()) + ": expected ";
  const auto complaint = [](const std::string& record) { return mcap_complaint(mcap_start() + record); };
  EXPECT_EQ(mcap_complaint(""),
            "test.bag: at byte 0: expected an MCAP file, which begins with MCAP0, found another file");
  EXPECT_EQ(complaint("\x05"), at + "8 bytes of a record, found 0: cut short or damaged");
  EXPECT_EQ(complaint("\x05" + std::string(8, '\xFF')),
            at + "18446744073709551615 bytes of a record, found 0: cut short or damaged");
  EXPECT_EQ(complaint(mcap_message("")), at + "a channel before its messages, found none for 1");
  EXPECT_EQ(complaint(mcap_record('\x05', "1")), at + "2 bytes of a message's channel, found 1: cut short or damaged");
  EXPECT_EQ(complaint(mcap_record('\x04', std::string(4, '\x07') + sized("") + sized("cdr") + sized(""))),
            at + "a schema before its channels, found none for 1799");
  EXPECT_EQ(complaint(mcap_chunk("", 3, 7, "abc")), at + "a chunk that its checksum fits, found damage");
  EXPECT_EQ(complaint(mcap_chunk("zstd", std::uint64_t{1} << 40U, 0, packed("", Packing::zstd))),
            at + "up to 4 GiB in a chunk, found 1099511627776 bytes announced");
  EXPECT_EQ(complaint(mcap_chunk("zstd", std::uint64_t{1} << 32U, 0, packed("little", Packing::zstd))),
            at + "4294967296 bytes in zstd data, found 6");
  const std::string zipped = packed("little", Packing::zstd);
  EXPECT_EQ(complaint(mcap_chunk("zstd", 6, 0, std::string_view(zipped).substr(0, zipped.size() - 1))),
            at + "6 bytes in zstd data, found data cut short");
  EXPECT_EQ(complaint(mcap_chunk("", mcap_chunk("", 0, 0, "").size(), 0, mcap_chunk("", 0, 0, ""))),
            at + "no chunk inside a chunk, found one");
}

TEST(Mcap, DoesNotTakeTheEndInsideAChunkForTheEndOfTheFile) {
  const std::string end = mcap_record('\x0F', std::string(4, '\0'));
  EXPECT_THAT(mcap_complaint(mcap_start() + mcap_chunk("", end.size(), 0, end)),
              HasSubstr("expected the end of a recording"));
}

}  // namespace
}  // namespace flirt
