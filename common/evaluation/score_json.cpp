// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/score_json.hpp"

namespace modslam {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const PrecisionRecall& s) {
  return {{"precision", s.precision}, {"recall", s.recall}, {"f1", s.f1()}};
}

Json to_json(const RelationScore& s) {
  return {{"translation_m", modslam::to_json(s.translation_m)},
          {"rotation_deg", modslam::to_json(s.rotation_deg)}};
}

Json to_json(const AbsoluteError& e) {
  return {
      {"T_world_map", {e.T_world_map.x, e.T_world_map.y, e.T_world_map.heading}},
      {"position_m", modslam::to_json(e.position_m)},
      {"heading_deg", modslam::to_json(e.heading_deg)},
      {"over_time",
       {{"stamp_s", e.stamps_s}, {"position_m", e.positions_m}, {"heading_deg", e.headings_deg}}}};
}

Json to_json(const WallScores& s) {
  Json at = Json::array();
  for (const WallScore& score : s.at) {
    Json one = to_json(score.by_length);
    one["tolerance_m"] = score.tolerance_m;
    at.push_back(one);
  }
  return {{"at", at},
          {"found_m", s.found_m},
          {"visible_m", s.visible_m},
          {"truth_m", s.truth_m},
          {"median_error_m", s.median_error_m},
          {"found_segments", s.found_segments},
          {"truth_segments", s.truth_segments}};
}

Json to_json(const RoomScores& s) {
  Json json = to_json(s.at_half);
  json["mean_iou"] = s.mean_iou;
  json["mean_matched_iou"] = s.mean_matched_iou;
  json["found"] = s.found;
  json["matched"] = s.matched;
  json["explored_truth"] = s.explored_truth;
  json["truth"] = s.truth;
  json["false_in_unseen"] = s.false_in_unseen;
  return json;
}

Json to_json(const DoorScores& s) {
  Json json = to_json(s.at_half_metre);
  json["strict"] = to_json(s.strict);
  json["median_distance_m"] = s.median_distance_m;
  json["median_width_error_m"] = s.median_width_error_m;
  json["found"] = s.found;
  json["matched"] = s.matched;
  json["visible_truth"] = s.visible_truth;
  json["truth"] = s.truth;
  json["pairs_known"] = s.pairs_known;
  json["pairs_right"] = s.pairs_right;
  return json;
}

Json to_json(const WallEndScores& s) {
  return {{"told", s.told}, {"on_face", s.on_face}, {"along_m", to_json(s.along_m)}, {"across_m", to_json(s.across_m)}, {"along_within", s.along_within},
          {"across_within", s.across_within}};
}

Json to_json(const ObjectScores& s) {
  return {{"found", s.found}, {"matched", s.matched}, {"truth", s.truth}, {"named", s.named}, {"named_right", s.named_right}};
}

}  // namespace

Json to_json(const Statistics& s) {
  return {{"count", s.count},   {"mean", s.mean}, {"std", s.std}, {"rms", s.rms},
          {"median", s.median}, {"p95", s.p95},   {"max", s.max}};
}

Json to_json(const RelationScores& s) {
  return {{"all", to_json(s.all)}, {"exact", to_json(s.exact)}, {"unplaced", s.unplaced}};
}

Json to_json(const TruthScores& s) {
  Json relative = Json::array();
  for (const RelativeError& e : s.relative)
    relative.push_back({{"travelled_m", e.travelled_m},
                        {"translation_m", to_json(e.translation_m)},
                        {"rotation_deg", to_json(e.rotation_deg)}});
  return {{"first_pose", to_json(s.first_pose)},
          {"least_squares", to_json(s.least_squares)},
          {"relative", relative},
          {"unpaired", s.unpaired}};
}

Json to_json(const SemanticScores& s) {
  return {{"walls", to_json(s.walls)}, {"wall_ends", to_json(s.wall_ends)}, {"rooms", to_json(s.rooms)}, {"doors", to_json(s.doors)}, {"objects", to_json(s.objects)}};
}

}  // namespace modslam
