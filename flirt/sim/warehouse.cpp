#include "flirt/sim/warehouse.hpp"

#include "flirt/core/pose2.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/sim/office_room.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace flirt {
namespace {

/// Builds one hall, part by part.
class WarehouseBuilder {
 public:
  explicit WarehouseBuilder(const WarehouseParams& params)
      : params_(params),
        middle_(params.length / 2),
        visit_seed_(random_numbers(params.seed, Drawn::visit, params.visit).bits()) {}

  World build() && {
    add_dock_wall();
    add_bare_walls();
    add_office();
    for (double low = first_rack; low + rack_depth + overhang <= params_.width - far_clear;
         low += rack_depth + params_.aisle) {
      rack_rows_.push_back(low);
      add_posts(low);
    }
    for (const double low : rack_rows_) { add_pallets(low); }
    add_goods();
    add_places();
    return std::move(world_);
  }

 private:
  static constexpr double pillar_spacing = 6;  // m, from middle to middle
  static constexpr double pillar_width = 0.4;  // m, along the wall
  static constexpr double pillar_depth = 0.3;  // m, into the hall
  static constexpr double dock_width = 3.2;    // m, of a dock door
  static constexpr double dock_depth = 0.25;   // m, that it stands back
  static constexpr double dock_share = 0.6;    // of the bays between pillars, of those with a door
  static constexpr double first_rack = 5;      // m, from the dock wall to the first rack
  static constexpr double far_clear = 3;       // m, from the last rack to the wall, and between office and racks
  static constexpr double end_clear = 4;       // m, at both ends of the racks, at least
  static constexpr double cross_aisle = 4;     // m, clear
  static constexpr double bay_length = 2.75;   // m, from post to post
  static constexpr double post = 0.1;          // m, side of a post
  static constexpr double row_depth = 1.1;     // m, of one row of pallets
  static constexpr double row_gap = 0.2;       // m, between the two rows of a rack
  static constexpr double rack_depth = 2 * row_depth + row_gap;
  static constexpr double overhang = 0.11;      // m, by which pallets and posts may stand out of a rack
  static constexpr double pallet_width = 0.8;   // m, along the rack
  static constexpr double pallet_pitch = 0.9;   // m, from pallet to pallet
  static constexpr double goods_spacing = 5;    // m, about, between the goods on the floor
  static constexpr double goods_width = 0.8;    // m
  static constexpr double goods_depth = 1.2;    // m
  static constexpr double goods_low = 1.2;      // m, from the dock wall; goods lie wholly in between
  static constexpr double goods_high = 3.4;     // m
  static constexpr double spacing = 6;          // m, about, between places
  static constexpr double office_distance = 1;  // m, from the office to places, at least

  /// What random numbers are for: each has streams of its own.
  enum class Drawn : std::uint8_t { dock_wall, bare_walls, office, pallet, goods, visit };

  static Rng random_numbers(std::uint64_t seed, Drawn what, std::uint64_t index = 0) {
    return {seed, (static_cast<std::uint64_t>(what) << 56U) + index};
  }

  /// What `draw` makes of the numbers of a place, or of those of this visit if the place is one that changed.
  template <class Draw>
  auto drawn(Drawn what, std::uint64_t index, const Draw& draw) const {
    Rng later = random_numbers(visit_seed_, what, index);
    Rng first = random_numbers(params_.seed, what, index);
    return draw(later.uniform() < params_.changed ? later : first);
  }

  /// The middles of a wall's pillars, m from where it begins.
  static std::vector<double> pillars_along(double length, Rng& rng) {
    constexpr double least = 1;  // m of wall before a corner
    std::vector<double> pillars;
    for (double at = least + rng.uniform(0, pillar_spacing); at < length - least; at += pillar_spacing) {
      pillars.push_back(at);
    }
    return pillars;
  }

  void add_pillar(Point2 center, double width, double depth) { office::add_box(world_.plan, center, width, depth); }

