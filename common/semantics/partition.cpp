// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/partition.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kLookFrom_m = 0.08, kLookTo_m = 0.6;  // beside a cut, for the region there
constexpr double kOnWall_m = 0.2;
constexpr double kSlotDepth_m = 2.5, kMostSlotDepth_m = 6.5, kSlotMouth = 0.8;
constexpr double kCarFrom_m = 1.2, kCarTo_m = 2.6;
constexpr double kSameWay = 0.7;                       // |cos| of cuts that may be one opening

double side_of(const Vec& a, const Vec& b, const Vec& p) { return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x(); }

bool cross_each_other(const Opening& p, const Opening& q) {
  const Vec inward_p = 0.05 * (p.b - p.a).normalized(), inward_q = 0.05 * (q.b - q.a).normalized();
  const Vec pa = p.a + inward_p, pb = p.b - inward_p, qa = q.a + inward_q, qb = q.b - inward_q;
  return side_of(pa, pb, qa) * side_of(pa, pb, qb) < 0 && side_of(qa, qb, pa) * side_of(qa, qb, pb) < 0;
}

/// Cuts of one opening lie side by side or across each other.
bool same_opening(const Opening& p, const Opening& q) {
  if (cross_each_other(p, q)) return true;
  const double near = 0.5 * std::max(p.width_m(), q.width_m());
  return (p.centre() - q.centre()).norm() < near && std::abs((p.b - p.a).normalized().dot((q.b - q.a).normalized())) > kSameWay;
}

/// Sets of regions that became one.
class Regions {
 public:
  explicit Regions(int count) : parent_(static_cast<std::size_t>(count)) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int k) const {
    while (parent_[static_cast<std::size_t>(k)] != k) k = parent_[static_cast<std::size_t>(k)];
    return k;
  }
  void join(int p, int q) { parent_[static_cast<std::size_t>(root(p))] = root(q); }

 private:
  std::vector<int> parent_;
};

/// A dead end as a box: the direction across it (along its short sides) and its sides [cells].
struct Niche {
  Vec centre, across;
  double width, depth;
};

Niche box_of(const std::vector<cv::Point>& cells) {
  const cv::RotatedRect box = cv::minAreaRect(cells);
  const bool first_is_short = box.size.width < box.size.height;
  const double angle = box.angle * CV_PI / 180 + (first_is_short ? 0 : CV_PI / 2);
  return {Vec(box.center.x, box.center.y), Vec(std::cos(angle), std::sin(angle)), std::min(box.size.width, box.size.height) + 1.0,
          std::max(box.size.width, box.size.height) + 1.0};
}

/// As wide all the way as its mouth, and deep.
bool is_slot(const Niche& niche, const Opening& mouth, double cell_m) {
  const double width_m = niche.width * cell_m, depth_m = niche.depth * cell_m;
  const Vec u = (mouth.b - mouth.a).normalized();
  return depth_m > kSlotDepth_m && depth_m < kMostSlotDepth_m && depth_m > 1.5 * width_m && std::abs(u.dot(niche.across)) > kSameWay &&
         mouth.width_m() > kSlotMouth * width_m;
}

/// Thickness of what stands beside a slot, half way in; `sign` tells the side. 0: more than a car's width.
double beside_m(const Niche& niche, const Floor& floor, double sign) {
  for (double s = 0.5 * niche.width + 1; s < 0.5 * niche.width + kCarTo_m / floor.resolution_m + 2; s += 0.5) {
    const Vec p = niche.centre + sign * s * niche.across;
    const cv::Point c(cvRound(p.x()), cvRound(p.y()));
    if (c.x >= 0 && c.y >= 0 && c.x < floor.open.cols && c.y < floor.open.rows && floor.open(c)) return (s - 0.5 * niche.width) * floor.resolution_m;
  }
  return 0;
}

int region_beside(const cv::Mat1i& labels, const KnownSpace& space, const Opening& cut, double sign) {
  const Vec d = (cut.b - cut.a).normalized(), n = sign * Vec(-d.y(), d.x());
  for (double s = kLookFrom_m; s <= kLookTo_m; s += 0.04)
    for (const double t : {0.5, 0.35, 0.65}) {
      const cv::Point c = space.cell(cut.a + t * (cut.b - cut.a) + s * n);
      if (space.inside(c) && labels(c) > 0) return labels(c);
    }
  return 0;
}

