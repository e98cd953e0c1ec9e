#include "flirt/io/g2o.hpp"

#include "flirt/io/toro_graph.hpp"

#include "tests/io/gzip.hpp"
#include "tests/support/data.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace flirt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

PoseGraph small_graph() {
  PoseGraph graph{.map_from_node = {{0, 0, 0}, {1.5, 0.1, 0.2}, {1e-7, 576.536523, -3}}};
  Eigen::Matrix3d information;
  information << 1, 2, 3, 2, 9, 5, 3, 5, 29;
  graph.edges.push_back({0, 1, {1.0 / 3, 0.25, -0.5}, information, EdgeKind::motion});
  graph.edges.push_back({2, 0, {-1, 2, 3}, 2 * information, EdgeKind::loop});
  return graph;
}

void expect_equal(const PoseGraph& found, const PoseGraph& expected) {
  EXPECT_EQ(found.map_from_node, expected.map_from_node);
  ASSERT_EQ(found.edges.size(), expected.edges.size());
  for (std::size_t k = 0; k < found.edges.size(); ++k) {
    EXPECT_EQ(found.edges[k].a, expected.edges[k].a);
    EXPECT_EQ(found.edges[k].b, expected.edges[k].b);
    EXPECT_EQ(found.edges[k].a_from_b, expected.edges[k].a_from_b);
    EXPECT_EQ(found.edges[k].information, expected.edges[k].information);
    EXPECT_EQ(found.edges[k].kind, expected.edges[k].kind);
  }
}

std::string g2o_error(std::string_view text) {
  const TemporaryFolder folder;
  const auto file = read_g2o(folder.file("a.g2o", text));
  return file ? std::string("no error") : file.error().message;
}

TEST(G2o, WritesTheUpperTriangleRowByRow) {
  const std::string text = to_g2o(small_graph());
  EXPECT_THAT(text, HasSubstr("VERTEX_SE2 1 1.5 0.1 0.2\n"));
  EXPECT_THAT(text, HasSubstr("FIX 0\n"));
  EXPECT_THAT(text, HasSubstr("EDGE_SE2 2 0 -1 2 3 2 4 6 18 10 58\n"));
}

TEST(ToroGraph, WritesTheDiagonalBeforeTheHeadingsCovariances) {
  EXPECT_THAT(to_toro_graph(small_graph()), HasSubstr("EDGE2 2 0 -1 2 3 2 4 18 58 6 10\n"));
}

TEST(G2o, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_g2o(folder.path() / "a.g2o", small_graph(), {0, 2}));
  const GraphFile file = read_g2o(folder.path() / "a.g2o").value();
  expect_equal(file.graph, small_graph());
  EXPECT_THAT(file.fixed, ElementsAre(0, 2));
}

TEST(ToroGraph, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_toro_graph(folder.path() / "a.graph", small_graph()));
  expect_equal(read_toro_graph(folder.path() / "a.graph").value().graph, small_graph());
}

TEST(G2o, OrdersNodesByTheirNumberWhereverTheyStand) {
  const TemporaryFolder folder;
  const std::string text =
      "EDGE_SE2 30 7 1 0 0 1 0 0 1 0 1\nVERTEX_SE2 30 3 3 7\n# a comment\nVERTEX_XY 4 1 1\nVERTEX_SE2 7 2 2 0\r\n";
  const GraphFile file = read_g2o(folder.file("a.g2o.gz", gzipped(text))).value();
  EXPECT_THAT(file.id, ElementsAre(7, 30));
  EXPECT_EQ(file.graph.edges.at(0).a, 1U);
  EXPECT_EQ(file.graph.edges.at(0).b, 0U);
  EXPECT_NEAR(file.graph.map_from_node.at(1).theta, 7 - 2 * std::numbers::pi, 1e-12);
  EXPECT_THAT(file.lines_skipped, ElementsAre(Pair("#", 1), Pair("VERTEX_XY", 1)));
}

TEST(G2o, RefusesBrokenFilesWithTheirPlace) {
  const std::string vertices = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\n";
  EXPECT_THAT(g2o_error("VERTEX_SE2 0 0 0\n"),
              HasSubstr("a.g2o:1: VERTEX_SE2: expected a finite number, found the end"));
  EXPECT_THAT(g2o_error("VERTEX_SE2 0 0 nan 0\n"), HasSubstr("found 'nan'"));
  EXPECT_THAT(g2o_error("VERTEX_SE2 0 1e300 0 0\n"),
              HasSubstr("a.g2o:1: VERTEX_SE2: expected a place within 10 000 km"));
  EXPECT_THAT(g2o_error("VERTEX_SE2 0.5 0 0 0\n"), HasSubstr("expected the number of a vertex, found '0.5'"));
  EXPECT_THAT(g2o_error(vertices + "VERTEX_SE2 1 0 0 0\n"),
              HasSubstr("a.g2o:3: VERTEX_SE2: expected each vertex once"));
  EXPECT_THAT(g2o_error(vertices + "EDGE_SE2 0 1 0 0 0 1 0 0 1 0\n"), HasSubstr("a.g2o:3: EDGE_SE2: "));
  EXPECT_THAT(g2o_error(vertices + "EDGE_SE2 0 1 0 0 0 1 0 0 1 0 1 1\n"), HasSubstr("expected the end of the line"));
  EXPECT_THAT(g2o_error(vertices + "EDGE_SE2 0 1 0 0 0 1 0 0 -1 0 1\n"), HasSubstr("positive semi-definite"));
  EXPECT_THAT(g2o_error(vertices + "EDGE_SE2 0 1 0 0 0 1e300 0 0 1e300 0 1e300\n"),
              HasSubstr("a.g2o:3: EDGE_SE2: expected information up to 1e+18, found 1e+300"));
  EXPECT_THAT(g2o_error(vertices + "EDGE_SE2 0 1 0 0 0 1e15 0 0 1e15 0 1e15\n"), "no error");
  EXPECT_THAT(g2o_error(vertices + "EDGE_SE2 1 1 0 0 0 1 0 0 1 0 1\n"), HasSubstr("with itself"));
  EXPECT_THAT(g2o_error(vertices + "\nEDGE_SE2 0 2 0 0 0 1 0 0 1 0 1\n"),
              HasSubstr("a.g2o:4: expected vertices of the file, found 2"));
  EXPECT_THAT(g2o_error(vertices + "FIX 5\n"), HasSubstr("a.g2o:3: expected vertices of the file, found 5"));
  EXPECT_THAT(g2o_error("FLASER\n"), HasSubstr("expected VERTEX_SE2 lines, found none"));
  EXPECT_THAT(read_g2o("no/such/file").error().message, HasSubstr("found nothing"));
}

TEST(G2o, TakesInformationThatLeavesADirectionOpen) {
  EXPECT_EQ(g2o_error("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\nEDGE_SE2 0 1 0 0 0 0 0 0 1 0 1\n"), "no error");
}

TEST(ToroGraph, ReadsTheGraphAmongTheScansOfALog) {
  const auto log = data_file("intel/flirtlib-intel-lab.log.gz");
  if (!log) { GTEST_SKIP() << "no real logs"; }
  const GraphFile file = read_toro_graph(*log).value();
  EXPECT_EQ(file.graph.map_from_node.size(), 2672U);
  EXPECT_EQ(file.graph.edges.size(), 3901U);
  EXPECT_EQ(file.lines_skipped.at("ROBOTLASER1"), 2672U);
  EXPECT_EQ(file.graph.edges[0].information(2, 2), 500.0);
}

}  // namespace
}  // namespace flirt
