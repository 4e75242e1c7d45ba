// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/rooms.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <tuple>

namespace modslam {
namespace {

constexpr double kReach_m = 3.0;    // walls are lengthened up to the next one by at most this
constexpr double kThrough_m = 4.0;  // walls are lengthened across corridors by this
constexpr double kFilled = 0.4;     // a face belongs to a region that fills this share of it
constexpr double kShared = 0.15;    // regions with this share of one face are one room
constexpr double kExplored = 0.5;   // rooms seen less are not claimed
constexpr double kConvex = 0.93;    // merged corridor pieces stay this convex
constexpr double kBranched = 0.62;  // regions that fill less of their hull are split
constexpr double kHollow = 1.5;     // outlines this much larger than their region hold more than it
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
  const auto largest = std::max_element(
      contours.begin(), contours.end(),
      [](const auto& p, const auto& q) { return cv::contourArea(p) < cv::contourArea(q); });
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

bool boxes_touch(const Polygon& p, const Polygon& q) {
  constexpr double kTouch_m = 0.02;
  const auto box = [](const Polygon& polygon) {
    Eigen::Array4d out(1e18, 1e18, 1e18, 1e18);  // least x, y, -x, -y
    for (const Eigen::Vector2d& c : polygon)
      out = out.min(Eigen::Array4d(c.x(), c.y(), -c.x(), -c.y()));
    return out;
  };
  const Eigen::Array4d a = box(p), b = box(q);
  return a[0] <= -b[2] + kTouch_m && b[0] <= -a[2] + kTouch_m && a[1] <= -b[3] + kTouch_m &&
         b[1] <= -a[3] + kTouch_m;
}

/// Joins touching faces of a branched region (corridors round a block, L and T shapes) as long as
/// the pieces stay convex, large ones first.
std::vector<Face> convex_pieces(std::vector<Face> faces) {
  struct Pair {
    double area_m2;
    std::size_t i, j;
    bool operator<(const Pair& other) const {
      return std::tie(area_m2, i, j) < std::tie(other.area_m2, other.i, other.j);
    }
  };
  std::set<Pair> pairs;
  const auto consider = [&](std::size_t i, std::size_t j) {
    if (faces[i].outline.empty() || !boxes_touch(faces[i].outline, faces[j].outline)) return;
    const double area = faces[i].area_m2 + faces[j].area_m2;
    if (area >= kConvex * hull_area_m2(faces[i], faces[j])) pairs.insert({area, i, j});
  };
  for (std::size_t j = 0; j < faces.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) consider(i, j);
  while (!pairs.empty()) {
    const Pair best = *pairs.rbegin();
    pairs.erase(std::prev(pairs.end()));
    if (faces[best.i].outline.empty() || faces[best.j].outline.empty()) continue;
    Face joined = united({faces[best.i], faces[best.j]}, 0.01, 0);
    if (joined.area_m2 < 0.99 * best.area_m2) continue;  // they touch at a corner at most
    faces[best.i] = faces[best.j] = Face();
    faces.push_back(std::move(joined));
    for (std::size_t i = 0; i + 1 < faces.size(); ++i) consider(i, faces.size() - 1);
  }
  faces.erase(std::remove_if(faces.begin(), faces.end(),
                             [](const Face& face) { return face.outline.empty(); }),
              faces.end());
  return faces;
}

/// Regions that turn out to be one room get one name.
class Unions {
 public:
  int root(int label) {
    const auto found = parent_.find(label);
    return found == parent_.end() ? label : found->second = root(found->second);
  }
  void join(int p, int q) {
    p = root(p), q = root(q);
    if (p != q) parent_[std::max(p, q)] = std::min(p, q);
  }

 private:
  std::map<int, int> parent_;
};

using FacesByRegion = std::map<int, std::vector<Face>>;

class RoomFinder {
 public:
  RoomFinder(const Raster& raster, const std::vector<Segment>& walls,
             const std::vector<Segment>& doors, const std::vector<Segment>& furniture,
             const SemanticsConfig& config)
      : raster_(raster), walls_(walls), config_(config) {
    walls_.insert(walls_.end(), doors.begin(), doors.end());
    all_ = walls_;
    all_.insert(all_.end(), furniture.begin(), furniture.end());
  }

  std::vector<Room> run() {
    const FacesByRegion enclosed_faces = faces_by_region(lengthened(walls_, kReach_m), true);
    std::map<int, double> area_of;
    for (int y = 0; y < raster_.labels.rows; ++y)
      for (int x = 0; x < raster_.labels.cols; ++x)
        if (const int label = raster_.labels.at<int>(y, x))
          area_of[unions_.root(label)] += raster_.resolution_m * raster_.resolution_m;
    for (const auto& [label, region_m2] : area_of) {
      if (region_m2 < config_.room_min_m2) continue;
      const Face whole = union_of(enclosed_faces, label);
      if (covers(whole, region_m2))
        needs_split(whole) ? add_pieces(label) : add(whole);
      else
        add_uncovered(label, region_m2);
    }
    return std::move(rooms_);
  }

