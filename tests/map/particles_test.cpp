#include "flirt/map/particles.hpp"

#include "flirt/features/extract.hpp"
#include "flirt/map/solution_set.hpp"

#include "tests/support/room_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace flirt {
namespace {

std::vector<Particle> in_bins(int bins, int each) {
  std::vector<Particle> particles;
  for (int bin = 0; bin < bins; ++bin) {
    for (int i = 0; i < each; ++i) {
      particles.push_back({.map_from_robot = {static_cast<double>(bin), 0, 0}, .weight = 1.0 / (bins * each)});
    }
  }
  return particles;
}

TEST(Particles, LowVarianceResamplingTakesEachAsOftenAsItsWeightSays) {
  Rng rng(3);
  std::vector<Particle> particles{{{0, 0, 0}, 0.5}, {{1, 0, 0}, 0.3}, {{2, 0, 0}, 0.2}, {{3, 0, 0}, 0}};
  std::vector<int> count(4);
  for (const Particle& particle : resampled(particles, 100, rng)) {
    ++count[static_cast<std::size_t>(particle.map_from_robot.x)];
    EXPECT_EQ(particle.weight, 0.01);
  }
  EXPECT_NEAR(count[0], 50, 1);
  EXPECT_NEAR(count[1], 30, 1);
  EXPECT_NEAR(count[2], 20, 1);
  EXPECT_EQ(count[3], 0);
}

TEST(Particles, EffectiveCountIsAllWhenEvenAndOneWhenOneHasItAll) {
  EXPECT_NEAR(effective_count(in_bins(10, 5)), 50, 1e-9);
  EXPECT_EQ(effective_count(std::vector<Particle>{{{}, 1}, {{}, 0}}), 1);
  EXPECT_EQ(effective_count({}), 0);
}

TEST(Particles, KldCountIsTheChiSquareQuantile) {
  // n = χ²(k − 1; .99) / (2 · 0.05); χ² quantiles by tables: 9 degrees 21.67, 99 degrees 134.64.
  EXPECT_NEAR(static_cast<double>(kld_count(in_bins(10, 2), 0.5, 0.2, 0.05, 2.326)), 216.7, 3);
  EXPECT_NEAR(static_cast<double>(kld_count(in_bins(100, 1), 0.5, 0.2, 0.05, 2.326)), 1346.4, 5);
  EXPECT_EQ(kld_count(in_bins(1, 7), 0.5, 0.2, 0.05, 2.326), 1U);
  EXPECT_EQ(kld_count({}, 0.5, 0.2, 0.05, 2.326), 0U);
}

TEST(Particles, BinsOfTheHeadingMeetAtHalfATurn) {
  // Bins of about 0.2 rad, 32 of them: the one around half a turn is one, on whichever side of the jump of the angle
  // its particles lie.
  const std::vector<Particle> one{{{0, 0, 3.1}, 0.5}, {{0, 0, -3.1}, 0.5}};
  EXPECT_EQ(kld_count(one, 0.5, 0.2, 0.05, 2.326), 1U);
  std::vector<Particle> all_around;
  for (int i = 0; i < 1000; ++i) { all_around.push_back({{0, 0, wrap_angle(6.2831853 * i / 1000)}, 0.001}); }
  EXPECT_EQ(kld_count(all_around, 0.5, 0.2, 0.05, 2.326), kld_count(in_bins(32, 1), 0.5, 0.2, 0.05, 2.326));
  // A cluster across the jump outweighs one that outweighs each of its halves.
  const std::vector<Particle> split{{{0, 0, 3.12}, 0.3}, {{0, 0, -3.12}, 0.3}, {{5, 0, 0}, 0.4}};
  EXPECT_NEAR(clusters_of(split, 0.5, 0.2, 1).at(0).share, 0.6, 1e-12);
}

TEST(Particles, MotionWithoutNoiseIsTheOdometry) {
  Rng rng(1);
  const MotionNoise none{0, 0, 0, 0, 0, 0, 0};
  std::vector<Particle> particles{{{1, 2, 0.5}, 1}};
  const Pose2 motion{0.3, 0.1, -0.2};
  move_particles(particles, motion, none, rng);
  EXPECT_LT(distance(particles[0].map_from_robot, Pose2{1, 2, 0.5} * motion), 1e-12);
  const Pose2 before = particles[0].map_from_robot;
  move_particles(particles, std::nullopt, none, rng);
  EXPECT_EQ(particles[0].map_from_robot, before);
}

TEST(Particles, NoiseGrowsWithTheRootOfTheWay) {
  Rng rng(2);
  const MotionNoise noise{.translation = 0.1, .rotation = 0, .heading = 0, .still_translation = 0, .still_rotation = 0};
  const auto deviation = [&](double way) {
    std::vector<Particle> particles(4000, Particle{{}, 1.0 / 4000});
    move_particles(particles, Pose2{way, 0, 0}, noise, rng);
    double squares = 0;
    for (const Particle& particle : particles) { squares += std::pow(particle.map_from_robot.x - way, 2); }
    return std::sqrt(squares / 4000);
  };
  EXPECT_NEAR(deviation(1), 0.1, 0.005);
  EXPECT_NEAR(deviation(4), 0.2, 0.01);
}

TEST(Particles, ClustersAreTheHeapsHeaviestFirst) {
  std::vector<Particle> particles = in_bins(2, 50);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Particle& particle = particles[i];
    particle.weight = i < 50 ? 0.006 : 0.014;
    particle.map_from_robot.y = 0.001 * static_cast<double>(i % 50);
    if (i >= 50) { particle.map_from_robot.theta = i % 2 == 0 ? 3.1 : -3.1; }  // across the jump of the angle
  }
  const std::vector<TrackCluster> clusters = clusters_of(particles, 0.5, 0.2, 10);
  ASSERT_EQ(clusters.size(), 2U);
  EXPECT_NEAR(clusters[0].share, 0.7, 1e-9);
  EXPECT_NEAR(clusters[0].map_from_robot.x, 1, 1e-9);
  EXPECT_NEAR(std::abs(clusters[0].map_from_robot.theta), 3.14159, 1e-2);
  EXPECT_NEAR(clusters[0].covariance(2, 2), std::pow(3.14159 - 3.1, 2), 1e-4);
  EXPECT_NEAR(clusters[1].share, 0.3, 1e-9);
  EXPECT_NEAR(clusters[1].map_from_robot.y, 0.0245, 1e-9);
}

