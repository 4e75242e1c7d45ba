// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/graph_file.hpp"

#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

const std::string kTwo = "VERTEX_SE2 3 0 0 0\nVERTEX_SE2 7 1 0 0.5\n";
const std::string kEdge = "EDGE_SE2 3 7 1 0 0.5 11 12 13 22 23 330\n";

GraphFile noisy_file() {
  GraphFile file;
  file.graph = test::square_loop(12, 0.05, 401);
  for (std::size_t k = 0; k < file.graph.poses.size(); ++k) file.ids.push_back(static_cast<std::int64_t>(5 + 3 * k));
  for (GraphEdge& edge : file.graph.edges) edge.information << 120, 30, -10, 30, 80, 15, -10, 15, 400.0 / 3;
  file.fixed = 4;
  return file;
}

void require_equal(const GraphFile& a, const GraphFile& b) {
  REQUIRE(a.ids == b.ids);
  REQUIRE(a.graph.edges.size() == b.graph.edges.size());
  for (std::size_t k = 0; k < a.ids.size(); ++k) REQUIRE_THAT(a.graph.poses[k], IsNear(b.graph.poses[k], 0, 1e-15));
  for (std::size_t k = 0; k < a.graph.edges.size(); ++k) {
    const GraphEdge &p = a.graph.edges[k], &q = b.graph.edges[k];
    REQUIRE((p.from == q.from && p.to == q.to && p.kind == q.kind));
    REQUIRE_THAT(p.T_from_to, IsNear(q.T_from_to, 0, 1e-15));
    REQUIRE((p.information - q.information).norm() == 0);
  }
}

}  // namespace

TEST_CASE("a g2o file keeps its ids, its order of information, its fixed vertex and its loops") {
  const GraphFile file = parse_graph("# by hand\n" + kTwo + "FIX 7\n\n" + kEdge + kEdge);
  REQUIRE(file.ids == std::vector<std::int64_t>{3, 7});
  REQUIRE(file.fixed == 1);
  REQUIRE_THAT(file.graph.poses[1], IsNear({1, 0, 0.5}, 0, 1e-15));
  Eigen::Matrix3d information;
  information << 11, 12, 13, 12, 22, 23, 13, 23, 330;
  REQUIRE(file.graph.edges[0].information == information);
  REQUIRE(file.graph.edges[0].kind == EdgeKind::kSequence);
  REQUIRE(file.graph.edges[1].kind == EdgeKind::kLoop);  // a second word on the same step is a loop
}

TEST_CASE("TORO writes information in the order xx xy yy tt xt yt") {
  const GraphFile file = parse_graph("VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nEDGE2 0 1 1 0 0 11 12 22 330 13 23\n");
  Eigen::Matrix3d information;
  information << 11, 12, 13, 12, 22, 23, 13, 23, 330;
  REQUIRE(file.graph.edges[0].information == information);
}

TEST_CASE("both formats give back every number that was written") {
  const GraphFile file = noisy_file();
  const GraphFile g2o = parse_graph(graph_text(file, GraphFormat::kG2o)), toro = parse_graph(graph_text(file, GraphFormat::kToro));
  REQUIRE(g2o.fixed == 4);
  require_equal(g2o, file);
  require_equal(toro, file);
}

TEST_CASE("vertices may come after edges and in any order; edges alone get poses from a tree") {
  const GraphFile late = parse_graph(kEdge + "VERTEX_SE2 7 1 0 0.5\nVERTEX_SE2 3 0 0 0\n");
  REQUIRE(late.graph.edges[0].from == 0);
  const GraphFile bare = parse_graph(kEdge);
  REQUIRE_FALSE(bare.has_vertices);
  REQUIRE_THAT(bare.graph.poses[1], IsNear({1, 0, 0.5}, 1e-12, 1e-12));
}

TEST_CASE("what is no planar pose graph is refused with the line and what is wrong") {
  const auto refused = [](const std::string& text, const std::string& words) {
    INFO(text);
    REQUIRE_THROWS_WITH(parse_graph(text), Catch::Contains(words));
  };
  refused("", "no edge");
  refused(kTwo, "no edge");
  refused(kTwo + "EDGE_SE2 3 7 1 0 nan 1 0 0 1 0 1\n", "line 3: motion");
  refused(kTwo + "EDGE_SE2 3 7 1 0 0.5 1 0 0 1 0\n", "line 3: ends before information");
  refused(kTwo + "EDGE_SE2 3 7 1 0 0.5 1 0 0 1 0 1 9\n", "line 3: has 13 fields");
  refused(kTwo + "EDGE_SE2 3 7 1 0 0.5 1 0 0 inf 0 1\n", "line 3: information");
  refused(kTwo + "EDGE_SE2 3 7 1 0 0.5 1 0 0 -1 0 1\n", "line 3: information is not positive");
  refused(kTwo + "EDGE_SE2 3 7 1 0 0.5 1 5 0 1 0 1\n", "line 3: information is not positive");
  refused(kTwo + "EDGE_SE2 3 7 1 0 0.5 0 0 0 0 0 0\n", "line 3: information is not positive");
  refused(kTwo + "EDGE_SE2 3 8 1 0 0.5 1 0 0 1 0 1\n", "line 3: vertex 8 is not in the file");
  refused(kTwo + "EDGE_SE2 3 3 1 0 0.5 1 0 0 1 0 1\n", "line 3: leads from vertex 3 to itself");
  refused(kTwo + "EDGE_SE2 3 7.5 1 0 0.5 1 0 0 1 0 1\n", "line 3: to");
  refused(kTwo + "VERTEX_SE2 3 0 0 0\n" + kEdge, "line 3: vertex 3 stands in the file twice");
  refused(kTwo + "VERTEX_SE2 -1 0 0 0\n" + kEdge, "line 3: id");
  refused(kTwo + "FIX 9\n" + kEdge, "line 3: vertex 9 is not in the file");
  refused(kTwo + "FIX 3\nFIX 7\n" + kEdge, "line 4: a second vertex is fixed");
  refused("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", "line 1: VERTEX_SE3:QUAT: a graph of 3D poses");
  refused(kTwo + "VERTEX_XY 9 1 1\n", "line 3: VERTEX_XY: landmarks");
  refused(kTwo + kEdge + "HELLO\n", "line 4: starts with 'HELLO'");
}

TEST_CASE("information that says nothing in one direction is allowed") {
  REQUIRE(parse_graph(kTwo + "EDGE_SE2 3 7 1 0 0.5 100 0 0 0 0 400\n").graph.edges.size() == 1);
}
