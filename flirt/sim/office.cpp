#include "flirt/sim/office.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/sim/office_room.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace flirt {
namespace {

using office::Outside;
using office::RoomKind;
using office::RoomSite;
using office::wall;

/// A corridor from end to end of the building, with its rooms to both sides.
struct Row {
  double south_face;   ///< m, y of the corridor's southern wall
  double north_face;   ///< m
  double south_depth;  ///< m, of the rooms
  double north_depth;  ///< m
};

/// A stretch of a cross corridor between two rows.
struct Crossing {
  std::size_t row;  ///< joins this row and the next
  double west;      ///< m
  double east;      ///< m
};

struct Layout {
  double width{0};  ///< m, east to west
  std::vector<Row> rows{};
  std::vector<Crossing> crossings{};
};

std::vector<Row> make_rows(const OfficeParams& params, std::size_t count, Rng& rng) {
  std::vector<Row> rows;
  double y = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double south = params.room_depth * rng.uniform(0.8, 1.25);
    const double north = params.room_depth * rng.uniform(0.8, 1.25);
    const double corridor = params.corridor_width * rng.uniform(0.85, 1.25);
    rows.push_back({y + south, y + south + corridor, south, north});
    y += south + corridor + north;
  }
  return rows;
}

/// Cross corridors about every 45 m; some miss a stretch, but no two rows stay without a link.
std::vector<Crossing> make_crossings(const OfficeParams& params, std::size_t rows, double width, Rng& rng) {
  constexpr double spacing = 45.0;
  const auto count = static_cast<std::size_t>(std::max(2.0, std::round(width / spacing)));
  std::vector<Crossing> crossings;
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    const std::size_t kept = rng.below(static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
      // The same place in all rows but for a step now and then.
      Rng at(params.seed, 1000 + i);
      const double step = rng.uniform() < 0.25 ? rng.uniform(-4.0, 4.0) : 0.0;
      const double missing = rng.uniform();
      const double slot = width / static_cast<double>(count);
      const double middle = (static_cast<double>(i) + at.uniform(0.3, 0.7)) * slot + step;
      const double half = params.corridor_width * at.uniform(0.8, 1.1) / 2;
      if (i == kept || missing > 0.2) { crossings.push_back({row, middle - half, middle + half}); }
    }
  }
  return crossings;
}

Layout make_layout(const OfficeParams& params, Rng& rng) {
  const double row_height = 2 * params.room_depth * 1.025 + params.corridor_width * 1.05;
  const double shape = 1.6;  // width per height of large buildings
  const double rows = std::max(1.0, std::round(std::sqrt(params.area / shape) / row_height));
  Layout layout;
  layout.rows = make_rows(params, static_cast<std::size_t>(rows), rng);
  layout.width = params.area / (layout.rows.back().north_face + layout.rows.back().north_depth);
  layout.crossings = make_crossings(params, layout.rows.size(), layout.width, rng);
  return layout;
}

/// One side of a corridor: where its rooms stand.
struct Band {
  double face;     ///< m, y of the corridor's wall
  double inwards;  ///< plan y per m into the rooms, ±1
  double depth;    ///< m
  Outside back;
};

RoomKind draw_kind(double width, Rng& rng) {
  const double draw = rng.uniform();
  if (width < 3.0) { return RoomKind::storage; }
  if (width > 6.5) { return draw < 0.4 ? RoomKind::meeting : RoomKind::workshop; }
  if (draw < 0.72) { return RoomKind::study; }
  if (draw < 0.82) { return RoomKind::meeting; }
  return draw < 0.93 ? RoomKind::workshop : RoomKind::lounge;
}

double draw_width(const OfficeParams& params, Rng& rng) {
  const double draw = rng.uniform();
  const double mean = params.room_width;
  if (draw < 0.1) { return std::max(2.0, mean * rng.uniform(0.5, 0.65)); }
  if (draw < 0.85) { return mean * rng.uniform(0.72, 1.25); }
  return mean * rng.uniform(1.6, 2.6);
}

/// Fills the band from `west` to `east` with rooms.
void add_rooms(const Band& band, double west, double east, const OfficeParams& params, Rng& rng, World& world) {
  const double narrowest = std::max(2.0, params.room_width * 0.45);
  std::optional<RoomSite> last;
  for (double x = west; x < east - 1e-9;) {
    RoomSite site{.origin = {x, band.face},
                  .inwards = band.inwards,
                  .width = draw_width(params, rng),
                  .depth = band.depth,
                  .back = band.back,
                  .seed = rng.bits(),
                  .number = world.places.size()};
    site.kind = draw_kind(site.width, rng);
    if (last && rng.uniform() < params.twin_rooms) {
      site.width = last->width;
      site.kind = last->kind;
      site.seed = last->seed;
    }
    if (east - x - site.width < narrowest) {
      site.width = east - x;
      if (site.width < 3.0 || site.width > 6.5) { site.kind = draw_kind(site.width, rng); }
    }
    x += site.width;
    last = site;
    add_room(site, params, world);
  }
}

/// The band's rooms between the openings of the cross corridors, which are in order from west to east.
void add_band(const Band& band, std::span<const Crossing> openings, const Layout& layout, const OfficeParams& params,
              Rng& rng, World& world) {
  double west = 0;
  for (const Crossing& opening : openings) {
    add_rooms(band, west, opening.west, params, rng, world);
    west = opening.east;
  }
  add_rooms(band, west, layout.width, params, rng, world);
}

