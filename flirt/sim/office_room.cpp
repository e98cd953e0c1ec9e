#include "flirt/sim/office_room.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace flirt::office {
namespace {

constexpr double half_turn = std::numbers::pi;
constexpr double gap = 0.04;  // m, kept between pieces of furniture

/// Puts things into one room, in the room's own coordinates.
class Furnisher {
 public:
  Furnisher(const RoomSite& site, const OfficeParams& params, World& world)
      : site_(site), params_(params), plan_(world.plan), rng_(site.seed), changes_(params.visit, site.number) {
    inside_ = {{wall / 2, wall}, {site.width - wall / 2, site.depth - wall / 2}};
  }

  void build() {
    if (site_.kind == RoomKind::lounge) {
      add_open_front();
    } else {
      add_front_with_door();
    }
    add_sides_and_back();
    furnish();
    rearrange();
  }

 private:
  /// What stands or falls together: some of the plan's newest segments and discs.
  struct Piece {
    std::size_t first_segment;
    std::size_t segments;
    std::size_t first_disc;
    std::size_t discs;
  };

  [[nodiscard]] Point2 in_plan(Point2 local) const {
    return site_.origin + Point2{site_.right * local.x, site_.inwards * local.y};
  }
  [[nodiscard]] Point2 in_room(Point2 in_plan) const {
    return {site_.right * (in_plan.x - site_.origin.x), site_.inwards * (in_plan.y - site_.origin.y)};
  }
  void line(Point2 a, Point2 b, Material material = Material::solid) {
    plan_.segments.push_back({in_plan(a), in_plan(b), material});
  }
  void disc(Point2 center, double radius) { plan_.discs.push_back({in_plan(center), radius}); }
  void box(const Rectangle& area) {
    line(area.low, {area.high.x, area.low.y});
    line({area.high.x, area.low.y}, area.high);
    line(area.high, {area.low.x, area.high.y});
    line({area.low.x, area.high.y}, area.low);
  }

  void add_open_front() {
    const double stub = rng_.uniform(0.2, 0.6);
    for (const double end : {0.0, site_.width}) {
      const double inner = end == 0 ? stub : site_.width - stub;
      line({end, 0}, {inner, 0});
      line({inner, 0}, {inner, wall});
      line({inner, wall}, {end == 0 ? inside_.low.x : inside_.high.x, wall});
    }
    keep_free({{0.6, 0}, {site_.width - 0.6, 1.2}});
  }

  void add_front_with_door() {
    const double door_width = rng_.uniform(0.9, 1.05);
    const double shortest = inside_.low.x + 0.15;
    const double longest = inside_.high.x - 0.15 - door_width;
    const double place = rng_.uniform();  // doors prefer a corner of the room
    const double hinge = place < 0.4   ? shortest + rng_.uniform(0, 0.3)
                         : place < 0.8 ? longest - rng_.uniform(0, 0.3)
                                       : rng_.uniform(shortest, longest);
    const double left = std::clamp(hinge, shortest, longest);
    const double right = left + door_width;
    line({0, 0}, {left, 0}, pane(left));
    line({right, 0}, {site_.width, 0}, pane(site_.width - right));
    line({inside_.low.x, wall}, {left, wall}, pane(left));
    line({right, wall}, {inside_.high.x, wall}, pane(site_.width - right));
    line({left, 0}, {left, wall});
    line({right, 0}, {right, wall});
    add_door_leaf(left, right);
    keep_free({{left - 0.15, 0}, {right + 0.15, wall + door_width + 0.25}});
  }

  /// Glass for the wider part of a front, in some rooms.
  [[nodiscard]] Material pane(double width) const {
    const bool has_glass = Rng(site_.seed, 1).uniform() < params_.glass_fronts && site_.kind != RoomKind::storage;
    return has_glass && width > site_.width / 2 ? Material::glass : Material::solid;
  }

  /// Angle of a door leaf, rad; 0: closed.
  [[nodiscard]] double opening(double state, double swing) const {
    if (state < params_.open_doors) { return half_turn / 2 + swing * 0.3; }
    return state < params_.open_doors + params_.half_open_doors ? 0.3 + swing * 0.8 : 0;
  }

