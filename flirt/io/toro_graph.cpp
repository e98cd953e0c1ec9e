#include "flirt/io/toro_graph.hpp"

#include "flirt/io/file.hpp"

namespace flirt {
namespace {

constexpr graph_lines::Dialect dialect{"VERTEX2", "EDGE2", "", {{{0, 0}, {0, 1}, {1, 1}, {2, 2}, {0, 2}, {1, 2}}}};

}  // namespace

Result<GraphFile> read_toro_graph(const std::filesystem::path& path) {
  return graph_lines::read(path, dialect);
}

std::string to_toro_graph(const PoseGraph& graph) {
  return graph_lines::to_text(graph, {}, dialect);
}

Result<void> write_toro_graph(const std::filesystem::path& path, const PoseGraph& graph) {
  return write_file_atomically(path, to_toro_graph(graph));
}

}  // namespace flirt
