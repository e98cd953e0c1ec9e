#include "flirt/io/g2o.hpp"

#include "flirt/io/file.hpp"

namespace flirt {
namespace {

constexpr graph_lines::Dialect dialect{
    "VERTEX_SE2", "EDGE_SE2", "FIX", {{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}}};

}  // namespace

Result<GraphFile> read_g2o(const std::filesystem::path& path) {
  return graph_lines::read(path, dialect);
}

std::string to_g2o(const PoseGraph& graph, const std::vector<std::uint32_t>& fixed) {
  return graph_lines::to_text(graph, graph.map_from_node.empty() ? std::vector<std::uint32_t>{} : fixed, dialect);
}

Result<void> write_g2o(const std::filesystem::path& path, const PoseGraph& graph,
                       const std::vector<std::uint32_t>& fixed) {
  return write_file_atomically(path, to_g2o(graph, fixed));
}

}  // namespace flirt
