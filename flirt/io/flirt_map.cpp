#include "flirt/io/flirt_map.hpp"

#include "flirt/io/feature_params_json.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/mapped_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {
namespace {

static_assert(std::endian::native == std::endian::little, "map files are used in place, so the machine must match");
static_assert(std::is_trivially_copyable_v<Pose2> && sizeof(Pose2) == 3 * sizeof(double));
static_assert(std::is_trivially_copyable_v<CellIndex> && sizeof(CellIndex) == 2 * sizeof(std::int32_t));
static_assert(std::is_trivially_copyable_v<EvidenceCell> && sizeof(EvidenceCell) == 2 * sizeof(std::uint16_t));
static_assert(std::is_trivially_copyable_v<Beams> && sizeof(Beams) == 4 * sizeof(double));

constexpr std::array<char, 8> magic{'F', 'L', 'I', 'R', 'T', 'M', 'A', 'P'};
constexpr std::uint32_t byte_order_mark = 0x01020304;
constexpr std::uint32_t version = 2;
constexpr std::size_t section_alignment = 64;
constexpr std::string_view shape_section = "descriptor_shape";
constexpr std::string_view params_section = "feature_params";
constexpr std::string_view evidence_params_section = "evidence_params";
constexpr std::string_view evidence_tiles_section = "evidence_tiles";
constexpr std::string_view evidence_cells_section = "evidence_cells";

struct Header {
  std::array<char, 8> magic_bytes{magic};
  std::uint32_t byte_order{byte_order_mark};
  std::uint32_t format_version{version};
  std::uint64_t file_bytes{0};
  std::uint32_t sections{0};
  std::uint32_t checksum{0};
};
static_assert(sizeof(Header) == 32);

enum SectionFlags : std::uint32_t { required = 0, optional = 1 };

struct SectionEntry {
  std::array<char, 24> name{};  ///< padded with zeros
  std::uint64_t offset{0};      ///< from the start of the file
  std::uint64_t bytes{0};
  std::uint32_t element_bytes{1};
  std::uint32_t flags{required};
};
static_assert(sizeof(SectionEntry) == 48);

std::string_view name_of(const SectionEntry& entry) {
  const auto* const end = std::find(entry.name.begin(), entry.name.end(), '\0');
  return {entry.name.data(), static_cast<std::size_t>(end - entry.name.begin())};
}

std::uint32_t checksum(std::span<const std::byte> file) {
  Header header;
  std::memcpy(&header, file.data(), sizeof header);
  header.checksum = 0;
  const auto* const rest = reinterpret_cast<const Bytef*>(file.data() + sizeof header);
  const uLong start = crc32_z(0, reinterpret_cast<const Bytef*>(&header), sizeof header);
  return static_cast<std::uint32_t>(crc32_z(start, rest, file.size() - sizeof header));
}

// Writing.

struct Section {
  std::string_view name;
  std::span<const std::byte> bytes;
  std::size_t element_bytes;
};

std::size_t aligned(std::size_t offset) {
  return (offset + section_alignment - 1) / section_alignment * section_alignment;
}

std::string assemble(std::span<const Section> sections) {
  std::vector<SectionEntry> table;
  std::size_t end = sizeof(Header) + sections.size() * sizeof(SectionEntry);
  for (const Section& section : sections) {
    SectionEntry entry{.offset = aligned(end),
                       .bytes = section.bytes.size(),
                       .element_bytes = static_cast<std::uint32_t>(section.element_bytes)};
    std::copy(section.name.begin(), section.name.end(), entry.name.begin());
    end = entry.offset + entry.bytes;
    table.push_back(entry);
  }
  std::string file(end, '\0');
  std::memcpy(file.data() + sizeof(Header), table.data(), table.size() * sizeof(SectionEntry));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    std::copy_n(reinterpret_cast<const char*>(sections[i].bytes.data()), sections[i].bytes.size(),
                file.data() + table[i].offset);
  }
  Header header{.file_bytes = end, .sections = static_cast<std::uint32_t>(sections.size())};
  std::memcpy(file.data(), &header, sizeof header);
  header.checksum = checksum(std::as_bytes(std::span(file)));
  std::memcpy(file.data(), &header, sizeof header);
  return file;
}

// Reading.

/// A table of sections in a file whose header and checksum are right.
class SectionReader {
 public:
  static Result<SectionReader> open(std::span<const std::byte> file);