void join_small_regions(const std::vector<CutOpening>& cuts, std::vector<double> area_m2, double min_room_m2, Regions& regions) {
  for (;;) {
    // The smallest region that has a neighbour goes first; each round makes one region fewer.
    int smallest = 0;
    const CutOpening* way = nullptr;
    for (const CutOpening& cut : cuts) {
      const int left = regions.root(cut.left), right = regions.root(cut.right);
      if (cut.left == 0 || cut.right == 0 || left == right) continue;
      for (const int side : {left, right}) {
        const double area = area_m2[static_cast<std::size_t>(side)];
        if (area >= min_room_m2) continue;
        const bool better = !way || area < area_m2[static_cast<std::size_t>(smallest)] ||
                            (side == smallest && cut.opening.probability < way->opening.probability);
        if (better) smallest = side, way = &cut;
      }
    }
    if (!way) return;
    const double sum = area_m2[static_cast<std::size_t>(regions.root(way->left))] + area_m2[static_cast<std::size_t>(regions.root(way->right))];
    regions.join(way->left, way->right);
    area_m2[static_cast<std::size_t>(regions.root(way->left))] = sum;
  }
}

/// Share of each region's rim that lies on walls; where a region meets another or a cut is no rim.
std::vector<double> walled_shares(const cv::Mat1i& labels, int count, const KnownSpace& space, const std::vector<Wall>& walls, const cv::Mat1b& floor) {
  cv::Mat1b on_wall(labels.size(), std::uint8_t{0});
  const int thick = 2 * static_cast<int>(std::lround(kOnWall_m / space.resolution_m)) + 1;
  for (const Wall& wall : walls) cv::line(on_wall, space.cell(wall.a), space.cell(wall.b), cv::Scalar(255), thick);
  std::vector<int> rim(static_cast<std::size_t>(count), 0), walled(static_cast<std::size_t>(count), 0);
  for (int y = 1; y + 1 < labels.rows; ++y)
    for (int x = 1; x + 1 < labels.cols; ++x) {
      const int label = labels(y, x);
      if (label == 0 || (floor(y, x - 1) && floor(y, x + 1) && floor(y - 1, x) && floor(y + 1, x))) continue;
      ++rim[static_cast<std::size_t>(label)];
      walled[static_cast<std::size_t>(label)] += on_wall(y, x) > 0;
    }
  std::vector<double> shares;
  for (std::size_t k = 0; k < rim.size(); ++k) shares.push_back(rim[k] ? static_cast<double>(walled[k]) / rim[k] : 0.0);
  return shares;
}

void heal(cv::Mat1i& labels, const cv::Mat1b& open, const KnownSpace& space, const CutOpening& cut) {
  cv::LineIterator cells(labels, space.cell(cut.opening.a), space.cell(cut.opening.b), 8);
  for (int k = 0; k < cells.count; ++k, ++cells)
    if (open(cells.pos()) && labels(cells.pos()) == 0) labels(cells.pos()) = cut.left;
}

/// Gaps between parked cars: dead ends as wide as their mouths with a car's width of closed space beside them. They are no rooms.
std::vector<int> join_slots(const std::vector<CutOpening>& cuts, const cv::Mat1i& labels, const Floor& floor, std::vector<double>& area_m2,
                            Regions& regions) {
  std::vector<int> slots;
  std::map<int, std::vector<const CutOpening*>> of_region;
  for (const CutOpening& cut : cuts)
    if (cut.left && cut.right && cut.left != cut.right) of_region[cut.left].push_back(&cut), of_region[cut.right].push_back(&cut);
  std::map<int, std::vector<cv::Point>> cells;
  for (const auto& [region, ways] : of_region)
    if (ways.size() == 1 && area_m2[static_cast<std::size_t>(region)] < kMostSlotDepth_m * kMostSlotDepth_m / 1.5) cells[region];
  std::vector<std::vector<cv::Point>*> wanted(area_m2.size(), nullptr);
  for (auto& [region, inside] : cells) wanted[static_cast<std::size_t>(region)] = &inside;
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (auto* inside = wanted[static_cast<std::size_t>(labels(y, x))]) inside->emplace_back(x, y);
  for (const auto& [region, inside] : cells) {
    if (inside.empty()) continue;
    const CutOpening& way = *of_region[region][0];
    const Niche niche = box_of(inside);
    if (!is_slot(niche, way.opening, floor.resolution_m)) continue;
    if (beside_m(niche, floor, -1) < kCarFrom_m && beside_m(niche, floor, 1) < kCarFrom_m) continue;
    const int left = regions.root(way.left), right = regions.root(way.right);
    const double sum = area_m2[static_cast<std::size_t>(left)] + area_m2[static_cast<std::size_t>(right)];
    regions.join(left, right);
    area_m2[static_cast<std::size_t>(regions.root(left))] = sum;
    slots.push_back(region);
  }
  return slots;
}

}  // namespace