  /// The wall at y = 0. Doors stand between pillars, in some of the bays, one at least.
  void add_dock_wall() {
    constexpr double jamb = 0.3;  // m of wall between pillar and door, at least
    Rng rng = random_numbers(params_.seed, Drawn::dock_wall);
    const std::vector<double> pillars = pillars_along(params_.length, rng);
    const std::size_t always = rng.below(static_cast<std::uint32_t>(pillars.size() - 1));
    std::vector<Point2> wall{{0, 0}};
    for (std::size_t i = 0; i + 1 < pillars.size(); ++i) {
      const double slack = pillars[i + 1] - pillars[i] - pillar_width - 2 * jamb - dock_width;
      const double near = pillars[i] + pillar_width / 2 + jamb + rng.uniform(0, slack);
      const double far = near + dock_width;
      if (rng.uniform() >= dock_share && i != always) { continue; }
      wall.insert(wall.end(), {{near, 0}, {near, -dock_depth}, {far, -dock_depth}, {far, 0}});
    }
    wall.push_back({params_.length, 0});
    for (std::size_t i = 1; i < wall.size(); ++i) { world_.plan.segments.push_back({wall[i - 1], wall[i]}); }
    for (const double x : pillars) { add_pillar({x, pillar_depth / 2}, pillar_width, pillar_depth); }
  }

  /// The walls without doors, each with pillars that begin elsewhere.
  void add_bare_walls() {
    Rng rng = random_numbers(params_.seed, Drawn::bare_walls);
    const double length = params_.length;
    const double width = params_.width;
    for (const double x : {0.0, length}) {
      const double center = x + (x == 0 ? 0.5 : -0.5) * pillar_depth;
      world_.plan.segments.push_back({{x, 0}, {x, width}});
      for (const double y : pillars_along(width, rng)) { add_pillar({center, y}, pillar_depth, pillar_width); }
    }
    world_.plan.segments.push_back({{0, width}, {length, width}});
    for (const double x : pillars_along(length, rng)) {
      add_pillar({x, width - pillar_depth / 2}, pillar_width, pillar_depth);
    }
  }

  /// The office in one of the far corners, its door in the wall towards the racks.
  void add_office() {
    constexpr double door = 1;    // m
    constexpr double jamb = 0.5;  // m of wall beside the door, at least
    Rng rng = random_numbers(params_.seed, Drawn::office);
    const double wide = rng.uniform(4.5, 5.5);
    const double front = params_.width - rng.uniform(3.5, 4.5);
    office_side_ = rng.uniform() < 0.5 ? -1 : 1;
    const double low = office_side_ < 0 ? 0.0 : params_.length - wide;
    const double high = low + wide;
    const double inner = office_side_ < 0 ? high : low;
    const double opening = low + rng.uniform(jamb, wide - jamb - door);
    office_ = {{low, front}, {high, params_.width}};
    world_.plan.segments.push_back({{low, front}, {opening, front}});
    world_.plan.segments.push_back({{opening + door, front}, {high, front}});
    world_.plan.segments.push_back({{inner, front}, {inner, params_.width}});
  }

  /// How many bays fit beside the cross aisle, to the left (`side` = −1) or right (1). The rack begins at y = `low`.
  [[nodiscard]] int bays_of(double low, double side) const {
    const bool at_office = side == office_side_ && low + rack_depth + far_clear > office_.low.y;
    const double kept_clear = at_office ? office_.width() + far_clear : end_clear;
    return std::max(0, static_cast<int>((middle_ - cross_aisle / 2 - post - kept_clear) / bay_length));
  }

  /// The x of a rack's post, `bays` (a half: the middle of a bay) from the cross aisle.
  [[nodiscard]] double x_of_bay(double bays, double side) const {
    return middle_ + side * (cross_aisle / 2 + post / 2 + bays * bay_length);
  }

  void add_posts(double low) {
    for (const double side : {-1.0, 1.0}) {
      const int bays = bays_of(low, side);
      for (int i = 0; bays > 0 && i <= bays; ++i) {
        for (const double y : {low, low + row_depth, low + row_depth + row_gap, low + rack_depth}) {
          office::add_box(world_.plan, {x_of_bay(i, side), y}, post, post);
        }
      }
    }
  }

