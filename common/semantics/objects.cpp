// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/objects.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kOnWall_m = 0.12;    // hits this near belong to the wall
constexpr double kThinWall_m = 0.35;  // islands thinner than this and longer than 1 m are walls
constexpr double kAround_m = 0.25;    // free space is looked for this far around an island
constexpr double kHiddenGap_m = 1.5;  // walls go on behind things this long
constexpr double kFurnitureLength_m = 5.5;  // of what stands before a wall
constexpr double kLongDepth_m = 1.3;        // its depth when it is long (counters, shelves) ...
constexpr double kBulky_m = 2.6, kBulkyDepth_m = 2.2;  // ... and when it is not (beds, cupboards)
constexpr double kCarDepth_m = 5.2;                    // ... and of a parked car
constexpr int kTouch_cells = 3;                        // gaps bridged within one thing

/// Occupied cells as an image; row 0 lowest y.
struct HitImage {
  int ix0 = 0, iy0 = 0;
  double resolution_m = 0;
  cv::Mat mask;

  cv::Point pixel(const Eigen::Vector2d& p) const {
    return {static_cast<int>(std::floor(p.x() / resolution_m)) - ix0,
            static_cast<int>(std::floor(p.y() / resolution_m)) - iy0};
  }
  Eigen::Vector2d place(const cv::Point2d& p) const {
    return {(p.x + ix0 + 0.5) * resolution_m, (p.y + iy0 + 0.5) * resolution_m};
  }
};

bool occupied(const HitCell& cell, const Eigen::Vector2d& centre, const Evidence& evidence) {
  return cell.hits() >= 2 && evidence.crossings(centre) <= 15 * cell.hits();
}

HitImage hit_image(const Evidence& evidence) {
  const auto& grid = evidence.hits();
  std::vector<cv::Point> cells;
  grid.each([&](int ix, int iy, const HitCell& cell) {
    if (occupied(cell, {grid.centre_m(ix), grid.centre_m(iy)}, evidence))
      cells.emplace_back(ix, iy);
  });
  HitImage image;
  image.resolution_m = grid.resolution_m();
  if (cells.empty()) return image;
  const cv::Rect box = cv::boundingRect(cells);
  constexpr int kMargin = 4;
  image.ix0 = box.x - kMargin;
  image.iy0 = box.y - kMargin;
  image.mask = cv::Mat::zeros(box.height + 2 * kMargin, box.width + 2 * kMargin, CV_8U);
  for (const cv::Point& c : cells)
    image.mask.at<std::uint8_t>(c.y - image.iy0, c.x - image.ix0) = 255;
  return image;
}

cv::Mat touching(const cv::Mat& mask, cv::Mat& labels, int& n) {
  cv::Mat fat, stats, centroids;
  cv::dilate(mask, fat, cv::getStructuringElement(cv::MORPH_RECT, {kTouch_cells, kTouch_cells}));
  n = cv::connectedComponentsWithStats(fat, labels, stats, centroids, 8);
  return stats;
}

Polygon hull_of(const HitImage& image, const std::vector<cv::Point>& cells) {
  std::vector<cv::Point> hull;
  cv::convexHull(cells, hull);
  Polygon out;
  for (const cv::Point& p : hull) out.push_back(image.place(p));
  if (signed_area_m2(out) < 0) std::reverse(out.begin(), out.end());
  return out;
}

/// Share of the hull's sides, where something was hit, that face free space outward. Things seen
/// from outside have nearly all, corners of rooms nearly none, a lone wall piece about half.
double free_outward(const Polygon& hull, const HitImage& image, const Evidence& evidence) {
  int asked = 0, crossed = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Segment side{hull[i], hull[(i + 1) % hull.size()]};
    const Eigen::Vector2d d = side.direction(), out(d.y(), -d.x());
    const int n = std::max(1, static_cast<int>(side.length_m() / 0.1));
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d p = side.a + (k + 0.5) / n * (side.b - side.a);
      const cv::Rect around = cv::Rect(image.pixel(p) - cv::Point(2, 2), cv::Size(5, 5)) &
                              cv::Rect({0, 0}, image.mask.size());
      if (around.empty() || cv::countNonZero(image.mask(around)) == 0) continue;
      ++asked;
      crossed += evidence.crossings(p + kAround_m * out) > 1;
    }
  }
  return asked ? static_cast<double>(crossed) / asked : 0;
}

/// Share of the inside of a hull that beams have crossed: things hide their inside, corners and
/// branches of walls do not.
double free_inside(const Polygon& hull, const Evidence& evidence) {
  Eigen::Vector2d low = hull.front(), high = hull.front();
  for (const Eigen::Vector2d& p : hull) low = low.cwiseMin(p), high = high.cwiseMax(p);
  int asked = 0, crossed = 0;
  for (double x = low.x() + 0.05; x < high.x(); x += 0.1) {
    for (double y = low.y() + 0.05; y < high.y(); y += 0.1) {
      if (!contains(hull, {x, y})) continue;
      ++asked;
      crossed += evidence.crossings({x, y}) > 1;
    }
  }
  return asked ? static_cast<double>(crossed) / asked : 0;
}