 private:
  /// @param join  whether regions that share a face are one room: nothing stands between them but
  /// what hides the floor.
  FacesByRegion faces_by_region(const std::vector<Segment>& lines, bool join) {
    FacesByRegion out;
    for (Face& face : bounded_faces(lines)) {
      const Census here = census(raster_, face);
      int labelled = 0, best = 0, best_pixels = 0;
      for (const auto& [label, pixels] : here.of_label) {
        labelled += pixels;
        if (pixels > best_pixels) best = label, best_pixels = pixels;
      }
      if (best == 0 || labelled < kFilled * here.total) continue;
      for (const auto& [label, pixels] : here.of_label)
        if (join && pixels > kShared * here.total) unions_.join(best, label);
      out[best].push_back(std::move(face));
    }
    FacesByRegion merged;
    for (auto& [label, faces] : out) {
      auto& target = merged[unions_.root(label)];
      target.insert(target.end(), faces.begin(), faces.end());
    }
    return merged;
  }

  static Face union_of(const FacesByRegion& faces, int label) {
    const auto found = faces.find(label);
    return found == faces.end() ? Face() : united(found->second, 0.02, 0.03);
  }
  /// Much smaller: walls are missing around it; much larger: the lines leave a gap to a neighbour.
  static bool covers(const Face& face, double region_m2) {
    return face.area_m2 >= 0.8 * region_m2 && face.area_m2 <= kHollow * region_m2;
  }

  static bool needs_split(const Face& face) {
    for (const Polygon& hole : face.holes)
      if (std::abs(signed_area_m2(hole)) > 4) return true;
    return face.area_m2 < kBranched * hull_area_m2(face, face);
  }

  /// Walls lengthened through every corner cut a branched region into strips and squares.
  void add_pieces(int label) {
    if (!strips_) strips_ = faces_by_region(lengthened_through(walls_, kThrough_m), false);
    const auto found = strips_->find(label);
    if (found == strips_->end()) return;
    for (const Face& piece : convex_pieces(found->second)) add(united({piece}, 0.02, 0.03));
  }

  /// Walls do not enclose the region: strips of a branched one may still be, furniture may close
  /// it, else its own contour stands in.
  void add_uncovered(int label, double region_m2) {
    const Face own = contour(raster_, label);
    if (own.outline.empty()) return;
    if (own.area_m2 > kHollow * region_m2 || needs_split(own)) return add_pieces(label);
    if (!fine_) fine_ = faces_by_region(lengthened_through(all_, kThrough_m), false);
    const Face whole = union_of(*fine_, label);
    add(covers(whole, region_m2) && whole.holes.empty() ? whole : own);
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
    const double width = std::min(size.width, size.height),
                 length = std::max(size.width, size.height);
    if (width < 0.6) return;
    room.type =
        width < kCorridorWidth_m && length > 2.5 * width ? RoomType::kCorridor : RoomType::kRoom;
    rooms_.push_back(std::move(room));
  }

  /// Share of the outline that does not face unseen space across nothing.
  double enclosed(const Polygon& outline) const {
    int asked = 0;
    double closed = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Segment side{outline[i], outline[(i + 1) % outline.size()]};
      const Eigen::Vector2d d = side.direction(), out(d.y(), -d.x());
      const int n = std::max(1, static_cast<int>(side.length_m() / 0.2));
      for (int k = 0; k < n; ++k, ++asked) {
        const Eigen::Vector2d p = side.a + (k + 0.5) / n * (side.b - side.a);
        const bool hidden = raster_.label_at(p - 0.25 * out) == 0;
        const bool other_region = raster_.label_at(p + 0.25 * out) != 0;
        if (other_region || near_barrier(p))
          closed += 1;
        else if (hidden)
          closed += 0.5;
      }
    }
    return asked ? closed / asked : 0;
  }

  bool near_barrier(const Eigen::Vector2d& p) const {
    return std::any_of(all_.begin(), all_.end(), [&](const Segment& s) {
      return distance_to_segment(p, s) < kNearBarrier_m;
    });
  }

  const Raster& raster_;
  std::vector<Segment> walls_, all_;  ///< walls and doors; these and furniture
  const SemanticsConfig& config_;
  Unions unions_;
  std::optional<FacesByRegion> strips_, fine_;
  std::vector<Room> rooms_;
};

}  // namespace

std::vector<Room> find_rooms(const Raster& raster, const std::vector<Segment>& walls,
                             const std::vector<Segment>& doors,
                             const std::vector<Segment>& furniture, const SemanticsConfig& config) {
  if (raster.seen.empty()) return {};
  return RoomFinder(raster, walls, doors, furniture, config).run();
}

}  // namespace modslam