  /// The values of a section, in place.
  template <class T>
  [[nodiscard]] Result<std::span<const T>> values(std::string_view name) {
    const auto entry = std::find_if(table_.begin(), table_.end(),
                                    [name](const SectionEntry& candidate) { return name_of(candidate) == name; });
    if (entry == table_.end()) { return fail("expected a section " + std::string(name) + ", found none"); }
    if (entry->element_bytes != sizeof(T) || entry->bytes % sizeof(T) != 0) {
      return fail("section " + std::string(name) + ": expected values of " + std::to_string(sizeof(T)) +
                  " bytes, found " + std::to_string(entry->bytes) + " bytes of values of " +
                  std::to_string(entry->element_bytes));
    }
    used_.emplace_back(name);
    return std::span(reinterpret_cast<const T*>(file_.data() + entry->offset), entry->bytes / sizeof(T));
  }

  /// The name of a section that was not asked for although it must not be skipped; empty when there is none.
  [[nodiscard]] std::string_view overlooked() const;

 private:
  SectionReader(std::span<const std::byte> file, std::vector<SectionEntry> table)
      : file_(file), table_(std::move(table)) {}
  std::span<const std::byte> file_;
  std::vector<SectionEntry> table_;
  std::vector<std::string> used_;
};

/// What is wrong with the header or the file as a whole; empty when nothing is.
std::string wrong_file(std::span<const std::byte> file) {
  Header header;
  if (file.size() < sizeof header) {
    return "expected a flirt map of " + std::to_string(sizeof header) + " bytes or more, found " +
           std::to_string(file.size()) + " bytes";
  }
  std::memcpy(&header, file.data(), sizeof header);
  if (header.magic_bytes != magic) { return "expected a flirt map, which begins with FLIRTMAP, found another file"; }
  if (header.byte_order == 0x04030201) { return "expected a little-endian map, found a big-endian one"; }
  if (header.byte_order != byte_order_mark) { return "expected a byte order mark, found damage"; }
  if (header.file_bytes != file.size()) {
    return "expected " + std::to_string(header.file_bytes) + " bytes, found " + std::to_string(file.size()) +
           ": the file was cut or damaged";
  }
  if (header.checksum != checksum(file)) { return "expected the checksum of the file to hold, found it damaged"; }
  if (header.format_version != version) {
    return "expected map format version " + std::to_string(version) + ", found " +
           std::to_string(header.format_version);
  }
  if (header.sections > (file.size() - sizeof header) / sizeof(SectionEntry)) {
    return "expected a table of sections, found " + std::to_string(header.sections) + " sections announced";
  }
  return {};
}

std::string wrong_table(std::span<const SectionEntry> table, std::size_t file_bytes) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    const SectionEntry& entry = table[i];
    const std::string where = "section " + std::to_string(i) + ": ";
    if (entry.offset % section_alignment != 0 || entry.offset > file_bytes || entry.bytes > file_bytes - entry.offset) {
      return where + "expected to lie within the file at a multiple of 64 bytes, found " + std::to_string(entry.bytes) +
             " bytes at " + std::to_string(entry.offset);
    }
    const auto same_name = [&entry](const SectionEntry& other) { return name_of(other) == name_of(entry); };
    if (std::any_of(table.begin(), table.begin() + static_cast<std::ptrdiff_t>(i), same_name)) {
      return where + "expected another name, found a second " + std::string(name_of(entry));
    }
  }
  return {};
}

Result<SectionReader> SectionReader::open(std::span<const std::byte> file) {
  if (const std::string wrong = wrong_file(file); !wrong.empty()) { return fail(wrong); }
  Header header;
  std::memcpy(&header, file.data(), sizeof header);
  std::vector<SectionEntry> table(header.sections);
  std::memcpy(table.data(), file.data() + sizeof header, table.size() * sizeof(SectionEntry));
  if (const std::string wrong = wrong_table(table, file.size()); !wrong.empty()) { return fail(wrong); }
  return SectionReader(file, std::move(table));
}

std::string_view SectionReader::overlooked() const {
  for (const SectionEntry& entry : table_) {
    const bool known = std::find(used_.begin(), used_.end(), name_of(entry)) != used_.end();
    if (!known && (entry.flags & optional) == 0) { return name_of(entry); }
  }
  return {};
}

Result<FeatureParams> parse_params(std::span<const char> text) {
  const auto json = nlohmann::ordered_json::parse(text.begin(), text.end(), nullptr, false);
  if (json.is_discarded()) { return fail("section feature_params: expected JSON, found something else"); }
  return feature_params_from_json(json);
}