/// A wall piece between two doors goes on as a wall on the same line.
bool continues(const Segment& piece, const std::vector<WallFace>& others, double max_gap_m) {
  const Eigen::Vector2d d = piece.direction(), n(-d.y(), d.x());
  return std::any_of(others.begin(), others.end(), [&](const WallFace& face) {
    const Segment& s = face.segment;
    if (std::abs(n.dot(s.direction())) > 0.1) return false;
    if (std::abs(n.dot(s.a - piece.a)) > 0.12 || std::abs(n.dot(s.b - piece.a)) > 0.12)
      return false;
    const double low = std::min(d.dot(s.a - piece.a), d.dot(s.b - piece.a));
    const double high = std::max(d.dot(s.a - piece.a), d.dot(s.b - piece.a));
    return low < piece.length_m() + max_gap_m && high > -max_gap_m;
  });
}

/// Component of the image that most of a face lies on; 0: none.
int component_of(const Segment& s, const HitImage& image, const cv::Mat& labels) {
  const int n = std::max(2, static_cast<int>(s.length_m() / 0.1));
  std::vector<int> seen;
  for (int i = 0; i <= n; ++i) {
    const cv::Point p = image.pixel(s.a + static_cast<double>(i) / n * (s.b - s.a));
    if (cv::Rect(0, 0, labels.cols, labels.rows).contains(p) && labels.at<int>(p) > 0)
      seen.push_back(labels.at<int>(p));
  }
  if (seen.empty()) return 0;
  std::nth_element(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2),
                   seen.end());
  return seen[seen.size() / 2];
}

enum class Island { kNo, kThin, kYes };

std::vector<Island> find_islands(const HitImage& image, const cv::Mat& labels, const cv::Mat& stats,
                                 const Evidence& evidence, double max_size_m) {
  std::vector<std::vector<cv::Point>> cells(static_cast<std::size_t>(stats.rows));
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (image.mask.at<std::uint8_t>(y, x))
        cells[static_cast<std::size_t>(labels.at<int>(y, x))].emplace_back(x, y);
  std::vector<Island> island(cells.size(), Island::kNo);
  for (std::size_t c = 1; c < cells.size(); ++c) {
    if (cells[c].empty()) continue;
    const cv::Size2f size = cv::minAreaRect(cells[c]).size;
    const double length = std::max(size.width, size.height) * image.resolution_m;
    const double width = std::min(size.width, size.height) * image.resolution_m;
    if (length > max_size_m || (width < kThinWall_m && length > 1)) continue;
    const Polygon hull = hull_of(image, cells[c]);
    if (free_outward(hull, image, evidence) > 0.6 &&
        (width < kThinWall_m || free_inside(hull, evidence) < 0.4))
      island[c] = width < kThinWall_m ? Island::kThin : Island::kYes;
  }
  return island;
}

/// What a front hides: from the wall line behind it up to itself.
struct Niche {
  Eigen::Vector2d origin, along, out;  ///< a place on the wall line; along it; towards the front
  double low, high, depth;

  bool holds(const Eigen::Vector2d& p) const {
    const double u = along.dot(p - origin), v = out.dot(p - origin);
    return u > low - 0.2 && u < high + 0.2 && v > -0.2 && v < depth + 0.15;
  }
};

/// Metres of walls on the line of `back` that look the same way, near the front.
double length_behind(const std::vector<WallFace>& faces, const Segment& back, const Niche& niche) {
  double sum = 0;
  for (const WallFace& face : faces) {
    const Segment& s = face.segment;
    if (niche.along.dot(s.direction()) < 0.99 ||
        std::abs(niche.out.dot(s.centre() - back.a)) > 0.12)
      continue;
    const double low = niche.along.dot(s.a - niche.origin),
                 high = niche.along.dot(s.b - niche.origin);
    if (low < niche.high + 1 && high > niche.low - 1) sum += s.length_m();
  }
  return sum;
}

