// flirt/map/word_index.hpp: map scans that share descriptor words with a query, for maps of many thousand scans.
//
//   const WordIndex index(map);
//   const SolutionSet found = finder.find_among(features, index.most_alike(features));   // flirt/map/solution_set.hpp
//
// The map's descriptors are clustered to words; each word lists the map scans that have it. A query looks up its own
// words and leaves a few hundred map scans to be matched: an approximation of matching all (bench: `flirt bench
// speed`).
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/features/features.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/match/distance.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace flirt {

struct WordParams {
  std::uint32_t words{512};       ///< clusters of descriptors
  std::uint32_t samples{8192};    ///< descriptors that are clustered, spread evenly over the map
  std::uint32_t rounds{6};        ///< of k-means
  std::uint32_t query_words{3};   ///< nearest words that each query keypoint looks up
  std::uint32_t candidates{500};  ///< map scans that are left
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, WordParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.words, Field{"words", "", "clusters of descriptors", 1, 100000});
  visit(params.samples, Field{"samples", "", "descriptors that are clustered", 1, 10000000});
  visit(params.rounds, Field{"rounds", "", "rounds of k-means", 0, 1000});
  visit(params.query_words, Field{"query_words", "", "nearest words that each query keypoint looks up", 1, 1000});
  visit(params.candidates, Field{"candidates", "", "map scans that are left to be matched", 1, 10000000});
}

/// Inverted file over descriptor words. Read-only once made; keeps nothing of the map.
class WordIndex {
 public:
  /// Parallel; the same on any number of threads (0: one per processor). O(features · words · stride).
  explicit WordIndex(const PlaceMap& map, const WordParams& params = {}, std::size_t threads = 1);

  [[nodiscard]] std::size_t word_count() const { return rows_.size() / (stride_ == 0 ? 1 : stride_); }
  [[nodiscard]] std::size_t bytes() const;

  /// The `candidates` map scans most alike by cosine of their words, rare words counting more (tf-idf); ascending. Of
  /// equally alike ones the first; none without a word in common. `features` as the map's.
  /// O(keypoints · words · stride + listed scans + map scans).
  [[nodiscard]] std::vector<std::uint32_t> most_alike(const Features& features) const;

 private:
  [[nodiscard]] DescriptorRows words() const;
  void cluster(const DescriptorRows& all, std::size_t threads);
  void list_scans(const PlaceMap& map, const std::vector<std::uint32_t>& word_of);

  WordParams params_;
  std::uint32_t dimension_{0};
  std::uint32_t stride_{0};
  std::vector<float> rows_{};             ///< words × stride, as Descriptors::rows: means
  std::vector<float> roots_{};            ///< as Descriptors::roots
  std::vector<std::uint64_t> begin_{};    ///< words + 1; word w is in scans_[begin_[w] .. begin_[w + 1])
  std::vector<std::uint32_t> scans_{};    ///< map scans, ascending in each word
  std::vector<float> weights_{};          ///< of each word: squared inverse document frequency
  std::vector<float> inverse_lengths_{};  ///< of each map scan: 1/√(sum of its words' weights); 0 without words
};

}  // namespace flirt
