// flirt/slam/rbpf.hpp: mapping with a Rao-Blackwellized particle filter, the way that graphs came to replace. Each
// particle carries a trajectory and its own grid map; written from the published algorithm (Grisetti, Stachniss and
// Burgard, "Improved techniques for grid mapping with Rao-Blackwellized particle filters", IEEE T-RO 2007).
//
//   Rbpf filter({.particles = 30}, seed, threads);
//   for (const Scan& scan : log.scans) { filter.add(scan); }
//   use(filter.trajectory());                               // of the most likely particle, one pose a scan
#pragma once

#include "flirt/core/rng.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/slam/rbpf_map.hpp"
#include "flirt/slam/rbpf_params.hpp"
#include "flirt/slam/rbpf_proposal.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace flirt {

struct RbpfSummary {
  std::size_t scans{0};
  std::size_t updates{0};  ///< scans that the particles looked at; the others were placed by odometry
  std::size_t resamplings{0};
  std::size_t unmatched{0};  ///< updates of which the best particle's map explained too little
  std::size_t map_bytes{0};  ///< of all particles' tiles, shared ones once
};

/// It needs odometry: where scans carry none (or it is to be ignored) each particle is taken to go on as it went
/// before, which holds for slow, dense scans only. Equal scans and seeds give equal results on any number of threads.
class Rbpf {
 public:
  explicit Rbpf(const RbpfParams& params = {}, std::uint64_t seed = 0, std::size_t threads = 1);

  /// O(particles · (points · samples + cells that beams cross)).
  void add(const Scan& scan);

  /// map_from_robot for each scan, as the particle with the most likely history has it.
  [[nodiscard]] std::vector<Pose2> trajectory() const;
  [[nodiscard]] const RbpfMap& map() const { return particles_[best()].map; }
  [[nodiscard]] RbpfSummary summary() const;

 private:
  struct Particle {
    RbpfMap map;
    Pose2 map_from_robot{};
    Pose2 last_motion{};
    double log_weight{0};   ///< since the last resampling
    double log_history{0};  ///< over all scans
    std::uint32_t node{0};  ///< of its path, in nodes_
    bool matched{true};
  };
  /// Paths share their beginnings: each pose knows the one before it.
  struct PathNode {
    std::uint32_t before{0};
    Pose2 map_from_robot{};
  };
  /// A scan is placed relative to the last update before it, or at it.
  struct Placed {
    std::size_t update{0};
    Pose2 updated_from_robot{};
  };
  struct Points;

  void begin(const Points& points);
  void update(const Points& points, const std::optional<Pose2>& motion);
  void move(Particle& particle, std::size_t index, const Points& points, const std::optional<Pose2>& motion) const;
  void resample_if_needed();
  [[nodiscard]] std::size_t best() const;

  RbpfParams params_;
  std::uint64_t seed_;
  std::size_t threads_;
  Rng rng_;
  std::vector<Particle> particles_{};
  std::vector<PathNode> nodes_{};
  std::vector<Placed> placed_{};
  std::optional<Pose2> updated_odometry_{};  ///< odom_from_robot of the last update
  RbpfSummary summary_{};
};

}  // namespace flirt
