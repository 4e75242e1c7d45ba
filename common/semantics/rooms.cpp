// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/rooms.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kReach_m = 3.0;          // walls are lengthened by up to this
constexpr double kFilled = 0.4;           // a face belongs to a region that fills this share of it
constexpr double kExplored = 0.5;         // rooms seen less are not claimed
constexpr double kConvex = 0.93;          // merged corridor pieces stay this convex
constexpr double kBranched = 0.62;        // regions that fill less of their hull are split
constexpr double kCorridorWidth_m = 3.3;
constexpr double kNearBarrier_m = 0.3;

std::vector<cv::Point> pixels(const Raster& raster, const Polygon& polygon) {
  std::vector<cv::Point> out;
  for (const Eigen::Vector2d& p : polygon) {
    const Eigen::Vector2d q = raster.to_pixel(p);
    out.emplace_back(cvRound(q.x() * 16), cvRound(q.y() * 16));
  }
  return out;
}

/// Pixels of a face, and what was seen there.
struct Census {
  int total = 0, seen = 0;
  std::map<int, int> of_label;
};

Census census(const Raster& raster, const Face& face) {
  std::vector<std::vector<cv::Point>> rings{pixels(raster, face.outline)};
  for (const Polygon& hole : face.holes) rings.push_back(pixels(raster, hole));
  cv::Rect box = cv::boundingRect(rings.front());
  box = cv::Rect(box.x / 16 - 2, box.y / 16 - 2, box.width / 16 + 5, box.height / 16 + 5) &
        cv::Rect(0, 0, raster.seen.cols, raster.seen.rows);
  Census out;
  if (box.empty()) return out;
  cv::Mat mask = cv::Mat::zeros(box.size(), CV_8U);
  for (auto& ring : rings)
    for (cv::Point& p : ring) p -= 16 * box.tl();
  cv::fillPoly(mask, rings, 255, cv::LINE_8, 4);
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (!mask.at<std::uint8_t>(y, x)) continue;
      ++out.total;
      out.seen += raster.seen.at<std::uint8_t>(y + box.y, x + box.x) != 0;
      const int label = raster.labels.at<int>(y + box.y, x + box.x);
      if (label) ++out.of_label[label];
    }
  }
  return out;
}

/// Contour of a region of the raster, for where walls do not enclose it.
Face contour(const Raster& raster, int label) {
  std::vector<std::vector<cv::Point>> contours;
  cv::Mat region = raster.labels == label;
  cv::dilate(region, region, cv::Mat());  // up to the walls, which were cut out
  cv::findContours(region, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto largest = std::max_element(contours.begin(), contours.end(), [](const auto& p, const auto& q) {
    return cv::contourArea(p) < cv::contourArea(q);
  });
  Face face;
  if (largest == contours.end()) return face;
  std::vector<cv::Point> corners;
  cv::approxPolyDP(*largest, corners, 0.2 / raster.resolution_m, true);
  for (const cv::Point& p : corners) face.outline.push_back(raster.to_map({p.x, p.y}));
  face.area_m2 = signed_area_m2(face.outline);
  if (face.area_m2 < 0) std::reverse(face.outline.begin(), face.outline.end());
  face.area_m2 = std::abs(face.area_m2);
  return face;
}

/// Joins faces of a branched region (corridors round a block, L and T shapes) as long as the pieces stay convex, long ones first.
std::vector<Face> convex_pieces(std::vector<Face> faces) {
  while (faces.size() > 1) {
    double best_area = 0;
    std::size_t best_i = 0, best_j = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        const double area = faces[i].area_m2 + faces[j].area_m2;
        if (area <= best_area || area < kConvex * hull_area_m2(faces[i], faces[j])) continue;
        best_area = area, best_i = i, best_j = j;
      }
    }
    if (best_area == 0) break;
    const Face joined = united({faces[best_i], faces[best_j]}, 0.01, 0);
    faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(best_j));
    faces[best_i] = joined;
  }
  return faces;
}

class RoomFinder {
 public:
  RoomFinder(const Raster& raster, const std::vector<Segment>& walls, const std::vector<Segment>& doors,
             const SemanticsConfig& config)
      : raster_(raster), barriers_(walls), config_(config) {
    barriers_.insert(barriers_.end(), doors.begin(), doors.end());
  }

