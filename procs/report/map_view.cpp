// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/map_view.hpp"

#include <algorithm>
#include <cmath>
#include <modslam/scan_match_t.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace modslam::report {
namespace {

constexpr double kMaxWidth_px = 1080, kMaxHeight_px = 860, kEdge_px = 26;

/// From map metres (y up) to picture pixels (y down).
class Sheet {
 public:
  void include(const Eigen::Vector2d& p) {
    if (!p.allFinite()) return;
    low_ = any_ ? low_.cwiseMin(p) : p;
    high_ = any_ ? high_.cwiseMax(p) : p;
    any_ = true;
  }
  void settle() {
    low_ -= Eigen::Vector2d::Constant(0.5);
    high_ += Eigen::Vector2d::Constant(0.5);
    const Eigen::Vector2d size = high_ - low_;
    px_per_m_ = std::min((kMaxWidth_px - 2 * kEdge_px) / size.x(),
                         (kMaxHeight_px - 2 * kEdge_px) / size.y());
  }
  Eigen::Vector2d px(const Eigen::Vector2d& p) const {
    return {kEdge_px + (p.x() - low_.x()) * px_per_m_, kEdge_px + (high_.y() - p.y()) * px_per_m_};
  }
  Points px(const Points& points) const {
    Points out;
    for (const Eigen::Vector2d& p : points) out.push_back(px(p));
    return out;
  }
  double px_per_m() const { return px_per_m_; }
  const Eigen::Vector2d& low() const { return low_; }
  const Eigen::Vector2d& high() const { return high_; }
  double width_px() const { return 2 * kEdge_px + (high_.x() - low_.x()) * px_per_m_; }
  double height_px() const { return 2 * kEdge_px + (high_.y() - low_.y()) * px_per_m_; }

 private:
  bool any_ = false;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), high_ = low_;
  double px_per_m_ = 1;
};

template <class Item>
Points corners(const Item& item) {
  Points points;
  for (std::size_t i = 0; i < item.x.size(); ++i)
    if (std::isfinite(item.x[i]) && std::isfinite(item.y[i]))
      points.push_back({item.x[i], item.y[i]});
  return points;
}

Eigen::Vector2d at(const double (&p)[2]) { return {p[0], p[1]}; }

Sheet make_sheet(const RunRecord& run, const Results& r) {
  Sheet sheet;
  if (!r.map.empty()) {
    sheet.include(r.map.origin_m);
    sheet.include(r.map.origin_m + r.map.resolution_m * Eigen::Vector2d(r.map.width, r.map.height));
  }
  for (const PathPose& p : r.path) sheet.include(p.pose.translation());
  for (const wall_t& w : run.semantics.walls.items())
    sheet.include(at(w.a)), sheet.include(at(w.b));
  for (const room_t& room : run.semantics.rooms.items())
    for (const Eigen::Vector2d& p : corners(room)) sheet.include(p);
  sheet.settle();
  return sheet;
}

/// Grey for occupied, white for free, nothing where nothing is known; as sure as the map is.
std::string map_picture(const MapImage& map) {
  cv::Mat picture(map.height, map.width, CV_8UC4);
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      const int cell = map.at(column, row);
      const double sure = std::abs(2.0 * (cell - 1) / 254.0 - 1.0);
      const std::uint8_t grey = cell > 127 ? 30 : 255;
      const std::uint8_t alpha =
          cell == 0 ? 0 : static_cast<std::uint8_t>(std::lround(255 * std::sqrt(sure)));
      picture.at<cv::Vec4b>(map.height - 1 - row, column) = {grey, grey, grey, alpha};
    }
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", picture, png))
    throw std::runtime_error("the map cannot be packed as PNG");
  return {png.begin(), png.end()};
}

std::string draw_map(const Sheet& sheet, const MapImage& map) {
  if (map.empty()) return "";
  const double width = map.width * map.resolution_m, height = map.height * map.resolution_m;
  const Eigen::Vector2d corner = sheet.px(map.origin_m + Eigen::Vector2d(0, height));
  return "<image class=\"grid-map\" x=\"" + number(corner.x(), 2) + "\" y=\"" +
         number(corner.y(), 2) + "\" width=\"" + number(width * sheet.px_per_m(), 2) +
         "\" height=\"" + number(height * sheet.px_per_m(), 2) +
         "\" href=\"data:image/png;base64," + base64(map_picture(map)) + "\"/>\n";
}

