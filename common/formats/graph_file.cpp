// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/graph_file.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <charconv>
#include <map>
#include <stdexcept>

#include "common/formats/text_fields.hpp"

namespace modslam {
namespace {

constexpr std::int64_t kMaxId = std::int64_t{1} << 53;
// Row and column of the six numbers of information.
constexpr int kG2oOrder[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
constexpr int kToroOrder[6][2] = {{0, 0}, {0, 1}, {1, 1}, {2, 2}, {0, 2}, {1, 2}};

struct Reader {
  struct Line {
    GraphEdge edge;  // ends are the file's ids
    std::size_t number;
  };
  std::map<std::int64_t, Pose2> vertices;
  std::vector<Line> edges;
  std::vector<std::int64_t> fixed;
  std::size_t fixed_line = 0;

  void read(TextFields& fields, std::size_t number) {
    const std::string_view tag = fields.word("tag");
    if (tag.front() == '#') return;
    if (tag == "VERTEX_SE2" || tag == "VERTEX2")
      read_vertex(fields);
    else if (tag == "EDGE_SE2" || tag == "EDGE2")
      edges.push_back({read_edge(fields, tag == "EDGE2" ? kToroOrder : kG2oOrder), number});
    else if (tag == "FIX")
      read_fix(fields, number);
    else if (tag.find("SE3") != tag.npos || tag == "VERTEX3" || tag == "EDGE3")
      throw BadLine(std::string(tag) + ": a graph of 3D poses; only planar ones (VERTEX_SE2, VERTEX2) can be read");
    else if (tag.find("XY") != tag.npos)
      throw BadLine(std::string(tag) + ": landmarks; only graphs of poses can be read");
    else
      throw BadLine("starts with '" + std::string(tag.substr(0, 24)) +
                    "', expected VERTEX_SE2, EDGE_SE2, FIX, VERTEX2 or EDGE2");
  }

 private:
  void read_vertex(TextFields& fields) {
    const std::int64_t id = fields.integer("id", 0, kMaxId);
    const Pose2 pose = fields.pose("pose");
    fields.expect_left(0);
    if (!vertices.emplace(id, pose).second) throw BadLine("vertex " + std::to_string(id) + " stands in the file twice");
  }

  void read_fix(TextFields& fields, std::size_t number) {
    do fixed.push_back(fields.integer("id", 0, kMaxId));
    while (fields.left());
    fixed_line = number;
    if (fixed.size() > 1) throw BadLine("a second vertex is fixed; only one can be");
  }

  static GraphEdge read_edge(TextFields& fields, const int (&order)[6][2]) {
    GraphEdge edge;
    edge.from = fields.integer("from", 0, kMaxId);
    edge.to = fields.integer("to", 0, kMaxId);
    edge.T_from_to = fields.pose("motion");
    for (const auto& [r, c] : order) edge.information(r, c) = edge.information(c, r) = fields.number("information", 1e15);
    fields.expect_left(0);
    if (edge.from == edge.to) throw BadLine("leads from vertex " + std::to_string(edge.from) + " to itself");
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(edge.information, Eigen::EigenvaluesOnly);
    const Eigen::Vector3d& values = eigen.eigenvalues();  // ascending
    if (values[0] < -1e-6 * std::max(values[2], 0.0) || values[2] <= 0)
      throw BadLine("information is not positive: its eigenvalues are " + std::to_string(values[0]) + ", " +
                    std::to_string(values[1]) + ", " + std::to_string(values[2]));
    return edge;
  }
};

/// Sequence edges are the first ones between neighbours.
void tell_loops_from_sequence(PoseGraph& graph) {
  std::vector<bool> has_next(graph.poses.size(), false);
  for (GraphEdge& edge : graph.edges) {
    const auto low = static_cast<std::size_t>(std::min(edge.from, edge.to));
    const bool is_step = std::abs(edge.from - edge.to) == 1 && !has_next[low];
    edge.kind = is_step ? EdgeKind::kSequence : EdgeKind::kLoop;
    if (is_step) has_next[low] = true;
  }
}

void append(std::string& text, double value) {
  char digits[32];
  text += ' ';
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void append(std::string& text, const Pose2& pose) {
  for (const double value : {pose.x, pose.y, pose.heading}) append(text, value);
}

}  // namespace

GraphFile parse_graph(std::string_view text) {
  Reader reader;
  std::size_t at = 0;
  const auto with_line = [&](auto&& act) {
    try {
      act();
    } catch (const BadLine& error) {
      throw std::runtime_error("line " + std::to_string(at) + ": " + error.what());
    }
  };
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    at = number;
    TextFields fields(line);
    with_line([&] { reader.read(fields, number); });
  });
  if (reader.edges.empty()) throw std::runtime_error("holds no edge (EDGE_SE2 or EDGE2)");

  GraphFile file;
  file.has_vertices = !reader.vertices.empty();
  if (!file.has_vertices)
    for (const Reader::Line& line : reader.edges) reader.vertices[line.edge.from], reader.vertices[line.edge.to];
  std::map<std::int64_t, NodeId> index;
  for (const auto& [id, pose] : reader.vertices) {
    index[id] = static_cast<NodeId>(file.ids.size());
    file.ids.push_back(id);
    file.graph.poses.push_back(pose);
  }
  const auto index_of = [&](std::int64_t id) {
    const auto found = index.find(id);
    if (found == index.end()) throw BadLine("vertex " + std::to_string(id) + " is not in the file");
    return found->second;
  };
  for (Reader::Line& line : reader.edges) {
    at = line.number;
    with_line([&] {
      line.edge.from = index_of(line.edge.from);
      line.edge.to = index_of(line.edge.to);
    });
    line.edge.id = static_cast<EdgeId>(file.graph.edges.size());
    file.graph.edges.push_back(line.edge);
  }
  at = reader.fixed_line;
  with_line([&] { file.fixed = reader.fixed.empty() ? 0 : static_cast<std::size_t>(index_of(reader.fixed.front())); });
  tell_loops_from_sequence(file.graph);
  if (!file.has_vertices) initialize_from_tree(file.graph);
  return file;
}

std::string graph_text(const GraphFile& file, GraphFormat format) {
  const bool toro = format == GraphFormat::kToro;
  std::string text;
  for (std::size_t k = 0; k < file.ids.size(); ++k) {
    text += (toro ? "VERTEX2 " : "VERTEX_SE2 ") + std::to_string(file.ids[k]);
    append(text, file.graph.poses[k]);
    text += '\n';
  }
  if (!toro && !file.ids.empty()) text += "FIX " + std::to_string(file.ids[file.fixed]) + "\n";
  for (const GraphEdge& edge : file.graph.edges) {
    text += (toro ? "EDGE2 " : "EDGE_SE2 ") + std::to_string(file.ids[static_cast<std::size_t>(edge.from)]) + " " +
            std::to_string(file.ids[static_cast<std::size_t>(edge.to)]);
    append(text, edge.T_from_to);
    for (const auto& [r, c] : toro ? kToroOrder : kG2oOrder) append(text, edge.information(r, c));
    text += '\n';
  }
  return text;
}

}  // namespace modslam
