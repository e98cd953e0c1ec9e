// flirt/features/geodesic.hpp: distances along the curve that a scan draws.
#pragma once

#include "flirt/core/aligned_vector.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// arc[i] = length of the polyline from point 0 to point i, m. Returns its total length; with `closed` that includes
/// the way from the last point back to the first. O(n).
double arc_lengths(std::span<const double> x, std::span<const double> y, bool closed, AlignedVector<double>& arc);

/// For every point the points within reach and their geodesic distances, compressed row by row: row i holds the entries
/// first[i] .. first[i + 1], itself (distance 0) among them, in increasing order of the index.
struct GeodesicNeighbours {
  std::vector<std::size_t> first;    ///< n + 1 offsets
  std::vector<std::uint32_t> point;  ///< indices
  std::vector<double> distance;      ///< m
};

/// An edge between two points of a curve.
struct CurveEdge {
  std::uint32_t low;   ///< smaller index
  std::uint32_t high;  ///< larger index
  double length;       ///< m

  friend bool operator==(const CurveEdge&, const CurveEdge&) = default;
};

/// The edges of `trees` edge-disjoint minimum spanning trees of the complete graph over the points, each tree the
/// minimum of what the earlier ones left over (Unnikrishnan and Hebert's way to geodesic coordinates across gaps).
/// Squared lengths that are equal as floats count as ties and are decided by the indices, so that rotating the points
/// does not change the result. O(trees · n²).
[[nodiscard]] std::vector<CurveEdge> spanning_tree_edges(std::span<const double> x, std::span<const double> y,
                                                         int trees);

/// Shortest paths over the `edges` between all pairs of `count` points no further apart than `reach` (m, may be
/// infinite). O(n · m log m) for m points within reach.
[[nodiscard]] GeodesicNeighbours shortest_paths(std::span<const CurveEdge> edges, std::size_t count, double reach);

}  // namespace flirt
