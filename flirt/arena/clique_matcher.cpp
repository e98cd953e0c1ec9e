#include "flirt/arena/clique_matcher.hpp"

#include "flirt/graph/clique.hpp"

#include <algorithm>
#include <limits>

namespace flirt {
namespace {

struct Segment {
  double length{0};  ///< m
  std::uint32_t a{0};
  std::uint32_t b{0};
};

/// All segments longer than `shortest` between the points, a < b, by length.
std::vector<Segment> segments_of(std::span<const Point2> points, double shortest) {
  std::vector<Segment> segments;
  for (std::uint32_t a = 0; a < points.size(); ++a) {
    for (std::uint32_t b = a + 1; b < points.size(); ++b) {
      const double length = norm(points[a] - points[b]);
      if (length > shortest) { segments.push_back({length, a, b}); }
    }
  }
  std::ranges::sort(segments, [](const Segment& s, const Segment& t) { return s.length < t.length; });
  return segments;
}

/// Which candidates are two ends of a segment that both scans have.
class Agreements {
 public:
  Agreements(const PointSets& points, std::span<const IndexPair> candidates)
      : references_(points.reference.size()),
        node_(points.query.size() * references_, none),
        matrix_(candidates.size()) {
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
      node_[candidates[i].query * references_ + candidates[i].reference] = i;
    }
  }

  /// Either end of the one may be either end of the other.
  void add(const Segment& query, const Segment& reference) {
    join(node_[query.a * references_ + reference.a], node_[query.b * references_ + reference.b]);
    join(node_[query.a * references_ + reference.b], node_[query.b * references_ + reference.a]);
  }
  [[nodiscard]] const AgreementMatrix& matrix() const { return matrix_; }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  void join(std::uint32_t i, std::uint32_t j) {
    if (i != none && j != none) { matrix_.set(i, j); }
  }

  std::size_t references_;
  std::vector<std::uint32_t> node_;
  AgreementMatrix matrix_;
};

Agreements agreements_of(const PointSets& points, std::span<const IndexPair> candidates, const CliqueParams& params) {
  const std::vector<Segment> queries = segments_of(points.query, params.distance_min);
  const std::vector<Segment> references = segments_of(points.reference, params.distance_min);
  Agreements agreements(points, candidates);
  std::size_t first = 0;
  for (const Segment& query : queries) {
    while (first < references.size() && query.length - references[first].length >= params.distance_tolerance) {
      ++first;
    }
    for (std::size_t r = first; r < references.size(); ++r) {
      if (references[r].length - query.length >= params.distance_tolerance) { break; }
      agreements.add(query, references[r]);
    }
  }
  return agreements;
}

}  // namespace

std::optional<PointAlignment> align_by_clique(const PointSets& points, std::span<const IndexPair> candidates,
                                              const CliqueParams& params) {
  if (std::min(points.query.size(), points.reference.size()) < 2 || candidates.size() < 2) { return std::nullopt; }
  const Agreements agreements = agreements_of(points, candidates, params);
  const Clique clique = largest_clique(agreements.matrix(), params.max_branches);
  PointAlignment found{.is_proven = clique.is_largest};
  for (const std::uint32_t i : clique.members) { found.pairs.push_back(candidates[i]); }

  const std::optional<Pose2> first_fit = fit_pairs(points, found.pairs);
  if (!first_fit) { return std::nullopt; }
  std::erase_if(found.pairs, [&](const IndexPair& pair) {
    return !(residual_of(points, pair, *first_fit) <= params.distance_tolerance);
  });
  const std::optional<Pose2> fit = fit_pairs(points, found.pairs);
  if (!fit || found.pairs.size() < params.min_matches) { return std::nullopt; }
  found.reference_from_query = *fit;
  return found;
}

}  // namespace flirt
