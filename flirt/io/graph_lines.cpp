#include "flirt/io/graph_lines.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/text.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace flirt::graph_lines {
namespace {

/// The fields of a line, from left to right; after the first complaint all further ones are 0.
class Fields {
 public:
  explicit Fields(std::string_view text) : words_(text) {}

  double number() {
    const std::string_view word = words_.next();
    const auto value = number_from<double>(word);
    if (!value || !std::isfinite(*value)) { complain("expected a finite number, found " + in_quotes(word)); }
    return complaint_.empty() ? *value : 0.0;
  }
  std::int64_t id() {
    const std::string_view word = words_.next();
    const auto value = number_from<std::int64_t>(word);
    if (!value) { complain("expected the number of a vertex, found " + in_quotes(word)); }
    return complaint_.empty() ? *value : 0;
  }
  Pose2 pose() {
    const double x = number();
    const double y = number();
    if (std::hypot(x, y) > farthest_pose) { complain("expected a place within 10 000 km, found one farther away"); }
    return {x, y, wrap_angle(number())};
  }
  [[nodiscard]] bool at_end() { return words_.rest().empty(); }
  void end() {
    if (!at_end()) { complain("expected the end of the line, found " + in_quotes(words_.rest())); }
  }
  void complain(std::string message) {
    if (complaint_.empty()) { complaint_ = std::move(message); }
  }
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

 private:
  Words words_;
  std::string complaint_{};
};

/// Lines in file order; ids become indices when all vertices are known.
struct Gathered {
  struct Edge {
    std::int64_t a{0};
    std::int64_t b{0};
    PoseEdge edge{};
    std::size_t line{0};
  };
  struct Fixed {
    std::int64_t id{0};
    std::size_t line{0};
  };
  std::map<std::int64_t, Pose2> vertices{};
  std::vector<Edge> edges{};
  std::vector<Fixed> fixed{};
};

/// 1/m², 1/(m·rad), 1/rad²: that of a nanometre. More is broken, and its squares overflow.
constexpr double most_information = 1e18;

bool is_semi_definite(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()(0) >= -1e-9 * std::max(1e-9, eigen.eigenvalues()(2));  // rounding of the text
}

void take_vertex(Fields& fields, Gathered& gathered) {
  const std::int64_t id = fields.id();
  const Pose2 pose = fields.pose();
  fields.end();
  if (!fields.complaint().empty()) { return; }
  const bool is_new = gathered.vertices.emplace(id, pose).second;
  if (!is_new) { fields.complain("expected each vertex once, found " + std::to_string(id) + " again"); }
}

void take_edge(Fields& fields, Gathered& gathered, const Dialect& dialect, std::size_t line) {
  Gathered::Edge edge{.line = line};
  edge.a = fields.id();
  edge.b = fields.id();
  edge.edge.a_from_b = fields.pose();
  for (const auto& [row, column] : dialect.information) {
    const double value = fields.number();
    edge.edge.information(row, column) = value;
    edge.edge.information(column, row) = value;
  }
  fields.end();
  if (edge.a == edge.b) {
    fields.complain("expected two vertices, found an edge of " + std::to_string(edge.a) + " with itself");
  }
  const double most = edge.edge.information.cwiseAbs().maxCoeff();
  if (most > most_information) {
    fields.complain("expected information up to " + number_text(most_information) + ", found " + number_text(most));
  }
  if (fields.complaint().empty() && !is_semi_definite(edge.edge.information)) {
    fields.complain("expected a positive semi-definite information matrix, found another");
  }
  gathered.edges.push_back(edge);
}

void take_fixed(Fields& fields, Gathered& gathered, std::size_t line) {
  do { gathered.fixed.push_back({fields.id(), line}); } while (fields.complaint().empty() && !fields.at_end());
}

/// The complaint about a line, empty when there is none.
std::string take_line(const Line& line, const Dialect& dialect, Gathered& gathered, LineCounts& skipped) {
  Words words(line.text);
  const std::string_view kind = words.next();
  if (kind.empty()) { return {}; }
  Fields fields(words.rest());
  if (kind == dialect.vertex) {
    take_vertex(fields, gathered);
  } else if (kind == dialect.edge) {
    take_edge(fields, gathered, dialect, line.number);
  } else if (kind == dialect.fix) {
    take_fixed(fields, gathered, line.number);
  } else {
    ++skipped[kind.starts_with('#') ? std::string("#") : std::string(kind.substr(0, 32))];
  }
  return fields.complaint().empty() ? std::string() : std::string(kind) + ": " + fields.complaint();
}

class Indices {
 public:
  explicit Indices(const std::vector<std::int64_t>& id) : id_(id) {}
  [[nodiscard]] std::optional<std::uint32_t> of(std::int64_t id) const {
    const auto place = std::lower_bound(id_.begin(), id_.end(), id);
    if (place == id_.end() || *place != id) { return std::nullopt; }
    return static_cast<std::uint32_t>(place - id_.begin());
  }

