// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/relations.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "common/formats/text_fields.hpp"

namespace modslam {
namespace {

constexpr double kSameStamp_s = 1.5e-6;

[[noreturn]] void fail(std::size_t line, const std::string& why) {
  throw std::runtime_error("line " + std::to_string(line) + " " + why);
}

}  // namespace

std::vector<Relation> parse_relations(std::string_view text) {
  std::vector<Relation> relations;
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    if (line.front() == '#') return;
    try {
      TextFields fields(line);
      fields.expect_left(8);
      Relation relation;
      relation.stamp1_s = fields.number("t1");
      relation.stamp2_s = fields.number("t2");
      relation.motion.x = fields.number("x", 1e6);
      relation.motion.y = fields.number("y", 1e6);
      for (const char* what : {"z", "roll", "pitch"}) fields.number(what);
      relation.motion.heading = wrap_angle(fields.number("yaw", 1e6));
      relations.push_back(relation);
    } catch (const BadLine& bad) {
      fail(number, bad.what());
    }
  });
  if (relations.empty()) throw std::runtime_error("holds no relation");
  return relations;
}

ScanTimes::ScanTimes(std::vector<double> stamps_s, std::vector<bool> exact)
    : stamps_s_(std::move(stamps_s)), exact_(std::move(exact)), by_stamp_(stamps_s_.size()) {
  std::iota(by_stamp_.begin(), by_stamp_.end(), std::size_t{0});
  std::stable_sort(by_stamp_.begin(), by_stamp_.end(),
                   [&](std::size_t a, std::size_t b) { return stamps_s_[a] < stamps_s_[b]; });
}

ScanTimes ScanTimes::parse(std::string_view text) {
  std::vector<double> stamps_s;
  std::vector<bool> exact;
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    if (number == 1 && line.find("ipc_timestamp") != std::string_view::npos) return;
    try {
      TextFields fields(line, ",\r");
      if (fields.integer("scan_index", 0, 1'000'000'000) !=
          static_cast<std::int64_t>(stamps_s.size()))
        throw BadLine("has a scan_index out of order, expected " + std::to_string(stamps_s.size()));
      stamps_s.push_back(fields.number("ipc_timestamp"));
      exact.push_back(fields.left() == 0 || fields.integer("exact", 0, 2) == 1);
    } catch (const BadLine& bad) {
      fail(number, bad.what());
    }
  });
  if (stamps_s.empty()) throw std::runtime_error("holds no scan time");
  return {std::move(stamps_s), std::move(exact)};
}

std::optional<ScanTimes::Place> ScanTimes::place(double stamp_s) const {
  const auto nearest =
      std::lower_bound(by_stamp_.begin(), by_stamp_.end(), stamp_s - kSameStamp_s,
                       [&](std::size_t scan, double s) { return stamps_s_[scan] < s; });
  if (nearest != by_stamp_.end() && stamps_s_[*nearest] <= stamp_s + kSameStamp_s)
    return Place{static_cast<double>(*nearest), exact_[*nearest]};
  std::optional<Place> best;
  double best_gap_s = 0;
  for (std::size_t i = 0; i + 1 < stamps_s_.size(); ++i) {
    const double gap_s = stamps_s_[i + 1] - stamps_s_[i];
    if (!(stamps_s_[i] < stamp_s && stamp_s < stamps_s_[i + 1]) || (best && gap_s >= best_gap_s))
      continue;
    best = Place{static_cast<double>(i) + (stamp_s - stamps_s_[i]) / gap_s, false};
    best_gap_s = gap_s;
  }
  return best;
}

std::optional<Pose2> IndexedPath::at(double index) const {
  const auto after = std::lower_bound(indices.begin(), indices.end(), index);
  if (after == indices.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - indices.begin());
  if (*after == index) return poses[i];
  if (i == 0) return std::nullopt;
  return interpolate(poses[i - 1], poses[i],
                     (index - indices[i - 1]) / (indices[i] - indices[i - 1]));
}

IndexedPath index_path(const Path& path, const ScanTimes& times) {
  constexpr double kSameScan_s = 1e-3;
  const bool line_is_scan = path.size() == times.size();
  IndexedPath indexed;
  std::size_t next = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::size_t end = line_is_scan ? i + 1 : times.size();
    std::size_t best = end;
    double best_s = kSameScan_s;
    for (std::size_t scan = next; scan < end; ++scan) {
      const double apart_s = std::abs(times.stamp_s(scan) - path[i].stamp_s);
      if (apart_s < best_s) best = scan, best_s = apart_s;
    }
    if (best == end)
      throw std::runtime_error("pose " + std::to_string(i + 1) + " of the path has stamp " +
                               std::to_string(path[i].stamp_s) + " s, which " +
                               (line_is_scan
                                    ? "is not that of scan " + std::to_string(i)
                                    : std::string("belongs to no later scan of the times")));
    indexed.indices.push_back(static_cast<double>(best));
    indexed.poses.push_back(path[i].pose);
    next = best + 1;
  }
  return indexed;
}

RelationScores score_relations(const std::vector<Relation>& relations, const ScanTimes& times,
                               const IndexedPath& T_map_laser) {
  RelationScores scores;
  std::vector<double> exact_m, exact_deg;
  for (const Relation& relation : relations) {
    const auto place1 = times.place(relation.stamp1_s), place2 = times.place(relation.stamp2_s);
    const auto pose1 = place1 ? T_map_laser.at(place1->index) : std::nullopt;
    const auto pose2 = place2 ? T_map_laser.at(place2->index) : std::nullopt;
    if (!pose1 || !pose2) {
      ++scores.unplaced;
      continue;
    }
    const Pose2 error = between(relation.motion, between(*pose1, *pose2));
    scores.translation_m.push_back(error.translation().norm());
    scores.rotation_deg.push_back(std::abs(error.heading) * 180 / kPi);
    if (!place1->exact || !place2->exact) continue;
    exact_m.push_back(scores.translation_m.back());
    exact_deg.push_back(scores.rotation_deg.back());
  }
  scores.all = {statistics_of(scores.translation_m), statistics_of(scores.rotation_deg)};
  scores.exact = {statistics_of(exact_m), statistics_of(exact_deg)};
  return scores;
}

}  // namespace modslam