std::string draw_axes(const Sheet& sheet) {
  const Eigen::Vector2d low = sheet.low(), high = sheet.high();
  const double step = round_step(std::max(high.x() - low.x(), high.y() - low.y()), 12);
  const Eigen::Vector2d corner(sheet.width_px() - kEdge_px, sheet.height_px() - kEdge_px);
  std::string out;
  for (double x = std::ceil(low.x() / step) * step; x <= high.x(); x += step) {
    const double px = sheet.px(Eigen::Vector2d(x, 0)).x();
    out += line({px, kEdge_px}, {px, corner.y()}, "class=\"lattice\"");
    out += text_at({px, corner.y() + 16}, number(x), "class=\"tick\" text-anchor=\"middle\"");
  }
  for (double y = std::ceil(low.y() / step) * step; y <= high.y(); y += step) {
    const double px = sheet.px(Eigen::Vector2d(0, y)).y();
    out += line({kEdge_px, px}, {corner.x(), px}, "class=\"lattice\"");
    out += text_at({kEdge_px - 4, px + 4}, number(y), "class=\"tick\" text-anchor=\"end\"");
  }
  out += text_at({corner.x(), corner.y() + 16}, "m", "class=\"tick\" text-anchor=\"end\"");
  return out;
}

std::string draw_rooms(const Sheet& sheet, const std::vector<room_t>& rooms) {
  std::string areas, labels;
  for (const room_t& room : rooms) {
    const Points points = sheet.px(corners(room));
    if (points.size() < 3) continue;
    const std::string tone = room.type == room_t::CORRIDOR
                                 ? "corridor"
                                 : "tone" + std::to_string(static_cast<std::uint64_t>(room.id) % 6);
    areas += polygon(points, "class=\"room " + tone + "\"");
    const Eigen::Vector2d place = label_point(points);
    const std::string name =
        room.name.empty() ? room_type_name(room.type) + (" " + std::to_string(room.id)) : room.name;
    labels += text_at(place, name, "class=\"room-name\"");
    labels += text_at(place + Eigen::Vector2d(0, 15), number(room.area_m2) + " m²",
                      "class=\"room-area\"");
  }
  return areas + labels;
}

std::string draw_walls(const Sheet& sheet, const std::vector<wall_t>& walls) {
  std::string out;
  for (const wall_t& w : walls) out += line(sheet.px(at(w.a)), sheet.px(at(w.b)), "class=\"wall\"");
  return out;
}

std::string draw_doors(const Sheet& sheet, const std::vector<door_t>& doors) {
  std::string out;
  for (const door_t& d : doors) {
    const Eigen::Vector2d a = sheet.px(at(d.a)), b = sheet.px(at(d.b));
    out += line(a, b, d.state == door_t::CLOSED ? "class=\"door closed\"" : "class=\"door\"");
    out += circle(a, 3, "class=\"jamb\"") + circle(b, 3, "class=\"jamb\"");
  }
  return out;
}

std::string draw_objects(const Sheet& sheet, const std::vector<object_t>& objects) {
  std::string out;
  for (const object_t& o : objects) out += polygon(sheet.px(corners(o)), "class=\"object\"");
  return out;
}

std::string draw_path(const Sheet& sheet, const Points& path_m, const char* kind) {
  return polyline(simplify(sheet.px(path_m), 0.25), std::string("class=\"path ") + kind + "\"");
}

Points places(const std::vector<PathPose>& path) {
  Points points;
  for (const PathPose& p : path) points.push_back(p.pose.translation());
  return points;
}

std::string draw_start_and_end(const Sheet& sheet, const std::vector<PathPose>& path) {
  if (path.empty()) return "";
  const Eigen::Vector2d a = sheet.px(path.front().pose.translation()),
                        b = sheet.px(path.back().pose.translation());
  return circle(a, 6, "class=\"end\"") + circle(b, 6, "class=\"end\"") +
         text_at(a + Eigen::Vector2d(0, 3.5), "S", "class=\"end-name\"") +
         text_at(b + Eigen::Vector2d(0, 3.5), "E", "class=\"end-name\"");
}

std::string draw_graph(const Sheet& sheet, const RunRecord& run, const Results& r, EdgeKind kind) {
  std::string out;
  for (const auto& [id, edge] : run.graph.edges()) {
    const auto from = r.nodes.find(edge.from), to = r.nodes.find(edge.to);
    if (edge.kind != kind || from == r.nodes.end() || to == r.nodes.end()) continue;
    out += line(sheet.px(from->second.translation()), sheet.px(to->second.translation()),
                kind == EdgeKind::kLoop ? "class=\"loop\"" : "class=\"edge\"");
  }
  return out;
}

