#include "flirt/graph/clique.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace flirt {
namespace {

using Set = std::vector<std::uint64_t>;

bool has(const Set& set, std::size_t i) {
  return ((set[i / 64] >> (i % 64)) & 1U) != 0;
}
void take_out(Set& set, std::size_t i) {
  set[i / 64] &= ~(std::uint64_t{1} << (i % 64));
}
std::size_t count(const Set& set) {
  std::size_t n = 0;
  for (const std::uint64_t word : set) { n += static_cast<std::size_t>(std::popcount(word)); }
  return n;
}
Set both(const Set& set, const std::uint64_t* row) {
  Set result(set.size());
  for (std::size_t k = 0; k < set.size(); ++k) { result[k] = set[k] & row[k]; }
  return result;
}
template <class Visit>
void for_each(const Set& set, const Visit& visit) {
  for (std::size_t k = 0; k < set.size(); ++k) {
    for (std::uint64_t word = set[k]; word != 0; word &= word - 1) {
      visit(static_cast<std::uint32_t>(64 * k + static_cast<std::size_t>(std::countr_zero(word))));
    }
  }
}

class CliqueSearch {
 public:
  CliqueSearch(const AgreementMatrix& agreement, std::uint64_t most_branches)
      : agreement_(agreement), branches_left_(most_branches), by_degree_(agreement.size()) {
    for (std::size_t i = 0; i < agreement.size(); ++i) { degree_.push_back(count(neighbours(i))); }
    std::iota(by_degree_.begin(), by_degree_.end(), 0U);
    std::stable_sort(by_degree_.begin(), by_degree_.end(),
                     [this](std::uint32_t a, std::uint32_t b) { return degree_[a] > degree_[b]; });
  }

  Clique run() {
    for (const std::uint32_t first : by_degree_) {
      if (degree_[first] + 1 > best_.size()) { grow_by_greed(first); }
    }
    Set all(agreement_.words(), 0);
    for (const std::uint32_t i : by_degree_) { all[i / 64] |= std::uint64_t{1} << (i % 64); }
    expand(all);
    std::sort(best_.begin(), best_.end());
    return {best_, branches_left_ > 0};
  }

 private:
  struct Coloured {
    std::uint32_t member;
    std::size_t colours;  ///< of all up to here: no clique among them is larger
  };

  [[nodiscard]] Set neighbours(std::size_t i) const {
    return Set(agreement_.row(i), agreement_.row(i) + agreement_.words());
  }
  void keep(const std::vector<std::uint32_t>& clique) {
    if (clique.size() > best_.size()) { best_ = clique; }
  }

  void grow_by_greed(std::uint32_t first) {
    std::vector<std::uint32_t> clique{first};
    Set candidates = neighbours(first);
    for (std::size_t left = degree_[first]; left > 0 && clique.size() + left > best_.size(); left = count(candidates)) {
      std::uint32_t next = 0;
      std::size_t most = 0;
      for_each(candidates, [&](std::uint32_t i) {
        if (degree_[i] <= most) { return; }
        most = degree_[i];
        next = i;
      });
      clique.push_back(next);
      candidates = both(candidates, agreement_.row(next));
    }
    keep(clique);
  }

  /// Members of one colour disagree with each other, so that a clique has at most one of each.
  [[nodiscard]] std::vector<Coloured> coloured(Set uncoloured) const {
    std::vector<Coloured> list;
    for (std::size_t colours = 1; count(uncoloured) > 0; ++colours) {
      Set open = uncoloured;
      for (const std::uint32_t i : by_degree_) {
        if (!has(open, i)) { continue; }
        list.push_back({i, colours});
        take_out(uncoloured, i);
        const std::uint64_t* const row = agreement_.row(i);
        for (std::size_t k = 0; k < open.size(); ++k) { open[k] &= ~row[k]; }
        take_out(open, i);
      }
    }
    return list;
  }

  void expand(Set candidates) {
    const std::vector<Coloured> list = coloured(candidates);
    for (auto last = list.rbegin(); last != list.rend(); ++last) {
      if (current_.size() + last->colours <= best_.size() || branches_left_ == 0) { return; }
      --branches_left_;
      current_.push_back(last->member);
      const Set next = both(candidates, agreement_.row(last->member));
      count(next) > 0 ? expand(next) : keep(current_);
      current_.pop_back();
      take_out(candidates, last->member);
    }
  }

  const AgreementMatrix& agreement_;
  std::uint64_t branches_left_;
  std::vector<std::uint32_t> by_degree_;
  std::vector<std::size_t> degree_{};
  std::vector<std::uint32_t> current_{};
  std::vector<std::uint32_t> best_{};
};

}  // namespace

Clique largest_clique(const AgreementMatrix& agreement, std::uint64_t most_branches) {
  return CliqueSearch(agreement, most_branches).run();
}

}  // namespace flirt