  std::vector<Room> run() {
    std::map<int, int> pixels_of;
    for (int y = 0; y < raster_.labels.rows; ++y)
      for (int x = 0; x < raster_.labels.cols; ++x)
        if (const int label = raster_.labels.at<int>(y, x)) ++pixels_of[label];
    const auto faces_of = faces_by_region();
    for (const auto& [label, n] : pixels_of) {
      const double region_m2 = n * raster_.resolution_m * raster_.resolution_m;
      if (region_m2 < config_.room_min_m2) continue;
      const auto found = faces_of.find(label);
      Face whole = found == faces_of.end() ? Face() : united(found->second, 0.02, 0.03);
      if (whole.area_m2 < 0.8 * region_m2) {
        add(contour(raster_, label));
      } else if (needs_split(whole)) {
        for (const Face& piece : convex_pieces(found->second)) add(united({piece}, 0.02, 0.03));
      } else {
        add(whole);
      }
    }
    return std::move(rooms_);
  }

 private:
  std::map<int, std::vector<Face>> faces_by_region() const {
    std::map<int, std::vector<Face>> out;
    for (Face& face : bounded_faces(lengthened(barriers_, kReach_m))) {
      const Census here = census(raster_, face);
      const auto best = std::max_element(here.of_label.begin(), here.of_label.end(),
                                         [](const auto& p, const auto& q) { return p.second < q.second; });
      if (best == here.of_label.end() || best->second < kFilled * here.total) continue;
      out[best->first].push_back(std::move(face));
    }
    return out;
  }

  static bool needs_split(const Face& face) {
    for (const Polygon& hole : face.holes)
      if (std::abs(signed_area_m2(hole)) > 4) return true;
    return face.area_m2 < kBranched * hull_area_m2(face, face);
  }

  void add(const Face& face) {
    if (face.area_m2 < config_.room_min_m2 || face.outline.size() < 3) return;
    const Census here = census(raster_, face);
    Room room;
    room.outline = face.outline;
    room.area_m2 = face.area_m2;
    room.explored = here.total ? static_cast<double>(here.seen) / here.total : 0;
    if (room.explored < kExplored || enclosed(face.outline) < config_.enclosed_min) return;
    std::vector<cv::Point2f> corners;
    for (const Eigen::Vector2d& p : face.outline)
      corners.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    const cv::Size2f size = cv::minAreaRect(corners).size;
    const double width = std::min(size.width, size.height), length = std::max(size.width, size.height);
    if (width < 0.6) return;
    room.type = width < kCorridorWidth_m && length > 2.5 * width ? RoomType::kCorridor : RoomType::kRoom;
    rooms_.push_back(std::move(room));
  }

  /// Share of the outline that does not face unseen space across nothing.
  double enclosed(const Polygon& outline) const {
    int asked = 0, closed = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Segment side{outline[i], outline[(i + 1) % outline.size()]};
      const Eigen::Vector2d d = side.direction(), out(d.y(), -d.x());
      const int n = std::max(1, static_cast<int>(side.length_m() / 0.2));
      for (int k = 0; k < n; ++k, ++asked) {
        const Eigen::Vector2d p = side.a + (k + 0.5) / n * (side.b - side.a);
        const bool hidden = raster_.label_at(p - 0.25 * out) == 0;
        const bool other_region = raster_.label_at(p + 0.25 * out) != 0;
        closed += hidden || other_region || near_barrier(p);
      }
    }
    return asked ? static_cast<double>(closed) / asked : 0;
  }

  bool near_barrier(const Eigen::Vector2d& p) const {
    return std::any_of(barriers_.begin(), barriers_.end(),
                       [&](const Segment& s) { return distance_to_segment(p, s) < kNearBarrier_m; });
  }

  const Raster& raster_;
  std::vector<Segment> barriers_;
  const SemanticsConfig& config_;
  std::vector<Room> rooms_;
};

}  // namespace

std::vector<Room> find_rooms(const Raster& raster, const std::vector<Segment>& walls, const std::vector<Segment>& doors,
                             const SemanticsConfig& config) {
  if (raster.seen.empty()) return {};
  return RoomFinder(raster, walls, doors, config).run();
}

}  // namespace modslam