 private:
  const std::vector<std::int64_t>& id_;
};

Result<GraphFile> assemble(Gathered gathered, const std::string& name, const Dialect& dialect) {
  if (gathered.vertices.empty()) {
    return fail(name + ": expected " + std::string(dialect.vertex) + " lines, found none");
  }
  GraphFile file;
  for (const auto& [id, pose] : gathered.vertices) {
    file.id.push_back(id);
    file.graph.map_from_node.push_back(pose);
  }
  const Indices indices(file.id);
  const auto unknown = [&](std::size_t line, std::int64_t id) {
    return fail(name + ':' + std::to_string(line) + ": expected vertices of the file, found " + std::to_string(id) +
                ", which no " + std::string(dialect.vertex) + " line gives");
  };
  for (Gathered::Edge& read : gathered.edges) {
    const auto a = indices.of(read.a);
    const auto b = indices.of(read.b);
    if (!a || !b) { return unknown(read.line, a ? read.b : read.a); }
    read.edge.a = *a;
    read.edge.b = *b;
    read.edge.kind = std::max(*a, *b) - std::min(*a, *b) == 1 ? EdgeKind::motion : EdgeKind::loop;
    file.graph.edges.push_back(read.edge);
  }
  for (const Gathered::Fixed& fixed : gathered.fixed) {
    const auto node = indices.of(fixed.id);
    if (!node) { return unknown(fixed.line, fixed.id); }
    file.fixed.push_back(*node);
  }
  return file;
}

void append_numbers(std::string& text, std::initializer_list<double> numbers) {
  for (const double number : numbers) {
    text += ' ';
    append_number(text, number);
  }
}

}  // namespace

Result<GraphFile> read(const std::filesystem::path& path, const Dialect& dialect) {
  auto lines = LineReader::open(path);
  if (!lines) { return tl::unexpected(lines.error()); }
  Gathered gathered;
  LineCounts skipped;
  while (true) {
    const auto line = lines->next();
    if (!line) { return tl::unexpected(line.error()); }
    if (!*line) { break; }
    const std::string complaint = take_line(**line, dialect, gathered, skipped);
    if (!complaint.empty()) { return fail(lines->name() + ':' + std::to_string((*line)->number) + ": " + complaint); }
  }
  auto file = assemble(std::move(gathered), lines->name(), dialect);
  if (file) { file->lines_skipped = std::move(skipped); }
  return file;
}

std::string to_text(const PoseGraph& graph, const std::vector<std::uint32_t>& fixed, const Dialect& dialect) {
  std::string text;
  for (std::size_t i = 0; i < graph.map_from_node.size(); ++i) {
    const Pose2& pose = graph.map_from_node[i];
    text.append(dialect.vertex).append(" ").append(std::to_string(i));
    append_numbers(text, {pose.x, pose.y, pose.theta});
    text += '\n';
  }
  for (const std::uint32_t node : fixed) {
    text.append(dialect.fix).append(" ").append(std::to_string(node)).append("\n");
  }
  for (const PoseEdge& edge : graph.edges) {
    text.append(dialect.edge).append(" ").append(std::to_string(edge.a)).append(" ").append(std::to_string(edge.b));
    append_numbers(text, {edge.a_from_b.x, edge.a_from_b.y, edge.a_from_b.theta});
    for (const auto& [row, column] : dialect.information) { append_numbers(text, {edge.information(row, column)}); }
    text += '\n';
  }
  return text;
}

}  // namespace flirt::graph_lines