  void add_door_leaf(double left, double right) {
    const bool hinge_left = rng_.uniform() < 0.5;
    const double state = rng_.uniform();
    const double swing = rng_.uniform();
    double angle = opening(state, swing);
    double recess = angle == 0 ? rng_.uniform(0.03, wall - 0.03) : 0;  // closed leaves stand within the wall
    if (has_changed()) {
      const double new_state = changes_.uniform();
      angle = opening(new_state, changes_.uniform());
      recess = changes_.uniform(0.03, wall - 0.03);
    }
    const Point2 hinge{hinge_left ? left : right, wall};
    const double width = right - left - 0.01;
    const double aside = (hinge_left ? 1 : -1) * std::cos(angle);
    if (angle == 0) {
      line({left, recess}, {right, recess});
      return;
    }
    Point2 tip = hinge + width * Point2{aside, std::sin(angle)};
    tip.x = std::clamp(tip.x, inside_.low.x + 0.02, inside_.high.x - 0.02);
    line(hinge, tip);
  }

  void add_sides_and_back() {
    line({inside_.low.x, wall}, {inside_.low.x, inside_.high.y});
    line({inside_.high.x, wall}, {inside_.high.x, inside_.high.y});
    const bool window = site_.back == Outside::yes && Rng(site_.seed, 2).uniform() < params_.glass_fronts;
    const double begin = window ? site_.width * 0.2 : site_.width;
    const double end = window ? site_.width * 0.8 : site_.width;
    const double y = inside_.high.y;
    if (!window) {
      line({inside_.low.x, y}, {inside_.high.x, y});
      add_pilaster();
      return;
    }
    line({inside_.low.x, y}, {begin, y});
    line({begin, y}, {end, y}, Material::glass);
    line({end, y}, {inside_.high.x, y});
  }

  /// A pillar or duct that stands out from the back wall of some rooms.
  void add_pilaster() {
    if (rng_.uniform() > 0.35) { return; }
    const double width = rng_.uniform(0.3, 0.7);
    const double x = rng_.uniform() < 0.6 ? inside_.low.x : rng_.uniform(inside_.low.x, inside_.high.x - width);
    const Rectangle area{{x, inside_.high.y - rng_.uniform(0.15, 0.5)}, {x + width, inside_.high.y}};
    if (claim(area)) { box(area); }
  }

  // Furniture. Pieces claim a rectangle, chairs included, that no other piece may touch.
  void keep_free(const Rectangle& area) { taken_.push_back(area); }
  [[nodiscard]] bool lies_inside(const Rectangle& area) const {
    constexpr double rounding = 1e-9;
    return area.low.x >= inside_.low.x - rounding && area.low.y >= inside_.low.y - rounding &&
           area.high.x <= inside_.high.x + rounding && area.high.y <= inside_.high.y + rounding;
  }
  [[nodiscard]] static bool touch(const Rectangle& a, const Rectangle& b) {
    return a.low.x < b.high.x + gap && b.low.x < a.high.x + gap && a.low.y < b.high.y + gap && b.low.y < a.high.y + gap;
  }
  [[nodiscard]] bool claim(const Rectangle& area) {
    const bool is_taken = std::ranges::any_of(taken_, [&](const Rectangle& other) { return touch(area, other); });
    if (!lies_inside(area) || is_taken) { return false; }
    taken_.push_back(area);
    return true;
  }
  void try_box(const Rectangle& area) {
    if (claim(area)) {
      add_piece([&] { box(area); });
    }
  }

  /// What `draw` adds to the plan is one piece.
  template <class Draw>
  void add_piece(const Draw& draw) {
    const std::size_t segments = plan_.segments.size();
    const std::size_t discs = plan_.discs.size();
    draw();
    pieces_.push_back({segments, plan_.segments.size() - segments, discs, plan_.discs.size() - discs});
  }

