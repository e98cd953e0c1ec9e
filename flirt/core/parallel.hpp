// flirt/core/parallel.hpp: a loop over independent items on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace flirt {

/// Called with the finished share of a long piece of work, 0..1, from one thread at a time.
using Progress = std::function<void(double done)>;

/// Number of threads for `requested`: itself, or one per processor when it is 0.
[[nodiscard]] inline std::size_t thread_count(std::size_t requested) {
  return requested != 0 ? requested : std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

/// body(item, thread) for each item in [0, items), in blocks of `grain`, with thread in [0, threads). The body writes
/// to its own item's place only, so that results do not depend on the number of threads; `thread` picks a workspace.
/// Returns when all is done. `progress` is called from the calling thread.
template <class Body>
void parallel_for(std::size_t items, std::size_t threads, const Body& body, const Progress& progress = {},
                  std::size_t grain = 1) {
  std::atomic<std::size_t> next{0};
  const auto work = [&](std::size_t thread) {
    for (std::size_t begin = next.fetch_add(grain); begin < items; begin = next.fetch_add(grain)) {
      const std::size_t end = std::min(items, begin + grain);
      for (std::size_t item = begin; item < end; ++item) { body(item, thread); }
      if (thread == 0 && progress) { progress(static_cast<double>(end) / static_cast<double>(items)); }
    }
  };
  std::vector<std::jthread> pool;
  for (std::size_t thread = 1; thread < std::min(thread_count(threads), items); ++thread) {
    pool.emplace_back(work, thread);
  }
  work(0);
  pool.clear();
  if (progress) { progress(1.0); }
}

}  // namespace flirt
