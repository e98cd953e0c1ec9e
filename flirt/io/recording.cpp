#include "flirt/io/recording.hpp"

#include "flirt/io/byte_reader.hpp"
#include "flirt/io/mapped_file.hpp"
#include "flirt/io/mcap.hpp"
#include "flirt/io/recording_file.hpp"
#include "flirt/io/rosbag1.hpp"
#include "flirt/io/rosbag2.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

namespace flirt::bag {
namespace {

namespace fs = std::filesystem;

enum class Container : std::uint8_t { rosbag1, mcap, sqlite };

std::optional<Container> container_of(std::span<const std::byte> bytes) {
  if (is_rosbag1(bytes)) { return Container::rosbag1; }
  if (is_mcap(bytes)) { return Container::mcap; }
  if (is_sqlite(bytes)) { return Container::sqlite; }
  return std::nullopt;
}

std::string name_of(Container container) {
  switch (container) {
    case Container::rosbag1:
      return "ROS 1 bag";
    case Container::mcap:
      return "MCAP";
    case Container::sqlite:
      break;
  }
  return "ROS 2 bag (sqlite3)";
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::optional<Container> container_at(const fs::path& path) {
  std::array<char, 16> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  return container_of(std::as_bytes(std::span(start).first(static_cast<std::size_t>(file.gcount()))));
}

Result<Container> read_one(const fs::path& path, const Sink& sink, const Progress& progress) {
  if (auto plain = require_plain_file(path); !plain) { return tl::unexpected(plain.error()); }
  const Result<std::shared_ptr<const MappedFile>> file = MappedFile::open(path);
  if (!file) { return tl::unexpected(file.error()); }
  const std::span<const std::byte> bytes = (*file)->bytes();
  const std::optional<Container> container = container_of(bytes);
  if (!container) {
    return fail(path.string() + ": expected a recording of ROS: a ROS 1 bag, MCAP or sqlite3, found another file");
  }
  const Result<void> read = *container == Container::rosbag1 ? read_rosbag1(path.string(), bytes, sink, progress)
                            : *container == Container::mcap  ? read_mcap(path.string(), bytes, sink, progress)
                                                             : read_sqlite_bag(path, sink, progress);
  if (!read) { return tl::unexpected(read.error()); }
  return *container;
}

}  // namespace

bool is_recording(const fs::path& path) {
  if (is_folder(path)) { return is_file(path / "metadata.yaml"); }
  return is_file(path) && (unpacked_name(path) || container_at(path));
}

Result<std::string> read_recording(const fs::path& path, const Sink& sink, const Progress& progress) {
  std::vector<fs::path> files{path};
  if (is_folder(path)) {
    Result<std::vector<fs::path>> listed = files_of_recording(path);
    if (!listed) { return tl::unexpected(listed.error()); }
    files = std::move(*listed);
  }
  std::string name;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto share = [&](double done) {
      progress((static_cast<double>(i) + done) / static_cast<double>(files.size()));
    };
    const Result<Container> container = read_one(files[i], sink, progress ? Progress(share) : Progress());
    if (!container) { return tl::unexpected(container.error()); }
    name = name_of(*container);
  }
  return name;
}

}  // namespace flirt::bag