std::string draw_nodes(const Sheet& sheet, const Results& r) {
  std::string out;
  for (const auto& [id, pose] : r.nodes)
    out += circle(sheet.px(pose.translation()), 1.6, "class=\"node\"");
  return out;
}

std::string draw_world(const Sheet& sheet, const WorldOutline& world, const Pose2& T_map_world) {
  std::string out;
  const auto draw = [&](const std::vector<Points>& lines, const char* attributes) {
    for (const Points& points : lines) {
      Points in_map;
      for (const Eigen::Vector2d& p : points) in_map.push_back(T_map_world * p);
      out += polyline(sheet.px(in_map), attributes);
    }
  };
  draw(world.walls, "class=\"true-wall\"");
  draw(world.doors, "class=\"true-door\"");
  return out;
}

struct Layer {
  const char* id;
  const char* name;
  std::string drawing;
  bool shown = true;
};

std::vector<Layer> draw_layers(const Sheet& sheet, const RunRecord& run, const Results& r,
                               const WorldOutline* world) {
  std::vector<Layer> layers;
  layers.push_back({"map", "map", draw_map(sheet, r.map)});
  layers.push_back({"rooms", "rooms", draw_rooms(sheet, run.semantics.rooms.items())});
  if (world && r.error)
    layers.push_back({"world", "the world as it is",
                      draw_world(sheet, *world, r.error->best.T_world_map.inverse())});
  layers.push_back({"objects", "objects", draw_objects(sheet, run.semantics.objects.items())});
  layers.push_back({"walls", "walls", draw_walls(sheet, run.semantics.walls.items())});
  layers.push_back({"doors", "doors", draw_doors(sheet, run.semantics.doors.items())});
  if (r.error) {
    Points truth;
    for (const PosePair& p : r.error->pairs)
      truth.push_back((r.error->best.T_world_map.inverse() * p.T_world_base).translation());
    layers.push_back({"truth", "true path", draw_path(sheet, truth, "truth")});
  }
  if (!run.odometry.empty() && !r.path.empty()) {
    const Pose2 T_map_odom = r.path[0].pose * run.odometry[0].pose.inverse();
    Points odometry;
    for (const PathPose& p : run.odometry) odometry.push_back((T_map_odom * p.pose).translation());
    layers.push_back({"odometry", "odometry", draw_path(sheet, odometry, "odometry"), false});
  }
  layers.push_back({"loops", "loop edges", draw_graph(sheet, run, r, EdgeKind::kLoop)});
  layers.push_back({"graph", "nodes and edges",
                    draw_graph(sheet, run, r, EdgeKind::kSequence) + draw_nodes(sheet, r), false});
  layers.push_back({"path", "path",
                    draw_path(sheet, places(r.path), "ours") + draw_start_and_end(sheet, r.path)});
  return layers;
}

}  // namespace

std::string map_view(const RunRecord& run, const Results& r, const WorldOutline* world) {
  const Sheet sheet = make_sheet(run, r);
  std::string switches, drawing;
  for (const Layer& layer : draw_layers(sheet, run, r, world)) {
    if (layer.drawing.empty()) continue;
    const std::string id = layer.id;
    switches += "<label><input type=\"checkbox\" data-layer=\"" + id + "\"" +
                (layer.shown ? " checked" : "") + "><i class=\"swatch " + id + "\"></i>" +
                layer.name + "</label>\n";
    drawing += "<g id=\"layer-" + id + "\"" + (layer.shown ? "" : " style=\"display:none\"") +
               ">\n" + layer.drawing + "</g>\n";
  }
  const std::string size = number(sheet.width_px()) + " " + number(sheet.height_px());
  const std::string frame = "x=\"" + number(kEdge_px) + "\" y=\"" + number(kEdge_px) +
                            "\" width=\"" + number(sheet.width_px() - 2 * kEdge_px) +
                            "\" height=\"" + number(sheet.height_px() - 2 * kEdge_px) + "\"/>";
  return "<div class=\"switches\">" + switches + "</div>\n<svg class=\"map\" viewBox=\"0 0 " +
         size + "\" style=\"max-width:" + number(sheet.width_px()) +
         "px\" role=\"img\" aria-label=\"map of the run\">\n" +
         "<defs><clipPath id=\"sheet\"><rect " + frame +
         "</clipPath></defs>\n<rect class=\"sheet\" " + frame + draw_axes(sheet) +
         "<g clip-path=\"url(#sheet)\">\n" + drawing + "</g>\n</svg>\n";
}

}  // namespace modslam::report
