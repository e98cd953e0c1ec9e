// flirt/io/graph_lines.hpp: text files of vertices and edges. Internal to flirt/io; use flirt/io/g2o.hpp or
// flirt/io/toro_graph.hpp.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/graph/pose_graph.hpp"
#include "flirt/io/log.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// A pose graph as a file has it. Nodes are in order of their ids.
struct GraphFile {
  PoseGraph graph{};
  std::vector<std::int64_t> id{};      ///< per node, ascending
  std::vector<std::uint32_t> fixed{};  ///< indices of nodes that the file holds in place
  LineCounts lines_skipped{};          ///< by their first word
};

}  // namespace flirt

namespace flirt::graph_lines {

/// What tells the formats apart.
struct Dialect {
  std::string_view vertex;                         ///< VERTEX id x y theta
  std::string_view edge;                           ///< EDGE a b x y theta and six entries of the information
  std::string_view fix;                            ///< FIX id…; empty: the format has none
  std::array<std::pair<int, int>, 6> information;  ///< rows and columns, in the order of the file
};

/// Reads a plain or gzip file. Edges may come before their vertices. Errors: lines of a known kind that are too short,
/// too long or not finite, information that no covariance has, an id defined twice or not at all, no vertex.
[[nodiscard]] Result<GraphFile> read(const std::filesystem::path& path, const Dialect& dialect);

/// Vertices by their index, then edges; numbers read back the same.
[[nodiscard]] std::string to_text(const PoseGraph& graph, const std::vector<std::uint32_t>& fixed,
                                  const Dialect& dialect);

}  // namespace flirt::graph_lines
