// SPDX-License-Identifier: BSD-3-Clause
/// How good and how fast is the semantic classifier with perfect localisation? Casts rays in a
/// world (GeoJSON: walls, objects, closed doors) along one of its routes, classifies, scores
/// against the world. Usage: modslam-bench-semantics WORLD.geojson ROUTE|tour OUT_DIR, or
/// modslam-bench-semantics RUN.lcm final OUT_DIR for the nodes of a finished run at their last
/// poses (a picture and timing, no score).
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/evaluation/score_json.hpp"
#include "common/evaluation/semantic_scores.hpp"
#include "common/semantics/classifier.hpp"
#include "common/semantics/geojson.hpp"

namespace {

using namespace modslam;
/// Processor time: other programs on the machine do not count.
double now_ms() { return 1000.0 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::string read_text(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Everything that stops a beam.
std::vector<Segment> obstacles(const SemanticMap& world) {
  std::vector<Segment> out;
  const auto ring = [&](const Polygon& points) {
    for (std::size_t i = 0; i < points.size(); ++i)
      out.push_back({points[i], points[(i + 1) % points.size()]});
  };
  for (const MapWall& wall : world.walls) {
    const Eigen::Vector2d d = (wall.b - wall.a).normalized(),
                          n = 0.5 * wall.thickness_m * Eigen::Vector2d(-d.y(), d.x());
    ring({wall.a + n, wall.a - n, wall.b - n, wall.b + n});
  }
  for (const MapPolygon& object : world.objects) ring(object.outline);
  for (const MapDoor& door : world.doors)
    if (door.closed) out.push_back({door.a, door.b});
  return out;
}

double cast(const std::vector<Segment>& obstacles, const Eigen::Vector2d& from, double angle,
            double limit) {
  const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
  double nearest = limit;
  for (const Segment& s : obstacles) {
    const Eigen::Vector2d e = s.b - s.a, w = s.a - from;
    const double det = d.x() * e.y() - d.y() * e.x();
    if (std::abs(det) < 1e-12) continue;
    const double t = (w.x() * e.y() - w.y() * e.x()) / det,
                 u = (w.x() * d.y() - w.y() * d.x()) / det;
    if (t > 0 && t < nearest && u >= 0 && u <= 1) nearest = t;
  }
  return nearest;
}

/// A pose each 0.3 m along the route, and each 15 degrees where it turns.
std::vector<Pose2> poses_along(const std::vector<Eigen::Vector2d>& route) {
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i + 1 < route.size(); ++i) {
    const Eigen::Vector2d d = route[i + 1] - route[i];
    const double heading = std::atan2(d.y(), d.x());
    if (!poses.empty()) {
      const Pose2 last = poses.back();
      const double turn = wrap_angle(heading - last.heading);
      const int n = static_cast<int>(std::abs(turn) / 0.26);
      for (int k = 1; k <= n; ++k)
        poses.emplace_back(route[i].x(), route[i].y(), last.heading + turn * k / (n + 1));
    }
    const int n = std::max(1, static_cast<int>(d.norm() / 0.3));
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d p = route[i] + static_cast<double>(k) / n * d;
      poses.emplace_back(p.x(), p.y(), heading);
    }
  }
  return poses;
}

/// Into every room through its doors: from each door 0.8 m to both sides, to the room's middle,
/// turning there.
std::vector<Pose2> tour(const SemanticMap& world) {
  std::vector<Pose2> poses;
  for (const MapRoom& room : world.rooms) {
    Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const auto& p : room.polygon.outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
    for (const double u : {0.15, 0.3, 0.5, 0.7, 0.85}) {
      for (const double v : {0.3, 0.5, 0.7}) {
        const Eigen::Vector2d p = low + Eigen::Vector2d(u, v).cwiseProduct(high - low);
        if (!contains(room.polygon, p)) continue;
        const bool inside_object =
            std::any_of(world.objects.begin(), world.objects.end(),
                        [&](const MapPolygon& object) { return contains(object, p); });
        if (inside_object) continue;
        for (const double heading : {0.0, 2.1, 4.2}) poses.emplace_back(p.x(), p.y(), heading + u);
      }
    }
  }
  return poses;
}

void draw(const Semantics& semantics, const Evidence& evidence, const std::string& path) {
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  evidence.free().each([&](int ix, int iy, std::int32_t count) {
    if (!count) return;
    const double x = evidence.free().centre_m(ix), y = evidence.free().centre_m(iy);
    low_x = std::min(low_x, x), high_x = std::max(high_x, x), low_y = std::min(low_y, y),
    high_y = std::max(high_y, y);
  });
  constexpr double kPixels = 32;
  cv::Mat image(static_cast<int>((high_y - low_y + 1) * kPixels),
                static_cast<int>((high_x - low_x + 1) * kPixels), CV_8UC3,
                cv::Scalar(150, 150, 150));
  const auto pixel = [&](const Eigen::Vector2d& p) {
    return cv::Point(static_cast<int>((p.x() - low_x + 0.5) * kPixels),
                     static_cast<int>((high_y - p.y() + 0.5) * kPixels));
  };
  const auto cell = [&](const Eigen::Vector2d& centre, double side, const cv::Scalar& colour) {
    const Eigen::Vector2d half(side / 2, side / 2);
    cv::rectangle(image, pixel(centre - half), pixel(centre + half), colour, cv::FILLED);
  };
  evidence.free().each([&](int ix, int iy, std::int32_t count) {
    if (count > 1)
      cell({evidence.free().centre_m(ix), evidence.free().centre_m(iy)}, 0.1, {255, 255, 255});
  });
  for (const Room& room : semantics.rooms) {
    std::vector<cv::Point> points;
    for (const auto& p : room.outline) points.push_back(pixel(p));
    cv::Mat overlay = image.clone();
    cv::RNG colours(static_cast<std::uint64_t>(room.id) * 7919);
    cv::fillPoly(
        overlay, std::vector<std::vector<cv::Point>>{points},
        cv::Scalar(colours.uniform(80, 255), colours.uniform(80, 255), colours.uniform(80, 255)));
    cv::addWeighted(overlay, 0.45, image, 0.55, 0, image);
  }
  evidence.hits().each([&](int ix, int iy, const HitCell& hit) {
    if (hit.hits() > 1)
      cell({evidence.hits().centre_m(ix), evidence.hits().centre_m(iy)}, 0.05,
           hit.wall > hit.object ? cv::Scalar(90, 90, 90) : cv::Scalar(0, 140, 255));
  });
  for (const Object& object : semantics.objects)
    for (std::size_t i = 0; i < object.outline.size(); ++i)
      cv::line(image, pixel(object.outline[i]),
               pixel(object.outline[(i + 1) % object.outline.size()]), {0, 100, 200}, 1);
  for (const Wall& wall : semantics.walls)
    cv::line(image, pixel(wall.segment.a), pixel(wall.segment.b), {0, 160, 0}, 2);
  for (const Door& door : semantics.doors)
    cv::line(image, pixel(door.segment.a), pixel(door.segment.b), {220, 0, 220}, 4);
  cv::imwrite(path, image);
}

int bench(const std::string& world_path, const std::string& route_name,
          const std::string& directory) {
  const std::string text = read_text(world_path);
  const SemanticMap world = parse_semantic_map(text);
  std::vector<Pose2> poses;
  const nlohmann::json document = nlohmann::json::parse(text);
  for (const auto& feature : document["features"]) {
    if (feature["properties"]["kind"] != "route" || feature["properties"]["id"] != route_name)
      continue;
    std::vector<Eigen::Vector2d> route;
    for (const auto& p : feature["geometry"]["coordinates"])
      route.emplace_back(p[0].get<double>(), p[1].get<double>());
    poses = poses_along(route);
  }
  if (route_name == "tour") poses = tour(world);
  if (poses.empty()) throw std::runtime_error(world_path + ": has no route " + route_name);

  SensorInfo sensor;
  sensor.range_max_m = 20;
  const std::vector<Segment> stops = obstacles(world);
  std::mt19937 random(1);
  std::vector<PlacedScan> placed;
  SemanticClassifier classifier{SemanticsConfig()};
  double insert_ms = 0, render_ms = 0;
  int renders = 0;
  for (const Pose2& pose : poses) {
    Scan scan;
    scan.rad0 = -0.5 * kPi;
    scan.radstep = kPi / 180;
    for (int beam = 0; beam < 181; ++beam) {
      double noise = -6;  // Irwin-Hall
      for (int k = 0; k < 12; ++k) noise += static_cast<double>(random()) / 4294967296.0;
      const double range =
          cast(stops, pose.translation(),
               pose.heading + scan.bearing_rad(static_cast<std::size_t>(beam)), 20);
      scan.ranges_m.push_back(static_cast<float>(range >= 20 ? 20 : range + 0.015 * noise));
    }
    placed.push_back({pose, scan, sensor});
    double start = now_ms();
    classifier.insert(scan, sensor, pose);
    insert_ms += now_ms() - start;
    if (placed.size() % 20 == 0) {
      start = now_ms();
      classifier.render(static_cast<std::int64_t>(placed.size()));
      render_ms += now_ms() - start;
      ++renders;
    }
  }
  const double start = now_ms();
  const Semantics semantics = classifier.render(static_cast<std::int64_t>(placed.size()));
  std::cout << placed.size() << " scans, insert " << insert_ms / static_cast<double>(placed.size())
            << " ms, render mean " << render_ms / std::max(1, renders) << " ms, last "
            << (now_ms() - start) << " ms of processor time\n";
  const std::string geojson = semantic_geojson(semantics);
  std::ofstream(directory + "/semantic.geojson") << geojson;
  draw(semantics, classifier.evidence(), directory + "/semantic.png");
  std::cout << to_table(
      score_semantics(parse_semantic_map(geojson), world, visible_in(world, placed)));
  return 0;
}

int draw_run(const std::string& log_path, const std::string& directory) {
  LogReader log(log_path);
  std::map<std::int64_t, graph_node_t> nodes;
  std::map<std::int64_t, Pose2> poses;
  for (LogEvent event; log.next(event);) {
    const auto size = static_cast<int>(event.bytes.size());
    graph_node_t node{};
    graph_update_t update{};
    if (event.channel == "NODE" && node.decode(event.bytes.data(), 0, size) == size)
      nodes.emplace(node.id, node);
    if (event.channel == "GRAPH" && update.decode(event.bytes.data(), 0, size) == size)
      for (const auto& pose : update.poses) poses[pose.id] = to_pose(pose.T_map_base);
  }
  SemanticClassifier classifier{SemanticsConfig()};
  double start = now_ms();
  for (const auto& [id, node] : nodes) {
    const auto moved = poses.find(id);
    classifier.insert(to_scan(node.scan), to_sensor_info(node.sensor),
                      moved != poses.end() ? moved->second : to_pose(node.T_map_base));
  }
  std::cout << nodes.size() << " nodes, insert "
            << (now_ms() - start) / static_cast<double>(nodes.size()) << " ms";
  start = now_ms();
  const Semantics& semantics = classifier.render(0);
  std::cout << ", render " << (now_ms() - start) << " ms of processor time\n"
            << semantics.walls.size() << " walls, " << semantics.rooms.size() << " rooms, "
            << semantics.doors.size() << " doors\n";
  std::ofstream(directory + "/semantic.geojson") << semantic_geojson(semantics);
  draw(semantics, classifier.evidence(), directory + "/semantic.png");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: " << argv[0]
              << " WORLD.geojson ROUTE|tour OUT_DIR | RUN.lcm final OUT_DIR\n";
    return 1;
  }
  try {
    if (argv[2] == std::string("final")) return draw_run(argv[1], argv[3]);
    return bench(argv[1], argv[2], argv[3]);
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
