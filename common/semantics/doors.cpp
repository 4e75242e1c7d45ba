// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/doors.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace modslam {
namespace {

constexpr double kJambNear_m = 0.35;  // a scan's jamb belongs to a wall end this near
constexpr double kOffset_m = 0.35;    // the two jambs of a door may lie this far off one line
constexpr double kSide_m = 0.35;      // free space must be seen this far on both sides
constexpr int kVoteCap = 20;

/// The end of a wall face, looking into the gap.
struct WallEnd {
  Eigen::Vector2d p, out;
  bool at_corner = false;  ///< another wall comes in here at an angle
};

/// Jamb pairs by the cell of their middle.
class JambStore {
 public:
  explicit JambStore(const std::vector<Segment>& pairs) : pairs_(pairs) {
    for (std::size_t i = 0; i < pairs.size(); ++i) cells_[cell(pairs[i].centre())].push_back(i);
  }
  int votes(const Segment& door) const {
    const auto [cx, cy] = cell(door.centre());
    int votes = 0;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = cells_.find({cx + dx, cy + dy});
        if (found == cells_.end()) continue;
        for (const std::size_t i : found->second) votes += matches(pairs_[i], door);
      }
    }
    return votes;
  }

 private:
  static std::pair<int, int> cell(const Eigen::Vector2d& p) {
    return {static_cast<int>(std::floor(p.x() / kJambNear_m)),
            static_cast<int>(std::floor(p.y() / kJambNear_m))};
  }
  static bool matches(const Segment& s, const Segment& t) {
    const auto near = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
      return (p - q).norm() < kJambNear_m;
    };
    return (near(s.a, t.a) && near(s.b, t.b)) || (near(s.a, t.b) && near(s.b, t.a));
  }
  const std::vector<Segment>& pairs_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells_;
};

class DoorFinder {
 public:
  DoorFinder(const std::vector<WallFace>& faces, const Evidence& evidence,
             const std::vector<Segment>& pairs, const SemanticsConfig& config)
      : faces_(faces), evidence_(evidence), store_(pairs), config_(config) {
    for (const WallFace& face : faces) {
      const Eigen::Vector2d d = face.segment.direction();
      for (const WallEnd& end : {WallEnd{face.segment.b, d}, WallEnd{face.segment.a, -d}})
        ends_.push_back({end.p, end.out, meets_wall(end)});
    }
  }

