// flirt/match/match.cpp: strategies that turn descriptor distances into candidates.
#include "flirt/match/match.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace flirt {
namespace {

/// Orders candidates of one query feature.
bool is_nearer(const Match& a, const Match& b) {
  return std::tie(a.distance, a.reference) < std::tie(b.distance, b.reference);
}

/// The candidates below `limit` in one row of the table of distances.
void collect_below(std::span<const float> distances, std::uint32_t query, float limit, std::vector<Match>& row) {
  row.clear();
  for (std::uint32_t j = 0; j < distances.size(); ++j) {
    if (distances[j] < limit) { row.push_back({query, j, distances[j]}); }
  }
}

/// For each column of the table the row of its smallest distance, the first of equal ones.
void nearest_queries(std::span<const float> table, std::uint32_t columns, std::vector<std::uint32_t>& nearest) {
  nearest.assign(columns, 0);
  const auto rows = static_cast<std::uint32_t>(table.size() / columns);
  for (std::uint32_t i = 1; i < rows; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::size_t best = std::size_t{nearest[j]} * columns + j;
      if (table[std::size_t{i} * columns + j] < table[best]) { nearest[j] = i; }
    }
  }
}

/// The nearest is clearly nearer than the second nearest of all, which may itself be beyond the limit.
bool is_distinct(std::span<const float> distances, const Match& nearest, double ratio) {
  for (std::uint32_t j = 0; j < distances.size(); ++j) {
    if (j != nearest.reference && double{nearest.distance} >= ratio * double{distances[j]}) { return false; }
  }
  return true;
}

}  // namespace

void Matcher::set_query(const DescriptorRows& query) {
  query_ = query;
  if (params_.strategy == MatchStrategy::nearest && params_.distance == Distance::chi_square) {
    nearest_rows_.set_query(query);
  }
}

std::span<const Match> Matcher::candidates(const DescriptorRows& reference) {
  candidates_.clear();
  if (query_.count == 0 || reference.count == 0) { return candidates_; }
  if (params_.strategy == MatchStrategy::nearest && params_.distance == Distance::chi_square) {
    add_nearest(reference);
  } else {
    add_from_table(reference);
  }
  return candidates_;
}

void Matcher::add_nearest(const DescriptorRows& reference) {
  const std::span<const Nearest> nearest = nearest_rows_.search(reference, static_cast<float>(params_.max_distance));
  candidates_.resize(nearest.size());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < nearest.size(); ++i) {
    candidates_[count] = {i, nearest[i].reference, nearest[i].distance};
    count += nearest[i].distance < std::numeric_limits<float>::infinity() ? 1 : 0;
  }
  candidates_.resize(count);
}

void Matcher::add_from_table(const DescriptorRows& reference) {
  const std::uint32_t columns = reference.count;
  table_.resize(std::size_t{query_.count} * columns);
  const auto table_row = [&](std::size_t i) { return std::span(table_).subspan(i * columns, columns); };
  for (std::size_t i = 0; i < query_.count; ++i) {
    descriptor_distances(params_.distance, query_, i, reference, table_row(i));
  }
  if (params_.strategy == MatchStrategy::mutual) { nearest_queries(table_, columns, nearest_query_); }

  for (std::uint32_t i = 0; i < query_.count; ++i) {
    collect_below(table_row(i), i, static_cast<float>(params_.max_distance), row_);
    if (row_.empty()) { continue; }
    std::ranges::sort(row_, is_nearer);
    const Match& nearest = row_.front();
    std::size_t kept = row_.size();
    switch (params_.strategy) {
      case MatchStrategy::nearest:
        kept = 1;
        break;
      case MatchStrategy::mutual:
        kept = nearest_query_[nearest.reference] == i ? 1 : 0;
        break;
      case MatchStrategy::ratio:
        kept = is_distinct(table_row(i), nearest, params_.ratio) ? 1 : 0;
        break;
      case MatchStrategy::threshold:
        break;
      case MatchStrategy::top_k:
        kept = std::min<std::size_t>(kept, params_.k);
        break;
    }
    candidates_.insert(candidates_.end(), row_.begin(), row_.begin() + static_cast<std::ptrdiff_t>(kept));
  }
}

std::vector<Match> match(const Features& query, const Features& reference, const MatchParams& params) {
  FLIRT_ASSERT(query.keypoints.size() == query.descriptors.size());
  FLIRT_ASSERT(reference.keypoints.size() == reference.descriptors.size());
  Matcher matcher(params);
  matcher.set_query(rows_of(query.descriptors));
  const std::span<const Match> candidates = matcher.candidates(rows_of(reference.descriptors));
  return {candidates.begin(), candidates.end()};
}

}  // namespace flirt