  /// A rectangle of `along` × `across` m with its back to one of the walls: 0 left, 1 back, 2 right, 3 front.
  [[nodiscard]] Rectangle at_wall(std::uint32_t side, double along, double across) {
    const double run = (side % 2 == 0 ? inside_.height() : inside_.width()) - along;
    const double ends = rng_.uniform();  // furniture gathers in corners
    const double start = std::max(0.0, run) * (ends < 0.3 ? 0.0 : ends < 0.6 ? 1.0 : rng_.uniform());
    switch (side) {
      case 0:
        return {{inside_.low.x, inside_.low.y + start}, {inside_.low.x + across, inside_.low.y + start + along}};
      case 1:
        return {{inside_.low.x + start, inside_.high.y - across}, {inside_.low.x + start + along, inside_.high.y}};
      case 2:
        return {{inside_.high.x - across, inside_.low.y + start}, {inside_.high.x, inside_.low.y + start + along}};
      default:
        return {{inside_.low.x + start, inside_.low.y}, {inside_.low.x + start + along, inside_.low.y + across}};
    }
  }

  void add_cabinet(double shortest, double longest) {
    const double depth = rng_.uniform(0.3, 0.5);
    const double length = rng_.uniform(shortest, longest);
    const std::uint32_t side = rng_.below(4);
    try_box(at_wall(side, length, depth));
  }

