#include "flirt/map/word_index.hpp"

#include "flirt/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

namespace flirt {
namespace {

constexpr std::size_t grain = 256;

DescriptorRows all_rows(const PlaceMap& map) {
  return {.rows = map.columns().descriptor_rows.data(),
          .roots = map.columns().descriptor_roots.data(),
          .count = static_cast<std::uint32_t>(map.feature_count()),
          .dimension = map.descriptor_dimension(),
          .stride = map.descriptor_stride()};
}

/// The nearest word of rows 0, step, 2·step, … by Hellinger distance; of equal ones the first.
std::vector<std::uint32_t> nearest_words(const DescriptorRows& all, std::size_t step, std::size_t count,
                                         const DescriptorRows& words, std::size_t threads) {
  std::vector<std::uint32_t> nearest(count);
  std::vector<std::vector<float>> distances(thread_count(threads), std::vector<float>(words.count));
  parallel_for(
      count, distances.size(),
      [&](std::size_t i, std::size_t thread) {
        std::vector<float>& row = distances[thread];
        descriptor_distances(Distance::hellinger, all, i * step, words, row);
        nearest[i] = static_cast<std::uint32_t>(std::ranges::min_element(row) - row.begin());
      },
      {}, grain);
  return nearest;
}

/// How much a query keypoint says for a word.
struct WordVote {
  std::uint32_t word;
  float similarity;
};

/// The words of a query, each once, with the similarity of its nearest keypoint.
std::vector<WordVote> words_of(const Features& features, const DescriptorRows& words, std::uint32_t per_keypoint) {
  const DescriptorRows query = rows_of(features.descriptors);
  std::vector<float> similarity(words.count, 0.0F);
  std::vector<float> distances(words.count);
  std::vector<std::uint32_t> order(words.count);
  const auto kept = static_cast<std::ptrdiff_t>(std::min(per_keypoint, words.count));
  for (std::size_t k = 0; k < query.count; ++k) {
    descriptor_distances(Distance::hellinger, query, k, words, distances);
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::partial_sort(order, order.begin() + kept, {},
                              [&distances](std::uint32_t word) { return std::pair(distances[word], word); });
    for (const std::uint32_t word : std::span(order).first(static_cast<std::size_t>(kept))) {
      similarity[word] = std::max(similarity[word], 1.0F - distances[word]);
    }
  }
  std::vector<WordVote> votes;
  for (std::uint32_t word = 0; word < words.count; ++word) {
    if (similarity[word] > 0) { votes.push_back({word, similarity[word]}); }
  }
  return votes;
}

}  // namespace

WordIndex::WordIndex(const PlaceMap& map, const WordParams& params, std::size_t threads)
    : params_(params), dimension_(map.descriptor_dimension()), stride_(map.descriptor_stride()) {
  inverse_lengths_.assign(map.size(), 0.0F);
  if (map.feature_count() == 0) { return; }
  const DescriptorRows all = all_rows(map);
  cluster(all, threads);
  list_scans(map, nearest_words(all, 1, all.count, words(), threads));
}

std::size_t WordIndex::bytes() const {
  return (rows_.size() + roots_.size() + weights_.size() + inverse_lengths_.size()) * sizeof(float) +
         begin_.size() * sizeof(std::uint64_t) + scans_.size() * sizeof(std::uint32_t);
}

DescriptorRows WordIndex::words() const {
  return {.rows = rows_.data(),
          .roots = roots_.data(),
          .count = static_cast<std::uint32_t>(word_count()),
          .dimension = dimension_,
          .stride = stride_};
}

/// k-means by Hellinger distance, started from rows spread evenly over the map. A word that loses all samples stays.
void WordIndex::cluster(const DescriptorRows& all, std::size_t threads) {
  const std::size_t count = std::min<std::size_t>(params_.words, all.count);
  for (std::size_t word = 0; word < count; ++word) {
    const std::size_t first = word * all.count / count * stride_;
    rows_.insert(rows_.end(), all.rows + first, all.rows + first + stride_);
    roots_.insert(roots_.end(), all.roots + first, all.roots + first + stride_);
  }
  const std::size_t step = std::max<std::size_t>(1, all.count / params_.samples);
  const std::size_t samples = (all.count + step - 1) / step;
  for (std::uint32_t round = 0; round < params_.rounds; ++round) {
    const std::vector<std::uint32_t> word_of = nearest_words(all, step, samples, words(), threads);
    std::vector<double> sums(rows_.size(), 0.0);
    std::vector<double> members(count, 0.0);
    for (std::size_t i = 0; i < samples; ++i) {
      const float* const row = all.rows + i * step * stride_;
      double* const sum = sums.data() + std::size_t{word_of[i]} * stride_;
      for (std::size_t k = 0; k < stride_; ++k) { sum[k] += double{row[k]}; }
      members[word_of[i]] += 1;
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
      if (members[k / stride_] == 0) { continue; }
      rows_[k] = static_cast<float>(sums[k] / members[k / stride_]);
      roots_[k] = std::sqrt(rows_[k]);
    }
  }
}

void WordIndex::list_scans(const PlaceMap& map, const std::vector<std::uint32_t>& word_of) {
  std::vector<std::vector<std::uint32_t>> lists(word_count());
  const auto& feature_begin = map.columns().feature_begin;
  for (std::uint32_t scan = 0; scan < map.size(); ++scan) {
    for (std::size_t k = feature_begin[scan]; k < feature_begin[scan + 1]; ++k) {
      std::vector<std::uint32_t>& list = lists[word_of[k]];
      if (list.empty() || list.back() != scan) { list.push_back(scan); }
    }
  }
  begin_ = {0};
  for (const std::vector<std::uint32_t>& list : lists) {
    scans_.insert(scans_.end(), list.begin(), list.end());
    begin_.push_back(scans_.size());
    const double rarity = std::log((1.0 + static_cast<double>(map.size())) / (1.0 + static_cast<double>(list.size())));
    weights_.push_back(static_cast<float>(rarity * rarity));
    for (const std::uint32_t scan : list) { inverse_lengths_[scan] += weights_.back(); }
  }
  for (float& length : inverse_lengths_) { length = length > 0 ? 1.0F / std::sqrt(length) : 0.0F; }
}

std::vector<std::uint32_t> WordIndex::most_alike(const Features& features) const {
  if (word_count() == 0) { return {}; }
  std::vector<float> scores(inverse_lengths_.size(), 0.0F);
  for (const WordVote& vote : words_of(features, words(), params_.query_words)) {
    const float weight = vote.similarity * weights_[vote.word];
    for (std::uint64_t i = begin_[vote.word]; i < begin_[vote.word + 1]; ++i) { scores[scans_[i]] += weight; }
  }
  std::vector<std::uint32_t> alike;
  for (std::uint32_t scan = 0; scan < scores.size(); ++scan) {
    scores[scan] *= inverse_lengths_[scan];
    if (scores[scan] > 0) { alike.push_back(scan); }
  }
  if (alike.size() > params_.candidates) {
    std::ranges::nth_element(alike, alike.begin() + params_.candidates, {},
                             [&scores](std::uint32_t scan) { return std::pair(-scores[scan], scan); });
    alike.resize(params_.candidates);
    std::ranges::sort(alike);
  }
  return alike;
}

}  // namespace flirt
