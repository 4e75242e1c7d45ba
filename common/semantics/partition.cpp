// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/partition.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <opencv2/imgproc.hpp>

#include "common/semantics/region_clusters.hpp"
#include "common/semantics/small_regions.hpp"

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kLookFrom_m = 0.08, kLookTo_m = 0.6;  // beside a cut, for the region there
constexpr double kOnWall_m = 0.2;
constexpr double kAroundCut_m = 0.4;                    // a doorway reaches this far

/// The piece of floor beside a cut, left of it (sign 1) or right (-1).
TiledRegions::Place place_beside(const TiledRegions& tiles, const KnownSpace& space, const Gap& cut, double sign) {
  const Vec d = (cut.b - cut.a).normalized(), n = sign * Vec(-d.y(), d.x());
  for (double s = kLookFrom_m; s <= kLookTo_m; s += 0.04)
    for (const double t : {0.5, 0.35, 0.65}) {
      const cv::Point c = space.cell(cut.a + t * (cut.b - cut.a) + s * n);
      if (!space.inside(c)) continue;
      if (const TiledRegions::Place place = tiles.at(c); place.piece > 0) return place;
    }
  return {};
}

}  // namespace

cv::Rect FloorParter::box_of(const Gap& cut, const KnownSpace& space, double margin_m) {
  const int margin = static_cast<int>(std::ceil(margin_m / space.resolution_m)) + 1;
  return grown(cv::Rect(space.cell(cut.a), cv::Size(1, 1)) | cv::Rect(space.cell(cut.b), cv::Size(1, 1)), margin) & cv::Rect({0, 0}, space.occupancy.size());
}

/// Cuts the floor anew where it or the choice changed. @return where that made a difference.
Boxes FloorParter::draw_cuts(const Floor& floor, const KnownSpace& space, const NumberNews& change, const Boxes& open) {
  Boxes stirred = open, changed;
  for (const Numbers* numbers : {&change.gone, &change.come})
    for (const std::size_t number : *numbers) stirred.push_back(box_of(choice_[number], space, 0));
  std::vector<cv::Mat1b> before;
  Numbers near;
  const Boxes parts = windows(stirred, 0, floor.open.size());
  for (const cv::Rect& box : parts) {
    before.push_back(parted_(box).clone());
    floor.open(box).copyTo(parted_(box));
    const Numbers here = choice_.near(space.place(box.x, box.y), space.place(box.br().x, box.br().y), space.resolution_m);
    near.insert(near.end(), here.begin(), here.end());
  }
  for (const std::size_t number : near)
    cv::line(parted_, space.cell(choice_[number].a), space.cell(choice_[number].b), cv::Scalar(0), 1, cv::LINE_8);  // stops a flood over sides
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (const cv::Rect news = difference(before[k], parted_(parts[k])); news.area() > 0) changed.push_back(news + parts[k].tl());
  return changed;
}

/// Looks again for what is beside cuts that are new or near new pieces of floor. @return all cuts, surest first, with regions of tiles_.
std::vector<CutOpening> FloorParter::look_beside(const KnownSpace& space, const NumberNews& change) {
  cuts_.resize(choice_.end());
  Numbers stale = moved_ ? choice_.chosen() : change.come;
  for (const int tile : tiles_.new_tiles()) {
    const cv::Rect box = tiles_.tile_box(tile);
    const Numbers near = choice_.near(space.place(box.x, box.y), space.place(box.br().x, box.br().y), kLookTo_m + 2 * space.resolution_m);
    stale.insert(stale.end(), near.begin(), near.end());
  }
  moved_ = false;
  std::sort(stale.begin(), stale.end());
  stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
  for (const std::size_t number : stale) {
    cuts_[number].left = place_beside(tiles_, space, choice_[number], 1);
    cuts_[number].right = place_beside(tiles_, space, choice_[number], -1);
  }
  std::vector<CutOpening> cuts;
  cuts.reserve(choice_.chosen().size());
  for (const std::size_t number : choice_.chosen())
    cuts.push_back({choice_[number], number, tiles_.region_of(cuts_[number].left), tiles_.region_of(cuts_[number].right)});
  return cuts;
}