Partition part_floor(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, std::vector<Opening> openings,
                     const PartitionOptions& options) {
  Partition out;
  if (floor.open.empty()) return out;
  std::stable_sort(openings.begin(), openings.end(), [](const Opening& p, const Opening& q) { return p.probability > q.probability; });
  cv::Mat1b open = floor.open.clone();
  for (const Opening& opening : openings) {
    if (opening.probability < options.min_probability) break;
    const bool told = std::any_of(out.cuts.begin(), out.cuts.end(), [&](const CutOpening& cut) { return same_opening(cut.opening, opening); });
    if (told) continue;
    out.cuts.push_back({opening, 0, 0});
    cv::line(open, space.cell(opening.a), space.cell(opening.b), cv::Scalar(0), 1, cv::LINE_8);  // stops a flood over sides
  }
  cv::Mat1i statistics;
  cv::Mat1d centres;
  const int count = cv::connectedComponentsWithStats(open, out.labels, statistics, centres, 4, CV_32S);
  std::vector<double> area_m2;
  for (int k = 0; k < count; ++k) area_m2.push_back(statistics(k, cv::CC_STAT_AREA) * floor.resolution_m * floor.resolution_m);
  for (CutOpening& cut : out.cuts) {
    cut.left = region_beside(out.labels, space, cut.opening, 1);
    cut.right = region_beside(out.labels, space, cut.opening, -1);
  }
  Regions regions(count);
  if (!walls.empty()) {
    const auto shares = walled_shares(out.labels, count, space, walls, floor.open);
    for (std::size_t k = 0; k < area_m2.size(); ++k)
      if (area_m2[k] < options.small_m2 && shares[k] < options.min_walled) area_m2[k] = std::min(area_m2[k], 0.5 * options.min_room_m2);
  }
  const std::vector<int> slots = join_slots(out.cuts, out.labels, floor, area_m2, regions);
  join_small_regions(out.cuts, area_m2, options.min_room_m2, regions);
  std::vector<int> roots(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) roots[static_cast<std::size_t>(k)] = regions.root(k);
  for (int y = 0; y < out.labels.rows; ++y)
    for (int x = 0; x < out.labels.cols; ++x) out.labels(y, x) = roots[static_cast<std::size_t>(out.labels(y, x))];
  for (const int slot : slots) out.parking.insert(regions.root(slot));
  for (CutOpening& cut : out.cuts) cut.left = regions.root(cut.left), cut.right = regions.root(cut.right);
  for (const CutOpening& cut : out.cuts)  // where two regions became one, the cut is floor again
    if (cut.left == cut.right && cut.left) heal(out.labels, floor.open, space, cut);
  out.cuts.erase(std::remove_if(out.cuts.begin(), out.cuts.end(), [](const CutOpening& cut) { return cut.left == cut.right || !cut.left || !cut.right; }),
                 out.cuts.end());
  return out;
}

std::set<int> glimpses(const Partition& partition, double cell_m, double most_m2) {
  std::map<int, int> ways;
  for (const CutOpening& cut : partition.cuts) ++ways[cut.left], ++ways[cut.right];
  std::vector<int> cells(ways.empty() ? 1 : static_cast<std::size_t>(ways.rbegin()->first) + 1, 0);
  for (int y = 0; y < partition.labels.rows; ++y)
    for (const int* label = partition.labels[y]; label != partition.labels[y] + partition.labels.cols; ++label)
      if (*label < static_cast<int>(cells.size())) ++cells[static_cast<std::size_t>(*label)];
  std::set<int> out;
  for (const auto& [region, count] : ways)
    if (count == 1 && cells[static_cast<std::size_t>(region)] * cell_m * cell_m < most_m2) out.insert(region);
  return out;
}

}  // namespace modslam