/// Fronts that hide a wall which is seen beside them and looks the same way; and the sides of such
/// things.
std::vector<bool> stand_before_walls(const std::vector<WallFace>& faces, const Evidence& evidence) {
  std::vector<bool> furniture(faces.size());
  std::vector<Niche> niches;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Segment& front = faces[i].segment;
    for (const WallFace& other : faces) {
      const Segment& back = other.segment;
      const Eigen::Vector2d d = back.direction(), out(-d.y(), d.x());
      if (d.dot(front.direction()) < std::cos(0.15)) continue;
      const Niche niche{back.a,
                        d,
                        out,
                        d.dot(front.a - back.a),
                        d.dot(front.b - back.a),
                        out.dot(front.centre() - back.a)};
      const double length = front.length_m();
      const bool like_car = length > 1.4 && length < 2.3;
      const double max_depth = like_car            ? kCarDepth_m
                               : length < kBulky_m ? kBulkyDepth_m
                                                   : kLongDepth_m;
      if (niche.depth < 0.2 || niche.depth > max_depth || front.length_m() > kFurnitureLength_m)
        continue;
      if (niche.low > back.length_m() + 0.5 || niche.high < -0.5) continue;
      const Eigen::Vector2d half = 0.5 * niche.depth * out;
      if (seen_free(front.a - half + 0.1 * d, front.b - half - 0.1 * d, evidence) > 0.3) continue;
      if (length_behind(faces, back, niche) < 0.5 * front.length_m()) continue;
      furniture[i] = true;
      niches.push_back(niche);
      break;
    }
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Segment& side = faces[i].segment;
    furniture[i] =
        furniture[i] || std::any_of(niches.begin(), niches.end(), [&](const Niche& niche) {
          return std::abs(niche.along.dot(side.direction())) < 0.3 && niche.holds(side.a) &&
                 niche.holds(side.b);
        });
  }
  return furniture;
}

std::string guess_class(double length_m, double width_m) {
  if (length_m > 3.2 && length_m < 5.5 && width_m > 1.3 && width_m < 2.4) return "car";
  if (length_m < 0.8 && width_m > 0.15 && width_m > 0.6 * length_m) return "pillar";
  return "";
}

}  // namespace

WallSplit find_walls(const Evidence& evidence, const SemanticsConfig& config) {
  WallSplit split;
  const HitImage image = hit_image(evidence);
  if (image.mask.empty()) return split;
  const std::vector<OrientedCell> cells = oriented_cells(evidence);
  cv::Mat labels;
  int n = 0;
  const cv::Mat stats = touching(image.mask, labels, n);
  const std::vector<Island> island =
      find_islands(image, labels, stats, evidence, config.island_max_m);
  std::vector<WallFace> sure, thin;
  for (WallFace& face : find_faces(cells, evidence, config.wall_min_m)) {
    const Island kind = island[static_cast<std::size_t>(component_of(face.segment, image, labels))];
    (kind == Island::kNo     ? sure
     : kind == Island::kThin ? thin
                             : split.furniture)
        .push_back(std::move(face));
  }
  const std::vector<WallFace> anchors = sure;
  for (WallFace& face : thin)
    (continues(face.segment, anchors, config.door_max_m) ? sure : split.furniture)
        .push_back(std::move(face));
  sure = merge_faces(std::move(sure), cells, evidence, kHiddenGap_m);
  const std::vector<bool> furniture = stand_before_walls(sure, evidence);
  for (std::size_t i = 0; i < sure.size(); ++i)
    (furniture[i] ? split.furniture : split.walls).push_back(std::move(sure[i]));
  return split;
}

std::vector<Object> find_objects(const Evidence& evidence, const std::vector<WallFace>& walls) {
  std::vector<Object> objects;
  HitImage image = hit_image(evidence);
  if (image.mask.empty()) return objects;
  const int thickness = 2 * static_cast<int>(std::lround(kOnWall_m / image.resolution_m)) + 1;
  for (const WallFace& wall : walls)
    cv::line(image.mask, image.pixel(wall.segment.a), image.pixel(wall.segment.b), 0, thickness);
  cv::Mat labels;
  int n = 0;
  touching(image.mask, labels, n);
  std::vector<std::vector<cv::Point>> cells(static_cast<std::size_t>(n));
  std::vector<double> evidence_of(static_cast<std::size_t>(n));
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      if (!image.mask.at<std::uint8_t>(y, x)) continue;
      const auto c = static_cast<std::size_t>(labels.at<int>(y, x));
      cells[c].emplace_back(x, y);
      const HitCell* cell = evidence.hits().find(x + image.ix0, y + image.iy0);
      evidence_of[c] += std::clamp(0.4 * (cell->object - cell->wall), -6.0, 6.0);
    }
  }
  for (std::size_t c = 1; c < cells.size(); ++c) {
    if (cells[c].size() < 4) continue;
    const cv::Size2f size = cv::minAreaRect(cells[c]).size;
    const double length = std::max(size.width, size.height) * image.resolution_m;
    const double width = std::min(size.width, size.height) * image.resolution_m;
    if (length < 0.15 || width < 0.05) continue;
    Object object;
    object.outline = hull_of(image, cells[c]);
    object.area_m2 = signed_area_m2(object.outline);
    object.evidence = evidence_of[c] / static_cast<double>(cells[c].size());
    object.class_name = guess_class(length, width);
    if (object.outline.size() >= 3) objects.push_back(std::move(object));
  }
  return objects;
}

}  // namespace modslam