/// Clusters of the pieces that the floor was cut into; `cuts` come with pieces at their sides and leave with clusters.
void FloorParter::find_clusters(std::vector<CutOpening>& cuts) {
  const auto log_odds = [](double p) { return std::log(p / std::max(1e-9, 1 - p)); };
  const double even = log_odds(options_.cuts.min_probability);
  std::vector<PieceBond> bonds;
  for (const CutOpening& cut : cuts)
    if (cut.parts()) bonds.push_back({cut.left, cut.right, even - log_odds(cut.opening.probability)});
  const std::vector<Region>& pieces = tiles_.regions();
  const std::vector<int> roots = cluster_pieces(static_cast<int>(pieces.size()) + 1, bonds);
  std::vector<int> cluster_of_root(roots.size(), 0);
  cluster_of_.assign(roots.size(), 0);
  clusters_.clear();
  for (std::size_t k = 1; k < roots.size(); ++k) {
    int& cluster = cluster_of_root[static_cast<std::size_t>(roots[k])];
    if (cluster == 0) {
      clusters_.emplace_back();
      cluster = static_cast<int>(clusters_.size());
    }
    cluster_of_[k] = cluster;
    clusters_[static_cast<std::size_t>(cluster - 1)].cells += pieces[k - 1].cells;
    clusters_[static_cast<std::size_t>(cluster - 1)].box |= pieces[k - 1].box;
  }
  cluster_numbers_ = tiles_.number_sets(cluster_of_, TiledRegions::kClusters).of_root;
  for (CutOpening& cut : cuts)
    for (int* side : {&cut.left, &cut.right}) *side = cluster_of_[static_cast<std::size_t>(*side)];
}

cv::Mat1b FloorParter::mask_of(int cluster) const { return tiles_.mask_of(cluster_of_, cluster, clusters_[static_cast<std::size_t>(cluster - 1)].box); }

/// Share of a region's rim that lies on walls; where it meets another region or a cut is no rim.
double FloorParter::walled_share(int cluster, const Floor& floor, const KnownSpace& space, const WallSet& walls) const {
  const cv::Rect box = clusters_[static_cast<std::size_t>(cluster - 1)].box;
  cv::Mat1b on_wall(box.size(), std::uint8_t{0});
  const int thick = 2 * static_cast<int>(std::lround(kOnWall_m / space.resolution_m)) + 1;
  for (const std::size_t k : walls.near(space.centre(box.tl()), space.centre(box.br()), 2 * thick * space.resolution_m)) {
    const Wall& wall = walls[k];
    const cv::Point a = space.cell(wall.a), b = space.cell(wall.b);
    if (meet(grown(cv::Rect(a, cv::Size(1, 1)) | cv::Rect(b, cv::Size(1, 1)), thick), box)) cv::line(on_wall, a - box.tl(), b - box.tl(), cv::Scalar(255), thick);
  }
  const cv::Mat1b mask = mask_of(cluster);
  int rim = 0, walled = 0;
  for (int y = std::max(1, box.y); y < std::min(box.br().y, floor.open.rows - 1); ++y)
    for (int x = std::max(1, box.x); x < std::min(box.br().x, floor.open.cols - 1); ++x) {
      const cv::Point c = cv::Point(x, y) - box.tl();
      if (!mask(c) || (floor.open(y, x - 1) && floor.open(y, x + 1) && floor.open(y - 1, x) && floor.open(y + 1, x))) continue;
      ++rim;
      walled += on_wall(c) > 0;
    }
  return rim ? static_cast<double>(walled) / rim : 0.0;
}

/// Of the clusters; those that have too little wall around them are smaller than a room. At 0 stands none.
std::vector<double> FloorParter::areas_m2(const Floor& floor, const KnownSpace& space, const WallSet& walls) {
  std::vector<double> out{0};
  for (std::size_t k = 0; k < clusters_.size(); ++k) {
    out.push_back(clusters_[k].cells * floor.resolution_m * floor.resolution_m);
    if (walls.size() == 0 || out.back() >= options_.small_m2) continue;
    const auto share = [&] { return walled_share(static_cast<int>(k) + 1, floor, space, walls); };
    if (walled_.ask(cluster_numbers_[k + 1], grown(clusters_[k].box, 12), share) < options_.min_walled) out.back() = std::min(out.back(), 0.5 * options_.min_room_m2);
  }
  return out;
}