  void add_pallets(double low) {
    for (const double side : {-1.0, 1.0}) {
      const int bays = bays_of(low, side);
      for (int bay = 0; bay < bays; ++bay) {
        for (const double y : {low + row_depth / 2, low + rack_depth - row_depth / 2}) {
          for (const int k : {-1, 0, 1}) { add_pallet({x_of_bay(bay + 0.5, side) + k * pallet_pitch, y}); }
        }
      }
    }
  }

  void add_pallet(Point2 middle) {
    constexpr double jitter_along = 0.05;   // m, to both sides
    constexpr double jitter_across = 0.08;  // m
    constexpr double turn = 0.02;           // rad, standard deviation
    const auto pallet = drawn(Drawn::pallet, pallet_places_++, [&](Rng& rng) -> std::optional<Pose2> {
      if (rng.uniform() >= params_.filled) { return std::nullopt; }
      const double x = middle.x + rng.uniform(-jitter_along, jitter_along);
      const double y = middle.y + rng.uniform(-jitter_across, jitter_across);
      return Pose2{x, y, std::clamp(rng.normal(0, turn), -3 * turn, 3 * turn)};
    });
    if (pallet) { office::add_box(world_.plan, pallet->translation(), pallet_width, row_depth, pallet->theta); }
  }

  /// Goods on the floor before the docks, each within a stretch of its own.
  void add_goods() {
    constexpr double margin = 1;  // m to the side walls
    const double count = std::floor(params_.length / goods_spacing);
    const double stretch = (params_.length - 2 * margin) / count;
    for (double i = 0; i < count; ++i) {
      const Pose2 goods = drawn(Drawn::goods, static_cast<std::uint64_t>(i), [&](Rng& rng) {
        const double angle = rng.uniform(0, std::numbers::pi);
        const double c = std::abs(std::cos(angle));
        const double s = std::abs(std::sin(angle));
        const double half_width = (c * goods_width + s * goods_depth) / 2;
        const double half_depth = (s * goods_width + c * goods_depth) / 2;
        const double begin = margin + i * stretch;
        const double x = rng.uniform(begin + half_width, begin + stretch - half_width);
        return Pose2{x, rng.uniform(goods_low + half_depth, goods_high - half_depth), angle};
      });
      office::add_box(world_.plan, goods.translation(), goods_width, goods_depth, goods.theta);
    }
  }

  /// Along each aisle and the dock zone's edge, from the middle of one end to that of the other.
  void add_places() {
    std::vector<double> lanes{(goods_high + first_rack - overhang) / 2};
    for (std::size_t i = 1; i < rack_rows_.size(); ++i) { lanes.push_back(rack_rows_[i] - params_.aisle / 2); }
    lanes.push_back((rack_rows_.back() + rack_depth + params_.width) / 2);
    const double rack_end = x_of_bay(bays_of(first_rack, -office_side_), -1) - post / 2;
    const double reach = middle_ - rack_end / 2;
    const double steps = std::max(1.0, std::round(reach / spacing));
    for (const double y : lanes) {
      for (double i = -steps; i <= steps; ++i) {
        const Point2 place{middle_ + i / steps * reach, y};
        if (!is_at_office(place)) { world_.places.push_back(place); }
      }
    }
  }

  [[nodiscard]] bool is_at_office(Point2 point) const {
    return point.x > office_.low.x - office_distance && point.x < office_.high.x + office_distance &&
           point.y > office_.low.y - office_distance;
  }

  WarehouseParams params_;
  double middle_;  // m, x of the cross aisle
  std::uint64_t visit_seed_;
  World world_{};
  Rectangle office_{};
  double office_side_{0};            // −1: at the left, 1: at the right
  std::vector<double> rack_rows_{};  // m, where each begins in y
  std::uint64_t pallet_places_{0};   // so far
};

}  // namespace

World make_warehouse(const WarehouseParams& params) {
  return WarehouseBuilder(params).build();
}

}  // namespace flirt