/// What is wrong with the sections of the evidence; empty when nothing is.
std::string wrong_evidence(std::span<const double> params, std::span<const CellIndex> tiles,
                           std::span<const EvidenceCell> cells) {
  constexpr std::size_t cells_per_tile = std::size_t{EvidenceGrid::tile_side} * EvidenceGrid::tile_side;
  constexpr std::int32_t farthest = 1 << 24;
  if (params.size() != 3 || !out_of_range(EvidenceGridParams{params[0], params[1], params[2]}).empty()) {
    return "section evidence_params: expected cell size, range_min and range_max";
  }
  if (cells.size() != tiles.size() * cells_per_tile) {
    return "section evidence_cells: expected " + std::to_string(tiles.size() * cells_per_tile) + " cells, found " +
           std::to_string(cells.size());
  }
  const auto key = [](CellIndex tile) { return std::pair(tile.y, tile.x); };
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const CellIndex tile = tiles[i];
    if (std::abs(std::int64_t{tile.x}) > farthest || std::abs(std::int64_t{tile.y}) > farthest ||
        (i > 0 && key(tiles[i - 1]) >= key(tile))) {
      return "section evidence_tiles: expected tiles in order, each once, found another at " + std::to_string(i);
    }
  }
  return {};
}

Result<PlaceMap> parse_map(std::span<const std::byte> file, std::shared_ptr<const void> owner) {
  Result<SectionReader> reader = SectionReader::open(file);
  if (!reader) { return tl::unexpected(reader.error()); }
  std::string complaint;
  const auto read = [&]<class T>(std::string_view name, std::span<const T>& column) {
    const Result<std::span<const T>> values = reader->values<T>(name);
    if (values) {
      column = *values;
    } else if (complaint.empty()) {
      complaint = values.error().message;
    }
  };
  PlaceMapViews columns;
  std::span<const std::uint32_t> shape;
  std::span<const char> params_text;
  visit_columns(columns, read);
  read(shape_section, shape);
  read(params_section, params_text);
  std::span<const double> evidence_params;
  std::span<const CellIndex> evidence_tiles;
  std::span<const EvidenceCell> evidence_cells;
  read(evidence_params_section, evidence_params);
  read(evidence_tiles_section, evidence_tiles);
  read(evidence_cells_section, evidence_cells);
  if (!complaint.empty()) { return fail(complaint); }
  if (const std::string_view name = reader->overlooked(); !name.empty()) {
    return fail("expected only sections of version 2, found " + std::string(name) + ": a newer flirt can read it");
  }
  if (std::string wrong = wrong_evidence(evidence_params, evidence_tiles, evidence_cells); !wrong.empty()) {
    return fail(std::move(wrong));
  }
  if (shape.size() != 2) { return fail("section descriptor_shape: expected dimension and stride"); }
  const Result<FeatureParams> params = parse_params(params_text);
  if (!params) { return tl::unexpected(params.error()); }
  return PlaceMap::from_columns(
      columns, shape[0], shape[1], *params,
      EvidenceGrid({evidence_params[0], evidence_params[1], evidence_params[2]}, evidence_tiles, evidence_cells),
      std::move(owner));
}

}  // namespace

Result<void> write_place_map(const std::filesystem::path& path, const PlaceMap& map) {
  std::vector<Section> sections;
  visit_columns(map.columns(), [&sections]<class T>(std::string_view name, const std::span<const T>& column) {
    sections.push_back({name, std::as_bytes(column), sizeof(T)});
  });
  const std::array<std::uint32_t, 2> shape{map.descriptor_dimension(), map.descriptor_stride()};
  const std::string params = json_from_feature_params(map.feature_params()).dump();
  sections.push_back({shape_section, std::as_bytes(std::span(shape)), sizeof(std::uint32_t)});
  sections.push_back({params_section, std::as_bytes(std::span(params)), 1});
  const EvidenceGridParams& grid = map.evidence().params();
  const std::array<double, 3> evidence_params{grid.cell_size, grid.range_min, grid.range_max};
  const EvidenceGrid::SavedTiles evidence = map.evidence().save_tiles();
  sections.push_back({evidence_params_section, std::as_bytes(std::span(evidence_params)), sizeof(double)});
  sections.push_back({evidence_tiles_section, std::as_bytes(std::span(evidence.tiles)), sizeof(CellIndex)});
  sections.push_back({evidence_cells_section, std::as_bytes(std::span(evidence.cells)), sizeof(EvidenceCell)});
  return write_file_atomically(path, assemble(sections));
}

Result<PlaceMap> read_place_map(const std::filesystem::path& path) {
  Result<std::shared_ptr<const MappedFile>> file = MappedFile::open(path);
  if (!file) { return tl::unexpected(file.error()); }
  Result<PlaceMap> map = parse_map((*file)->bytes(), *file);
  if (!map) { return fail(path.string() + ": " + map.error().message); }
  return map;
}

}  // namespace flirt