/// Slots between cars join what they lead to, small regions a neighbour. @return for each cluster the one that stands for its region.
std::vector<int> FloorParter::join_clusters(const std::vector<CutOpening>& cuts, const std::set<int>& slots, std::vector<double> area_m2) const {
  JoinedRegions regions(std::move(area_m2));
  for (const CutOpening& cut : cuts)
    if (cut.parts() && (slots.count(cut.left) || slots.count(cut.right))) regions.join(cut.left, cut.right);
  join_small_regions(cuts, options_.min_room_m2, regions);
  std::vector<int> roots(clusters_.size() + 1);
  for (std::size_t k = 0; k < roots.size(); ++k) roots[k] = regions.root(static_cast<int>(k));
  return roots;
}

/// A region that consists of the same pieces of the same tiles as before keeps its number. @return the number of each cluster.
std::vector<int> FloorParter::number_regions(const std::vector<int>& roots, const std::set<int>& slots, const std::vector<CutOpening>& cuts) {
  std::vector<FloorRegion> joined(roots.size());
  for (std::size_t k = 1; k < roots.size(); ++k) {
    const Region& region = clusters_[k - 1];
    FloorRegion& whole = joined[static_cast<std::size_t>(roots[k])];
    whole.box |= region.box;
    whole.cells += region.cells;
    whole.parking = whole.parking || slots.count(static_cast<int>(k)) > 0;
  }
  for (const CutOpening& cut : cuts) {
    const int left = roots[static_cast<std::size_t>(cut.left)], right = roots[static_cast<std::size_t>(cut.right)];
    if (left == 0 || right == 0 || left == right) continue;
    for (const int side : {left, right}) ++joined[static_cast<std::size_t>(side)].ways;
  }
  std::vector<int> root_of(cluster_of_.size());
  for (std::size_t k = 0; k < root_of.size(); ++k) root_of[k] = roots[static_cast<std::size_t>(cluster_of_[k])];
  TiledRegions::SetNumbers found = tiles_.number_sets(root_of, TiledRegions::kRooms);
  unpainted_ = std::move(found.new_in);
  const std::vector<int>& numbers = found.of_root;
  partition_.regions.clear();
  for (std::size_t root = 1; root < joined.size(); ++root) {
    joined[root].number = numbers[root];
    if (numbers[root] > 0) partition_.regions.push_back(joined[root]);
  }
  std::sort(partition_.regions.begin(), partition_.regions.end(), [](const FloorRegion& p, const FloorRegion& q) { return p.number < q.number; });
  std::vector<int> number_of(roots.size(), 0);
  for (std::size_t k = 1; k < roots.size(); ++k) number_of[k] = numbers[static_cast<std::size_t>(roots[k])];
  number_of_.assign(cluster_of_.size(), 0);
  for (std::size_t k = 1; k < cluster_of_.size(); ++k) number_of_[k] = number_of[static_cast<std::size_t>(cluster_of_[k])];
  return number_of;
}

/// Gives the cuts the regions' numbers and takes down what each does: part two regions, lie within one, or neither.
/// @return around those that part two and did not, or the other way round.
Boxes FloorParter::take_cuts(std::vector<CutOpening>& cuts, const std::vector<int>& number_of, const NumberNews& change, const KnownSpace& space) {
  Boxes news;
  const auto becomes = [&](std::size_t number, int role) {
    const int before = std::exchange(cuts_[number].role, role);
    if (role == before) return;
    if (role == kParts || before == kParts) news.push_back(box_of(choice_[number], space, kAroundCut_m));
    if (role > 0 || before > 0) tiles_.each_in(box_of(choice_[number], space, 0), [&](int tile) { unpainted_.push_back(tile); });
  };
  for (const std::size_t number : change.gone) becomes(number, kNone);
  partition_.cuts.clear();
  for (CutOpening& cut : cuts) {
    for (int* side : {&cut.left, &cut.right}) *side = number_of[static_cast<std::size_t>(*side)];
    becomes(cut.number, !cut.left || !cut.right ? kNone : cut.parts() ? kParts : cut.left);
    if (cut.parts()) partition_.cuts.push_back(cut);
  }
  return news;
}