  std::vector<DoorCandidate> run() {
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      for (std::size_t j = i + 1; j < ends_.size(); ++j) try_ends(ends_[i], ends_[j]);
      try_ray(ends_[i], i / 2);
    }
    return without_overlap();
  }

 private:
  bool meets_wall(const WallEnd& end) const {
    return std::any_of(faces_.begin(), faces_.end(), [&](const WallFace& face) {
      return face.segment.length_m() > 0.8 &&
             std::abs(end.out.dot(face.segment.direction())) < 0.5 &&
             distance_to_segment(end.p, face.segment) < 0.25;
    });
  }

  /// Two walls on one line that end towards each other.
  void try_ends(const WallEnd& e, const WallEnd& f) {
    const Eigen::Vector2d gap = f.p - e.p;
    const double width = gap.norm();
    if (width < config_.door_min_m || width > config_.door_max_m) return;
    if (e.out.dot(f.out) > -0.95) return;
    const double along = e.out.dot(gap);
    if (along < 0.9 * width || std::sqrt(std::max(0.0, width * width - along * along)) > kOffset_m)
      return;
    if (e.at_corner && f.at_corner) return;  // the mouth of a corridor
    consider({e.p, f.p}, 2.0);
  }

  /// A wall that ends before the face of another one.
  void try_ray(const WallEnd& e, std::size_t own_face) {
    if (e.at_corner) return;
    double nearest = config_.door_max_m;
    bool hit = false;
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      if (k == own_face) continue;
      const Segment& s = faces_[k].segment;
      const Eigen::Vector2d d = s.direction(), n(-d.y(), d.x());
      const double closing = n.dot(e.out);
      if (std::abs(closing) < 0.87) continue;
      const double t = n.dot(s.a - e.p) / closing;
      if (t < 0.05 || t > nearest) continue;
      const double where = d.dot(e.p + t * e.out - s.a);
      if (where < -0.3 || where > s.length_m() + 0.3) continue;
      nearest = t;
      hit = true;
    }
    if (hit && nearest >= config_.door_min_m) consider({e.p, e.p + nearest * e.out}, 0.5);
  }

  /// @param prior  log-odds that the walls alone give.
  void consider(const Segment& gap, double prior) {
    if (crosses_wall(gap) || !is_open(gap) || !has_two_sides(gap)) return;
    const int votes = store_.votes(gap);
    const double evidence = prior - 1.5 + 0.25 * std::min(votes, kVoteCap);
    if (evidence > 0) found_.push_back({gap, evidence, votes});
  }

  bool crosses_wall(const Segment& gap) const {
    const auto side = [](const Segment& s, const Eigen::Vector2d& p) {
      return (s.b - s.a).x() * (p - s.a).y() - (s.b - s.a).y() * (p - s.a).x();
    };
    const Eigen::Vector2d shrink = 0.1 * gap.direction();
    const Segment inner{gap.a + shrink, gap.b - shrink};
    return std::any_of(faces_.begin(), faces_.end(), [&](const WallFace& face) {
      const Segment& s = face.segment;
      return side(s, inner.a) * side(s, inner.b) < 0 && side(inner, s.a) * side(inner, s.b) < 0;
    });
  }

  bool is_open(const Segment& gap) const {
    const int n = std::max(4, static_cast<int>(gap.length_m() / 0.05));
    int crossed = 0, hit = 0, asked = 0;
    for (int i = 0; i <= n; ++i) {
      const double t = static_cast<double>(i) / n;
      if (std::min(t, 1 - t) * gap.length_m() < 0.12) continue;
      const Eigen::Vector2d p = gap.a + t * (gap.b - gap.a);
      const HitCell* cell =
          evidence_.hits().find(evidence_.hits().index(p.x()), evidence_.hits().index(p.y()));
      const int crossings = evidence_.crossings(p);
      ++asked;
      crossed += crossings > 1;
      hit += cell && cell->hits() > 1 && 4 * cell->hits() > crossings;
    }
    return crossed >= 0.9 * asked && hit <= 0.1 * asked;
  }

  bool has_two_sides(const Segment& gap) const {
    const Eigen::Vector2d d = gap.direction(), n(-d.y(), d.x());
    for (const double side : {-kSide_m, kSide_m}) {
      int crossed = 0;
      for (const double t : {0.3, 0.5, 0.7})
        crossed += evidence_.crossings(gap.a + t * (gap.b - gap.a) + side * n) > 1;
      if (crossed < 2) return false;
    }
    return true;
  }

  /// Candidates of one opening become one: the best, moved to the middle of those alike (the two
  /// faces of a wall).
  std::vector<DoorCandidate> without_overlap() {
    std::stable_sort(
        found_.begin(), found_.end(), [](const DoorCandidate& a, const DoorCandidate& b) {
          return a.evidence - 0.3 * a.segment.length_m() > b.evidence - 0.3 * b.segment.length_m();
        });
    std::vector<DoorCandidate> kept;
    std::vector<bool> taken(found_.size());
    for (std::size_t i = 0; i < found_.size(); ++i) {
      if (taken[i]) continue;
      DoorCandidate best = found_[i];
      Eigen::Vector2d a = best.segment.a, b = best.segment.b;
      int members = 1;
      for (std::size_t j = i + 1; j < found_.size(); ++j) {
        Segment other = found_[j].segment;
        if (taken[j] || !overlaps(best.segment, other)) continue;
        taken[j] = true;
        if ((other.b - other.a).dot(best.segment.b - best.segment.a) < 0)
          std::swap(other.a, other.b);
        if ((other.a - best.segment.a).norm() > 0.4 || (other.b - best.segment.b).norm() > 0.4)
          continue;
        a += other.a;
        b += other.b;
        ++members;
        best.votes = std::max(best.votes, found_[j].votes);
      }
      best.segment = {a / members, b / members};
      kept.push_back(best);
    }
    return kept;
  }

  static bool overlaps(const Segment& s, const Segment& t) {
    return distance_to_segment(t.centre(), s) < 0.45 || distance_to_segment(s.centre(), t) < 0.45;
  }

  const std::vector<WallFace>& faces_;
  const Evidence& evidence_;
  const JambStore store_;
  const SemanticsConfig& config_;
  std::vector<WallEnd> ends_;
  std::vector<DoorCandidate> found_;
};

}  // namespace

std::vector<DoorCandidate> find_door_candidates(const std::vector<WallFace>& faces,
                                                const Evidence& evidence,
                                                const std::vector<Segment>& jamb_pairs,
                                                const SemanticsConfig& config) {
  return DoorFinder(faces, evidence, jamb_pairs, config).run();
}

}  // namespace modslam
