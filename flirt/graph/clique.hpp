// flirt/graph/clique.hpp: the largest set of things that all agree with each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

/// Which of n things agree; symmetric, and nothing agrees with itself.
class AgreementMatrix {
 public:
  explicit AgreementMatrix(std::size_t n) : n_(n), words_((n + 63) / 64), bits_(n * words_, 0) {}

  void set(std::size_t i, std::size_t j) {
    bits_[i * words_ + j / 64] |= std::uint64_t{1} << (j % 64);
    bits_[j * words_ + i / 64] |= std::uint64_t{1} << (i % 64);
  }
  [[nodiscard]] bool agree(std::size_t i, std::size_t j) const {
    return ((bits_[i * words_ + j / 64] >> (j % 64)) & 1U) != 0;
  }
  [[nodiscard]] std::size_t size() const { return n_; }
  [[nodiscard]] std::size_t words() const { return words_; }
  /// 64 columns a word.
  [[nodiscard]] const std::uint64_t* row(std::size_t i) const { return bits_.data() + i * words_; }

 private:
  std::size_t n_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

/// How far the search went.
struct Clique {
  std::vector<std::uint32_t> members{};  ///< ascending
  bool is_largest{false};                ///< proven; else the best that was found
};

/// A clique by greed (Pattabiraman et al. 2015: from each member whose degree allows a larger set, the neighbour of
/// highest degree, and so on), then, while no more than `most_branches` branches were taken, exactly by branch and
/// bound with a colouring as the bound (Tomita and Seki 2003). The same input gives the same clique.
[[nodiscard]] Clique largest_clique(const AgreementMatrix& agreement, std::uint64_t most_branches);

}  // namespace flirt