/// Where two regions became one, the cut between them is floor again. @return where there is a region now and was none, or the other way round.
Boxes FloorParter::paint(const Floor& floor, const KnownSpace& space) {
  std::sort(unpainted_.begin(), unpainted_.end());
  unpainted_.erase(std::unique(unpainted_.begin(), unpainted_.end()), unpainted_.end());
  Boxes repainted, changed;
  std::vector<cv::Mat1i> before;
  std::vector<int> numbers;  // of a tile's pieces; of no piece: 0
  for (const int tile : unpainted_) {
    const cv::Rect box = tiles_.tile_box(tile);
    numbers.assign(1, 0);
    for (int piece = 0; piece < tiles_.pieces_in(tile); ++piece) numbers.push_back(number_of_[static_cast<std::size_t>(tiles_.regions_in(tile)[piece])]);
    before.push_back(partition_.labels(box).clone());
    repainted.push_back(box);
    for (int y = box.y; y < box.br().y; ++y) {
      const std::uint16_t* pieces = tiles_.pieces(y);
      int* labels = partition_.labels[y];
      for (int x = box.x; x < box.br().x; ++x) labels[x] = numbers[pieces[x]];
    }
  }
  Numbers healed;
  for (const cv::Rect& box : windows(repainted, 0, floor.open.size()))
    for (const std::size_t number : choice_.near(space.place(box.x, box.y), space.place(box.br().x, box.br().y), 2 * space.resolution_m))
      if (cuts_[number].role > 0) healed.push_back(number);
  tidy(healed);
  std::sort(healed.begin(), healed.end(), [&](std::size_t p, std::size_t q) { return choice_[p].order() < choice_[q].order(); });  // they may end in one cell
  for (const std::size_t number : healed) {
    const Gap& cut = choice_[number];
    if (!meet(repainted, box_of(cut, space, 0))) continue;
    cv::LineIterator cells(partition_.labels, space.cell(cut.a), space.cell(cut.b), 8);
    for (int k = 0; k < cells.count; ++k, ++cells)
      if (floor.open(cells.pos()) && partition_.labels(cells.pos()) == 0) partition_.labels(cells.pos()) = cuts_[number].role;
  }
  for (std::size_t k = 0; k < repainted.size(); ++k)
    if (const cv::Rect news = difference(before[k] > 0, partition_.labels(repainted[k]) > 0); news.area() > 0) changed.push_back(news + repainted[k].tl());
  return changed;
}

Boxes FloorParter::update(const Floor& floor, const KnownSpace& space, const WallSet& walls, const GapNews& news, const Boxes& open, const Boxes& walls_changed) {
  if (floor.open.empty()) return {};
  if (parted_.size() != floor.open.size()) {
    const PartitionOptions options = options_;
    *this = FloorParter(options);
    parted_ = cv::Mat1b(floor.open.size(), std::uint8_t{0});
    partition_.labels = cv::Mat1i(floor.open.size(), 0);
  }
  const NumberNews change = choice_.update(news);
  const Boxes parted = draw_cuts(floor, space, change, open);
  tiles_.update(parted_, parted);
  std::vector<CutOpening> cuts = look_beside(space, change);
  find_clusters(cuts);
  Boxes around = parted;
  for (const Boxes* more : {&open, &walls_changed}) around.insert(around.end(), more->begin(), more->end());
  walled_.forget(around);
  slots_.forget(parted);
  const std::set<int> slots = slots_.find(cuts, clusters_, cluster_numbers_, floor, [&](int cluster) { return mask_of(cluster); });
  const std::vector<int> roots = join_clusters(cuts, slots, areas_m2(floor, space, walls));
  const Boxes cut_news = take_cuts(cuts, number_regions(roots, slots, cuts), change, space);
  Boxes changed = paint(floor, space);
  changed.insert(changed.end(), cut_news.begin(), cut_news.end());
  return changed;
}

void FloorParter::grow(const Growth& growth) {
  moved_ = true;
  walled_.grow(growth, [](double) {});
  slots_.grow(growth);
  tiles_.grow(growth);
  parted_ = grown(parted_, growth, 0);
  partition_.labels = grown(partition_.labels, growth, 0);
  for (FloorRegion& region : partition_.regions) region.box += growth.shift;
}

Partition part_floor(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, const std::vector<Opening>& openings,
                     const PartitionOptions& options) {
  GapNews news;
  for (const Opening& opening : openings)
    if (options.cuts.take(opening)) news.come.push_back(opening);
  FloorParter parter(options);
  const WallSet set(walls);
  parter.update(floor, space, set, news, {cv::Rect({0, 0}, floor.open.size())}, {});
  return parter.partition();
}

const FloorRegion* Partition::find(int number) const {
  const auto found = std::lower_bound(regions.begin(), regions.end(), number, [](const FloorRegion& region, int wanted) { return region.number < wanted; });
  return found != regions.end() && found->number == number ? &*found : nullptr;
}

}  // namespace modslam
