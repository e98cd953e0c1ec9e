// flirt/io/toro_graph.hpp: pose graphs in the format of TORO, also as lines of a log among its scans:
//   VERTEX2 id x y theta
//   EDGE2 a b x y theta I11 I12 I22 I33 I13 I23
// The information is taken as PoseEdge states it, in the frame of b (in published graphs x and y have equal
// information, so that the frame does not matter). Edges between neighbours in the order of ids are taken for motion,
// all others for loops; other kinds of lines are skipped and counted.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/graph/pose_graph.hpp"
#include "flirt/io/graph_lines.hpp"

#include <filesystem>
#include <string>

namespace flirt {

/// Reads a plain or gzip file; errors as read_g2o.
[[nodiscard]] Result<GraphFile> read_toro_graph(const std::filesystem::path& path);

/// Nodes are numbered by their index. Numbers read back the same.
[[nodiscard]] std::string to_toro_graph(const PoseGraph& graph);

/// to_toro_graph into a file, at once or not at all.
[[nodiscard]] Result<void> write_toro_graph(const std::filesystem::path& path, const PoseGraph& graph);

}  // namespace flirt
