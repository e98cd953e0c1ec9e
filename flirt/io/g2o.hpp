// flirt/io/g2o.hpp: pose graphs in the format of g2o, which most optimizers read:
//   VERTEX_SE2 id x y theta
//   EDGE_SE2 a b x y theta I11 I12 I13 I22 I23 I33
//   FIX id…
// The information is stated in the frame of b, as PoseEdge has it. Edges between neighbours in the order of ids are
// taken for motion, all others for loops; other kinds of lines are skipped and counted.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/graph/pose_graph.hpp"
#include "flirt/io/graph_lines.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace flirt {

/// Reads a plain or gzip file. Edges may come before their vertices. Errors, with their line: fields missing, too many
/// or not finite; information that is not positive semi-definite; an id defined twice or not at all.
[[nodiscard]] Result<GraphFile> read_g2o(const std::filesystem::path& path);

/// Nodes are numbered by their index, `fixed` are indices. Numbers read back the same.
[[nodiscard]] std::string to_g2o(const PoseGraph& graph, const std::vector<std::uint32_t>& fixed = {0});

/// to_g2o into a file, at once or not at all.
[[nodiscard]] Result<void> write_g2o(const std::filesystem::path& path, const PoseGraph& graph,
                                     const std::vector<std::uint32_t>& fixed = {0});

}  // namespace flirt
