// flirt/registration/local_map.hpp: a map of some scans that come and go, always ready for finding another scan in it.
//
//   LocalMap map;
//   map.add(points, map_from_robot);                       // a few dozen µs
//   const auto found = search_window(map, query, window);  // flirt/registration/window_search.hpp
//   map.remove(points, map_from_robot);                    // as if it had never been there, bit for bit
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/grid/tile_torus.hpp"
#include "flirt/registration/map_fields.hpp"
#include "flirt/registration/surface_points.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace flirt {

/// What the end points in one cell, and around it, amount to. All counts are whole numbers, so that adding and removing
/// cancel exactly.
struct SurfaceCell {
  std::uint32_t count{0};        ///< end points
  std::uint32_t x{0}, y{0};      ///< sums of their places from the lower corner, 1/1024 cell
  std::uint32_t rings{0};        ///< 4 bits a ring of cells around: occupied cells in it
  std::int32_t normals{0};       ///< points with a normal
  std::int32_t normal_xx{0};     ///< sum of cos 2φ, φ the direction of a normal, 1/1024
  std::int32_t normal_xy{0};     ///< sum of sin 2φ, 1/1024
  mutable LinePiece line{};      ///< through the points of this cell and its neighbours, when `has_line`
  mutable bool has_line{false};  ///< worked out when first asked for, dropped when a cell nearby changes

  /// Equal evidence.
  friend bool operator==(const SurfaceCell& a, const SurfaceCell& b) {
    return std::tie(a.count, a.x, a.y, a.rings, a.normals, a.normal_xx, a.normal_xy) ==
           std::tie(b.count, b.x, b.y, b.rings, b.normals, b.normal_xx, b.normal_xy);
  }
};

/// How often beams passed and ended.
struct PassCell {
  std::uint16_t hits{0};
  std::uint16_t passes{0};

  [[nodiscard]] bool solid() const { return hits >= 2 && hits >= passes; }
  [[nodiscard]] bool free() const { return passes > 0 && 20 * hits < 3 * (hits + passes); }
  friend bool operator==(const PassCell&, const PassCell&) = default;
};

/// How well a scan at a pose agrees with a map; each a mean over the points, 0..1.
struct Agreed {
  double likelihood{0};
  double free{0};     ///< end points where beams passed and nothing is near
  double unknown{0};  ///< end points where nothing was seen
  double through{0};  ///< beams that cross something solid
};

/// End points of scans as moments in cells of 0.1 m, how near the next of them is, and how often beams passed cells of
/// 0.05 m. Work and memory go with what the scans saw, not with the extent of the map; the map may be anywhere, but
/// what it holds at one time must lie within 200 m. Not for use from several threads.
class LocalMap {
 public:
  static constexpr double cell_size = 0.1;  ///< m

  LocalMap();

  /// O(points · cells a beam passes).
  void add(const SurfacePoints& points, const Pose2& map_from_robot);
  /// Takes back an earlier `add` of the same points at the same pose.
  void remove(const SurfacePoints& points, const Pose2& map_from_robot);
  [[nodiscard]] std::size_t scans() const { return scans_; }

  /// The line through the end points in the 3 × 3 cells around a place; null where there are none. Valid until the map
  /// changes.
  [[nodiscard]] const LinePiece* line_at(Point2 in_map) const;
  /// Whether beams passed a place and hardly any ended there.
  [[nodiscard]] bool is_free(Point2 in_map) const;
  /// Of one scan, or of several that are moved together, all in the frame of one robot. O(points · cells a beam
  /// passes).
  [[nodiscard]] Agreed agreement(std::span<const SurfacePoints> scans, const Pose2& map_from_robot) const;

  /// Values of cells (x, y), (x + 1, y), … for `row_length` cells: `largest` on end points, falling to 0 at 0.3 m.
  [[nodiscard]] const std::uint8_t* row(CellIndex first) const { return values() + row_begin(first); }
  static constexpr std::int32_t row_length = 32;
  static constexpr std::int32_t value_period = 2048;  ///< cells after which the place of values repeats
  /// The same in two steps: where all values lie, and where among them a row begins.
  [[nodiscard]] const std::uint8_t* values() const { return values_.data(); }
  static constexpr std::int32_t row_begin(CellIndex first) {
    constexpr std::int32_t mask = value_period - 1;
    return (first.y & mask) * (value_period + row_length) + (first.x & mask);
  }
  static constexpr std::uint8_t largest = 15;

  [[nodiscard]] const SurfaceCell& surface(CellIndex index) const { return surface_[index]; }
  [[nodiscard]] const PassCell& passes(CellIndex index) const { return passes_[index]; }
  [[nodiscard]] std::size_t bytes() const { return values_.size() + surface_.bytes() + passes_.bytes(); }

 private:
  enum class Change : std::uint8_t { add, remove };

  template <Change change>
  void count(const SurfacePoints& points, const Pose2& map_from_robot);
  template <Change change>
  void count_surface(Point2 in_map, Point2 normal);
  template <Change change>
  void count_passes(Point2 from, Point2 to);
  template <Change change>
  void stamp(CellIndex centre);
  [[nodiscard]] std::optional<LinePiece> line_around(CellIndex centre) const;
  void forget_lines_around(CellIndex centre);
  void set_value(CellIndex index, std::uint32_t rings);
  [[nodiscard]] int crossing_beams(const SurfacePoints& points, const Pose2& map_from_robot) const;

  TileTorus<SurfaceCell, 128> surface_;
  TileTorus<PassCell, 256> passes_;
  std::vector<std::uint8_t> values_;
  std::size_t scans_{0};
};

}  // namespace flirt