  void add_chair(Point2 center) {
    const double angle = rng_.uniform(0, 2 * half_turn);
    const bool swivels = rng_.uniform() < 0.4;
    add_piece([&] {
      if (swivels) {  // its column and the five castors
        disc(center, 0.03);
        for (int i = 0; i < 5; ++i) { disc(center + around(angle + i * 0.4 * half_turn, 0.3), 0.025); }
      } else {
        for (int i = 0; i < 4; ++i) { disc(center + around(angle + (i + 0.5) * half_turn / 2, 0.28), 0.015); }
      }
    });
  }
  [[nodiscard]] static Point2 around(double angle, double radius) {
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

  void add_table(const Rectangle& top) {
    constexpr double inset = 0.06;
    for (const double x : {top.low.x + inset, top.high.x - inset}) {
      for (const double y : {top.low.y + inset, top.high.y - inset}) { disc({x, y}, 0.03); }
    }
  }

  /// A desk at a wall, drawers below it or a panel behind, and a chair before it.
  void add_desk() {
    const std::uint32_t side = rng_.below(3);
    const double length = rng_.uniform(1.3, 1.8);
    const double depth = rng_.uniform(0.7, 0.85);
    constexpr double chair_space = 0.75;
    const Rectangle area = at_wall(side, length, depth + chair_space);
    const double extras = rng_.uniform();
    const bool drawers_first = rng_.uniform() < 0.5;
    const double chair_at = rng_.uniform(0.35, 0.65);
    if (!claim(area)) { return; }
    // In coordinates of the desk: u along the wall, v away from it.
    const auto at = [&](double u, double v) -> Point2 {
      if (side == 0) { return {area.low.x + v, area.low.y + u}; }
      if (side == 1) { return {area.low.x + u, area.high.y - v}; }
      return {area.high.x - v, area.low.y + u};
    };
    const auto between = [](Point2 a, Point2 b) -> Rectangle {
      return {{std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}};
    };
    add_piece([&] {
      add_table(between(at(0, 0), at(length, depth)));
      if (extras < 0.6) {
        const double u = drawers_first ? 0.1 : length - 0.54;
        box(between(at(u, depth - 0.62), at(u + 0.44, depth - 0.02)));
      } else if (extras < 0.8) {
        line(at(0.05, depth - 0.3), at(length - 0.05, depth - 0.3));
      }
    });
    add_chair(at(chair_at * length, depth + 0.4));
  }

  /// A table in the middle with chairs around.
  void add_meeting_table() {
    const double length = std::min(inside_.width() - 2.6, rng_.uniform(1.8, 4.0));
    const double depth = std::min(inside_.height() - 2.8, rng_.uniform(1.0, 1.4));
    if (length < 1.2 || depth < 0.8) { return; }
    const Point2 center{(inside_.low.x + inside_.high.x) / 2 + rng_.uniform(-0.2, 0.2),
                        (inside_.low.y + inside_.high.y) / 2 + rng_.uniform(-0.1, 0.3)};
    const Rectangle top{center - Point2{length / 2, depth / 2}, center + Point2{length / 2, depth / 2}};
    const Rectangle with_chairs{top.low - Point2{0.5, 0.5}, top.high + Point2{0.5, 0.5}};
    if (!claim(with_chairs)) { return; }
    add_piece([&] { add_table(top); });
    for (double x = top.low.x + 0.4; x < top.high.x - 0.2; x += 0.75) {
      for (const double y : {top.low.y - 0.15, top.high.y + 0.15}) {
        if (rng_.uniform() < 0.85) { add_chair({x + rng_.uniform(-0.1, 0.1), y + rng_.uniform(-0.1, 0.1)}); }
      }
    }
  }

  void add_workbench() {
    const double length = rng_.uniform(1.6, 3.0);
    const double depth = rng_.uniform(0.7, 1.0);
    const Point2 low{rng_.uniform(inside_.low.x + 1.0, std::max(inside_.low.x + 1.0, inside_.high.x - 1.0 - length)),
                     rng_.uniform(inside_.low.y + 1.2, std::max(inside_.low.y + 1.2, inside_.high.y - 1.0 - depth))};
    const Rectangle top{low, low + Point2{length, depth}};
    if (!claim(top)) { return; }
    if (rng_.uniform() < 0.5) {
      add_piece([&] { box(top); });
    } else {
      add_piece([&] { add_table(top); });
      add_chair({rng_.uniform(top.low.x + 0.3, top.high.x - 0.3), top.high.y - 0.1});
    }
  }

  void add_column() {
    const double radius = rng_.uniform(0.18, 0.35);
    const Point2 center{rng_.uniform(inside_.low.x + 0.8, inside_.high.x - 0.8),
                        rng_.uniform(inside_.low.y + 1.2, inside_.high.y - 0.8)};
    if (claim({center - Point2{radius, radius}, center + Point2{radius, radius}})) { disc(center, radius); }
  }

  /// Something small that stands about: a bin, a plant, a carton.
  void add_odd_piece() {
    const double size = rng_.uniform(0.12, 0.3);
    const Rectangle area = at_wall(rng_.below(4), 2 * size, 2 * size);
    const bool is_round = rng_.uniform() < 0.6;
    const double angle = rng_.uniform(0, half_turn);
    if (!claim(area)) { return; }
    const Point2 center = 0.5 * (area.low + area.high);
    add_piece([&] {
      if (is_round) {
        disc(center, size * 0.9);
      } else {
        add_box(plan_, in_plan(center), size * 1.3, size * 1.2, site_.right * site_.inwards * angle);
      }
    });
  }

  [[nodiscard]] int pieces(double per_square_metre) {
    const double mean = per_square_metre * params_.furniture * inside_.width() * inside_.height();
    return static_cast<int>(std::floor(mean + rng_.uniform()));
  }

  void furnish() {
    const double area = inside_.width() * inside_.height();
    if (area > 45 && params_.furniture > 0) { add_column(); }
    switch (site_.kind) {
      case RoomKind::study:
        for (int i = pieces(0.16); i > 0; --i) { add_desk(); }
        for (int i = pieces(0.14); i > 0; --i) { add_cabinet(0.8, 1.8); }
        break;
      case RoomKind::meeting:
        if (params_.furniture > 0) { add_meeting_table(); }
        for (int i = pieces(0.05); i > 0; --i) { add_cabinet(1.0, 2.4); }
        break;
      case RoomKind::workshop:
        for (int i = pieces(0.06); i > 0; --i) { add_workbench(); }
        for (int i = pieces(0.10); i > 0; --i) { add_cabinet(0.8, 2.6); }
        for (int i = pieces(0.06); i > 0; --i) { add_desk(); }
        break;
      case RoomKind::storage:
        for (int i = pieces(0.5); i > 0; --i) { add_cabinet(0.8, 2.2); }
        break;
      case RoomKind::lounge:
        for (int i = pieces(0.08); i > 0; --i) { add_workbench(); }
        for (int i = pieces(0.10); i > 0; --i) { add_cabinet(1.2, 2.2); }
        break;
    }
    for (int i = pieces(0.08); i > 0; --i) { add_odd_piece(); }
  }

  [[nodiscard]] bool has_changed() { return changes_.uniform() < params_.changed; }

  /// What people have done since: things pushed aside, or carried away.
  void rearrange() {
    constexpr double carried_away = 0.25;
    for (std::size_t i = pieces_.size(); i-- > 0;) {  // the last first: the earlier ones keep their places in the plan
      if (!has_changed()) { continue; }
      if (changes_.uniform() < carried_away || !push(pieces_[i])) { remove(pieces_[i]); }
    }
  }

  /// Moves a piece by a metre or less and turns it somewhat, where there is room for that; pieces may overlap then.
  bool push(const Piece& piece) {
    constexpr int tries = 5;
    for (int i = 0; i < tries; ++i) {
      const double distance = changes_.uniform(0.2, 1.0);
      const Point2 shift = around(changes_.uniform(0, 2 * half_turn), distance);
      const double turn = changes_.uniform(-0.5, 0.5);
      FloorPlan moved = copy_of(piece);
      const Rectangle before = bounds(moved);
      const Point2 center = 0.5 * (before.low + before.high);
      const Pose2 now{center.x + shift.x, center.y + shift.y, turn};
      const auto move = [&](Point2& point) { point = now * (point - center); };
      for (PlanSegment& segment : moved.segments) {
        move(segment.begin);
        move(segment.end);
      }
      for (PlanDisc& disc : moved.discs) { move(disc.center); }
      if (!has_room(bounds(moved))) { continue; }
      std::ranges::copy(moved.segments, plan_.segments.begin() + static_cast<std::ptrdiff_t>(piece.first_segment));
      std::ranges::copy(moved.discs, plan_.discs.begin() + static_cast<std::ptrdiff_t>(piece.first_disc));
      return true;
    }
    return false;
  }

  /// Within the room's walls, and not in its door.
  [[nodiscard]] bool has_room(const Rectangle& in_plan) const {
    const Point2 a = in_room(in_plan.low);
    const Point2 b = in_room(in_plan.high);
    const Rectangle area{{std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}};
    return lies_inside(area) && !touch(area, taken_.front());
  }
  [[nodiscard]] FloorPlan copy_of(const Piece& piece) const {
    const auto segments = plan_.segments.begin() + static_cast<std::ptrdiff_t>(piece.first_segment);
    const auto discs = plan_.discs.begin() + static_cast<std::ptrdiff_t>(piece.first_disc);
    return {.segments = {segments, segments + static_cast<std::ptrdiff_t>(piece.segments)},
            .discs = {discs, discs + static_cast<std::ptrdiff_t>(piece.discs)}};
  }
  void remove(const Piece& piece) {
    const auto segments = plan_.segments.begin() + static_cast<std::ptrdiff_t>(piece.first_segment);
    const auto discs = plan_.discs.begin() + static_cast<std::ptrdiff_t>(piece.first_disc);
    plan_.segments.erase(segments, segments + static_cast<std::ptrdiff_t>(piece.segments));
    plan_.discs.erase(discs, discs + static_cast<std::ptrdiff_t>(piece.discs));
  }

  const RoomSite& site_;
  const OfficeParams& params_;
  FloorPlan& plan_;
  Rng rng_;
  Rng changes_;
  std::vector<Piece> pieces_;
  Rectangle inside_;
  std::vector<Rectangle> taken_;
};

}  // namespace

void add_box(FloorPlan& plan, Point2 center, double width, double depth, double angle) {
  const Pose2 plan_from_box{center.x, center.y, angle};
  const std::array<Point2, 4> corners{
      plan_from_box * Point2{-width / 2, -depth / 2}, plan_from_box * Point2{width / 2, -depth / 2},
      plan_from_box * Point2{width / 2, depth / 2}, plan_from_box * Point2{-width / 2, depth / 2}};
  for (std::size_t i = 0; i < 4; ++i) { plan.segments.push_back({corners[i], corners[(i + 1) % 4], Material::solid}); }
}

void add_room(const RoomSite& site, const OfficeParams& params, World& world) {
  Furnisher(site, params, world).build();
  world.places.push_back(site.origin + Point2{site.right * site.width / 2, site.inwards * site.depth * 0.55});
}

}  // namespace flirt::office