/// Where a thing that stood at `place` along a corridor stands now, m: somewhat aside, or nowhere.
std::optional<double> place_now(double place, const OfficeParams& params, Rng& changes) {
  constexpr double carried_away = 0.25;
  if (changes.uniform() >= params.changed) { return place; }
  if (changes.uniform() < carried_away) { return std::nullopt; }
  return place + changes.uniform(-0.6, 0.6);
}

/// The walls between two corridors to both sides of a cross corridor, and what stands along them.
void add_crossing(const Layout& layout, const Crossing& crossing, const OfficeParams& params, Rng& rng, Rng& changes,
                  World& world) {
  const double south = layout.rows[crossing.row].north_face;
  const double north = layout.rows[crossing.row + 1].south_face;
  for (const double x : {crossing.west, crossing.east}) {
    world.plan.segments.push_back({{x, south}, {x, north}, Material::solid});
    const double away = x == crossing.west ? 1 : -1;  // from the wall into the corridor
    for (double y = south + rng.uniform(0.8, 3.5); y < north - 1.5; y += rng.uniform(2.0, 6.0)) {
      if (rng.uniform() > params.furniture * 0.7) { continue; }
      const double depth = rng.uniform(0.12, 0.4);
      const double length = rng.uniform(0.3, 1.2);
      if (const auto now = place_now(y, params, changes)) {
        office::add_box(world.plan, {x + away * depth / 2, *now + length / 2}, depth, length);
      }
    }
  }
  const double middle = (crossing.west + crossing.east) / 2;
  for (const double share : {0.0, 0.5, 1.0}) { world.places.push_back({middle, south + share * (north - south)}); }
}

/// The ends of a corridor: a wall or a window.
void add_ends(const Row& row, const Layout& layout, const OfficeParams& params, Rng& rng, World& world) {
  for (const double x : {0.0, layout.width}) {
    const Material material = rng.uniform() < 2 * params.glass_fronts ? Material::glass : Material::solid;
    world.plan.segments.push_back({{x, row.south_face}, {x, row.north_face}, material});
  }
}

/// Things along a corridor: frames of fire doors, cabinets, plants, niches' corners.
void add_corridor_things(const Row& row, std::span<const Crossing> openings, const Layout& layout,
                         const OfficeParams& params, Rng& rng, Rng& changes, World& world) {
  const double width = row.north_face - row.south_face;
  for (double x = rng.uniform(1.0, 6.0); x < layout.width - 1.0; x += rng.uniform(2.5, 9.0)) {
    const bool at_opening = std::any_of(openings.begin(), openings.end(), [&](const Crossing& crossing) {
      return x > crossing.west - 1.5 && x < crossing.east + 1.5;
    });
    const double kind = rng.uniform();
    const double size = rng.uniform();
    const bool is_south = rng.uniform() < 0.5;
    if (at_opening) { continue; }
    const double face = is_south ? row.south_face : row.north_face;
    const double away = is_south ? 1 : -1;
    if (kind < 0.3) {  // a frame: two stubs, opposite each other
      const double stub = std::min(0.15 + 0.2 * size, (width - 1.3) / 2);
      office::add_box(world.plan, {x, row.south_face + stub / 2}, 0.12, stub);
      office::add_box(world.plan, {x, row.north_face - stub / 2}, 0.12, stub);
      continue;
    }
    const auto now = place_now(x, params, changes);
    if (!now) { continue; }
    if (kind < 0.3 + 0.5 * params.furniture) {
      const double depth = std::min(0.25 + 0.25 * size, width - 1.4);
      office::add_box(world.plan, {*now, face + away * depth / 2}, 0.6 + size, depth);
    } else if (kind < 0.3 + 0.7 * params.furniture) {
      const double radius = std::min(0.12 + 0.13 * size, (width - 1.4) / 2);
      world.plan.discs.push_back({{*now, face + away * radius}, radius});
    }
  }
  for (double x = 2.0; x < layout.width - 1.0; x += 8.0) {
    world.places.push_back({x, (row.south_face + row.north_face) / 2});
  }
}

}  // namespace

World make_office(const OfficeParams& params) {
  Rng rng(params.seed);
  Rng changes(params.visit, ~params.seed);  // rooms have streams of their own
  const Layout layout = make_layout(params, rng);
  World world;
  const std::size_t last = layout.rows.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const Row& row = layout.rows[i];
    std::vector<Crossing> south;
    std::vector<Crossing> north;
    for (const Crossing& crossing : layout.crossings) {
      if (crossing.row + 1 == i) { south.push_back(crossing); }
      if (crossing.row == i) { north.push_back(crossing); }
    }
    const Band southern{row.south_face, -1, row.south_depth, i == 0 ? Outside::yes : Outside::no};
    const Band northern{row.north_face, 1, row.north_depth, i == last ? Outside::yes : Outside::no};
    add_band(southern, south, layout, params, rng, world);
    add_band(northern, north, layout, params, rng, world);
    add_ends(row, layout, params, rng, world);
    std::vector<Crossing> openings = south;
    openings.insert(openings.end(), north.begin(), north.end());
    add_corridor_things(row, openings, layout, params, rng, changes, world);
  }
  for (const Crossing& crossing : layout.crossings) { add_crossing(layout, crossing, params, rng, changes, world); }
  return world;
}

}  // namespace flirt