/// The papers' sample of p(x | z, m): poses of matches, weighted by 1 / residual (P1 §3.1).
std::vector<PoseHypothesis> papers_sample(SolutionSetFinder& finder, const Scan& scan) {
  std::vector<PoseHypothesis> sample;
  for (const Hypothesis& found : finder.find(extract(scan)).hypotheses) {
    sample.push_back(
        {.map_from_sensor = found.map_from_sensor, .covariance = found.covariance, .weight = found.weight});
  }
  return sample;
}

/// log of the sample's density at a pose, kernels of 0.2 m and 0.1 rad, and a floor for what no match says.
double log_density(const std::vector<PoseHypothesis>& sample, const Pose2& map_from_sensor) {
  double density = 1e-3;
  for (const PoseHypothesis& at : sample) {
    const double off = distance(at.map_from_sensor, map_from_sensor) / 0.2;
    const double turned = heading_difference(at.map_from_sensor, map_from_sensor) / 0.1;
    density += at.weight * std::exp(-(off * off + turned * turned) / 2);
  }
  return std::log(density);
}

TEST(Particles, ThePapersSolutionSetStartsAFilterAndLeadsIt) {
  // A second room with fewer things in it: one scan leaves it open which of the two it is.
  const Pose2 map_from_other{30, 5, 1.2};
  Scene other = furnished_room();
  other.resize(other.size() - 12);
  std::vector<Pose2> poses = poses_around(1.2, 6);
  for (const Pose2& pose : poses_around(1.2, 6)) { poses.push_back(map_from_other * pose); }
  SolutionSetFinder finder(
      build_place_map(log_of(joined(furnished_room(), moved(other, map_from_other)), poses)).value());
  const Pose2 step{0.3, 0, 0.4};
  Pose2 truth{-0.9, -0.8, 0.1};
  Rng rng(2);
  std::vector<Particle> particles = drawn_from(papers_sample(finder, room_scan(truth)), {}, 200, 0.05, 0.03, rng);
  const auto share_near = [&] {
    double share = 0;
    for (const Particle& particle : particles) {
      share += is_near(particle.map_from_robot, truth, 0.5, 0.3) ? particle.weight : 0;
    }
    return share;
  };
  EXPECT_GT(share_near(), 0.2);
  EXPECT_LT(share_near(), 0.9);
  for (int i = 0; i < 4; ++i) {
    truth = truth * step;
    move_particles(particles, step, {}, rng);
    const auto sample = papers_sample(finder, room_scan(truth));
    for (Particle& particle : particles) { particle.score = log_density(sample, particle.map_from_robot); }
    weigh(particles, 1);
    particles = resampled(particles, particles.size(), rng);
  }
  const TrackCluster best = clusters_of(particles, 0.5, 0.3, 1).front();
  EXPECT_GT(best.share, 0.9);
  EXPECT_LT(distance(best.map_from_robot, truth), 0.1);
}

}  // namespace
}  // namespace flirt
