#include "flirt/arena/hough_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace flirt {
namespace {

/// The cells of one turn.
class VoteSlice {
 public:
  explicit VoteSlice(const HoughParams& params)
      : params_(params),
        lowest_(static_cast<std::int32_t>(std::floor(-params.shift_max / params.cell))),
        width_(
            static_cast<std::size_t>(static_cast<std::int32_t>(std::ceil(params.shift_max / params.cell)) - lowest_)) {
    counts_.resize(width_ * width_);
  }

  /// Lets every candidate vote with this turn.
  void vote(const PointSets& points, std::span<const IndexPair> candidates, std::int32_t turn) {
    for (const std::uint32_t cell : cells_) { counts_[cell] = 0; }
    cells_.clear();
    voters_.clear();
    const double theta = turn * params_.turn_step;
    const Point2 axis{std::cos(theta), std::sin(theta)};
    for (const IndexPair& pair : candidates) {
      const Point2 query = points.query[pair.query];
      const Point2 turned{axis.x * query.x - axis.y * query.y, axis.y * query.x + axis.x * query.y};
      const Point2 shift = points.reference[pair.reference] - turned;
      if (!(std::abs(shift.x) < params_.shift_max && std::abs(shift.y) < params_.shift_max)) { continue; }
      const std::size_t cell = index_of(shift.x) * width_ + index_of(shift.y);
      ++counts_[cell];
      cells_.push_back(static_cast<std::uint32_t>(cell));
      voters_.push_back(pair);
    }
  }

  /// Cells with at least this many candidates, in order of x, y.
  [[nodiscard]] std::vector<std::uint32_t> crowded(std::uint32_t least) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t cell : cells_) {
      if (counts_[cell] >= least) { found.push_back(cell); }
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  [[nodiscard]] std::vector<IndexPair> voters(std::uint32_t cell) const {
    std::vector<IndexPair> pairs;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (cells_[i] == cell) { pairs.push_back(voters_[i]); }
    }
    return pairs;
  }

  [[nodiscard]] HoughCell cell_at(std::int32_t turn, std::uint32_t cell) const {
    return {.turn = turn,
            .x = lowest_ + static_cast<std::int32_t>(cell / width_),
            .y = lowest_ + static_cast<std::int32_t>(cell % width_)};
  }

 private:
  [[nodiscard]] std::size_t index_of(double shift) const {
    return static_cast<std::size_t>(static_cast<std::int32_t>(std::floor(shift / params_.cell)) - lowest_);
  }

  const HoughParams& params_;
  std::int32_t lowest_;
  std::size_t width_;
  std::vector<std::uint32_t> counts_{};
  std::vector<std::uint32_t> cells_{};  ///< one per voter
  std::vector<IndexPair> voters_{};
};

std::size_t count_distinct(const std::vector<IndexPair>& pairs, std::uint32_t IndexPair::* side) {
  std::vector<std::uint32_t> points;
  points.reserve(pairs.size());
  for (const IndexPair& pair : pairs) { points.push_back(pair.*side); }
  std::ranges::sort(points);
  return static_cast<std::size_t>(std::unique(points.begin(), points.end()) - points.begin());
}

std::uint32_t votes_of(const std::vector<IndexPair>& pairs) {
  return static_cast<std::uint32_t>(
      std::min(count_distinct(pairs, &IndexPair::query), count_distinct(pairs, &IndexPair::reference)));
}

/// No point twice, nearest pairs first; in order of the query.
std::vector<IndexPair> one_to_one(const PointSets& points, const std::vector<IndexPair>& pairs, const Pose2& motion) {
  std::vector<std::pair<double, std::size_t>> order;
  order.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) { order.emplace_back(residual_of(points, pairs[i], motion), i); }
  std::ranges::sort(order);
  std::vector<IndexPair> kept;
  for (const auto& [residual, i] : order) {
    const bool is_free = std::ranges::none_of(kept, [&](const IndexPair& other) {
      return other.query == pairs[i].query || other.reference == pairs[i].reference;
    });
    if (is_free) { kept.push_back(pairs[i]); }
  }
  std::ranges::sort(kept, {}, &IndexPair::query);
  return kept;
}

/// Keeps the best of the cells with most votes.
class BestCell {
 public:
  BestCell(const PointSets& points, const HoughParams& params) : points_(points), params_(params) {}

  [[nodiscard]] std::uint32_t votes_to_beat() const { return std::max(params_.min_votes, best_.votes); }

  void offer(HoughCell cell, const std::vector<IndexPair>& voters) {
    cell.votes = votes_of(voters);
    if (cell.votes < votes_to_beat()) { return; }
    const Pose2 middle{(cell.x + 0.5) * params_.cell, (cell.y + 0.5) * params_.cell, cell.turn * params_.turn_step};
    cell.pairs = one_to_one(points_, voters, middle);
    const std::optional<Pose2> fit = fit_pairs(points_, cell.pairs);
    if (!fit) { return; }
    cell.reference_from_query = *fit;
    double sum = 0;
    for (const IndexPair& pair : cell.pairs) { sum += residual_of(points_, pair, *fit); }
    if (cell.votes == best_.votes && !(sum < residual_sum_)) { return; }
    residual_sum_ = sum;
    best_ = std::move(cell);
  }
  /// Without votes where none had enough.
  [[nodiscard]] const HoughCell& best() const { return best_; }

 private:
  const PointSets& points_;
  const HoughParams& params_;
  HoughCell best_{};
  double residual_sum_{0};
};

}  // namespace

std::optional<HoughCell> most_voted_cell(const PointSets& points, std::span<const IndexPair> candidates,
                                         const HoughParams& params) {
  if (std::min(points.query.size(), points.reference.size()) < std::max(2U, params.min_votes)) { return std::nullopt; }
  const auto turns = static_cast<std::int32_t>(std::floor(params.turn_max / params.turn_step));
  VoteSlice slice(params);
  BestCell best(points, params);
  for (std::int32_t turn = -turns; turn <= turns; ++turn) {
    slice.vote(points, candidates, turn);
    for (const std::uint32_t cell : slice.crowded(best.votes_to_beat())) {
      best.offer(slice.cell_at(turn, cell), slice.voters(cell));
    }
  }
  if (best.best().votes == 0) { return std::nullopt; }
  return best.best();
}

std::optional<PointAlignment> align_by_votes(const PointSets& points, std::span<const IndexPair> candidates,
                                             const HoughParams& params) {
  std::optional<HoughCell> cell = most_voted_cell(points, candidates, params);
  if (!cell) { return std::nullopt; }
  return PointAlignment{.reference_from_query = cell->reference_from_query, .pairs = std::move(cell->pairs)};
}

}  // namespace flirt
