// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/classifier.hpp"

#include <algorithm>
#include <cmath>

#include "common/semantics/doors.hpp"
#include "common/semantics/objects.hpp"
#include "common/semantics/regions.hpp"
#include "common/semantics/rooms.hpp"
#include "common/semantics/walls.hpp"

namespace modslam {
namespace {

constexpr double kDoorDepth_m = 0.5;
constexpr double kBeside_m = 0.4;  // rooms are looked for this far from a door

std::vector<Segment> segments_of(const std::vector<WallFace>& faces) {
  std::vector<Segment> out;
  for (const WallFace& face : faces) out.push_back(face.segment);
  return out;
}

/// Labels of the two sides of a door.
std::pair<int, int> sides(const Raster& raster, const Segment& door) {
  const Eigen::Vector2d d = door.direction(), n(-d.y(), d.x());
  return {raster.label_at(door.centre() + kBeside_m * n),
          raster.label_at(door.centre() - kBeside_m * n)};
}

/// Region labels with every candidate closed; candidates that separate nothing are taken out, the
/// least sure first.
Raster label_with_doors(const Evidence& evidence, const std::vector<Segment>& walls,
                        std::vector<DoorCandidate>& doors, double min_area_m2) {
  Raster raster = seen_floor(evidence);
  if (raster.seen.empty()) return raster;
  for (;;) {
    std::vector<Segment> barriers = lengthened(walls, 0.3);
    for (const DoorCandidate& door : doors) barriers.push_back(door.segment);
    label_regions(raster, barriers, min_area_m2);
    const auto separates = [&](const DoorCandidate& door) {
      const auto [left, right] = sides(raster, door.segment);
      return left != right;
    };
    const auto end = std::remove_if(doors.begin(), doors.end(),
                                    [&](const auto& door) { return !separates(door); });
    if (end == doors.end()) return raster;
    doors.erase(end, doors.end());
  }
}

double wall_evidence(const Polygon& outline, const std::vector<WallFace>& walls) {
  double sum = 0, length = 0;
  for (const WallFace& wall : walls) {
    const bool beside =
        std::any_of(outline.begin(), outline.end(), [&](const Eigen::Vector2d& corner) {
          return distance_to_segment(corner, wall.segment) < 0.3;
        });
    if (!beside) continue;
    sum += wall.evidence * wall.segment.length_m();
    length += wall.segment.length_m();
  }
  return length > 0 ? sum / length : 0;
}

std::int64_t room_at(const std::vector<Room>& rooms, const Eigen::Vector2d& place) {
  for (const Room& room : rooms)
    if (contains(room.outline, place)) return room.id;
  return 0;
}

}  // namespace

void SemanticClassifier::insert(const Scan& scan, const SensorInfo& sensor,
                                const Pose2& T_map_base) {
  Inserted inserted;
  LineExtractionParameters lines;
  inserted.evidence = make_evidence(scan, sensor, config_.range_limit_m, lines);
  inserted.jambs = sense_doors(scan, sensor, kDoorDepth_m, config_.door_min_m, config_.door_max_m,
                               config_.range_limit_m);
  inserted.drawn = inserted.wanted = T_map_base;
  evidence_.insert(inserted.evidence, T_map_base);
  scans_.push_back(std::move(inserted));
}

int SemanticClassifier::redraw(bool all) {
  int redrawn = 0;
  for (Inserted& scan : scans_) {
    const double moved = distance(scan.drawn, scan.wanted);
    const double turned = std::abs(wrap_angle(scan.drawn.heading - scan.wanted.heading));
    if (all ? moved == 0 && turned == 0 : moved < config_.redraw_m && turned < config_.redraw_rad)
      continue;
    evidence_.remove(scan.evidence, scan.drawn);
    evidence_.insert(scan.evidence, scan.wanted);
    scan.drawn = scan.wanted;
    ++redrawn;
  }
  return redrawn;
}

void SemanticClassifier::clear() { *this = SemanticClassifier(config_); }

std::vector<Segment> SemanticClassifier::jamb_pairs_map() const {
  std::vector<Segment> out;
  for (const Inserted& scan : scans_)
    for (const JambPair& pair : scan.jambs)
      out.push_back({scan.drawn * pair.a, scan.drawn * pair.b});
  return out;
}

const Semantics& SemanticClassifier::render(std::int64_t utime) {
  const WallSplit split = find_walls(evidence_, config_);
  std::vector<DoorCandidate> doors =
      find_door_candidates(split.walls, evidence_, jamb_pairs_map(), config_);
  const std::vector<Segment> walls = segments_of(split.walls);
  const Raster raster = label_with_doors(evidence_, walls, doors, config_.room_min_m2);

  Semantics now;
  for (const WallFace& face : split.walls)
    now.walls.push_back({0, face.segment, face.evidence, face.sigma_m});
  std::vector<Segment> door_lines;
  for (const DoorCandidate& door : doors) {
    now.doors.push_back({0, door.segment, door.evidence, 0, 0});
    door_lines.push_back(door.segment);
  }
  now.rooms = find_rooms(raster, walls, door_lines, segments_of(split.furniture), config_);
  for (Room& room : now.rooms) room.evidence = wall_evidence(room.outline, split.walls);
  now.objects = find_objects(evidence_, split.walls);
  identities_.carry_over(semantics_, now, utime);
  for (Door& door : now.doors) {
    const Eigen::Vector2d d = door.segment.direction(), n(-d.y(), d.x());
    door.room_a = room_at(now.rooms, door.segment.centre() + kBeside_m * n);
    door.room_b = room_at(now.rooms, door.segment.centre() - kBeside_m * n);
  }
  semantics_ = std::move(now);
  return semantics_;
}

}  // namespace modslam
