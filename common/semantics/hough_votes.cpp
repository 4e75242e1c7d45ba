// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/hough_votes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <opencv2/core/hal/intrin.hpp>

namespace modslam {
namespace {

constexpr int kLanes = 8;

int in_lanes(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// @param count  a multiple of kLanes.
std::int16_t largest(const std::int16_t* values, int count) {
  cv::v_int16x8 most = cv::v_load(values);
  for (int k = kLanes; k < count; k += kLanes) most = cv::v_max(most, cv::v_load(values + k));
  return cv::v_reduce_max(most);
}

/// Place of the first such value. @param count  a multiple of kLanes.
int place_of(std::int16_t value, const std::int16_t* values, int count) {
  const cv::v_int16x8 wanted = cv::v_setall_s16(value);
  for (int k = 0; k < count; k += kLanes)
    if (cv::v_check_any(cv::v_load(values + k) == wanted)) return static_cast<int>(std::find(values + k, values + k + kLanes, value) - values);
  return count;
}

void add(std::int16_t& votes, int more) { votes = static_cast<std::int16_t>(votes + more); }

}  // namespace

HoughVotes::HoughVotes(double cell_m, double cell_rad) : cell_m_(cell_m), angles_(static_cast<int>(std::lround(kPi / cell_rad))) {
  normal_x_.resize(angles_);
  normal_y_.resize(angles_);
  rows_.resize(angles_);
  buckets_.resize(angles_);
  for (int k = 0; k < angles_; ++k) {
    normal_x_(k) = static_cast<float>(std::cos(k * kPi / angles_));
    normal_y_(k) = static_cast<float>(std::sin(k * kPi / angles_));
  }
}

void HoughVotes::start(const std::vector<ScanPoint>& points) {
  origin_ = points.front().p;
  double reach = 0;
  x_.resize(points.size());
  y_.resize(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector2d d = points[k].p - origin_;
    reach = std::max(reach, d.norm());
    x_[k] = static_cast<float>(d.x() / cell_m_);
    y_[k] = static_cast<float>(d.y() / cell_m_);
  }
  half_ = static_cast<int>(reach / cell_m_) + 2;
  stride_ = in_lanes(2 * half_ + 1);
  votes_.resize(static_cast<std::size_t>(angles_) * static_cast<std::size_t>(stride_));
  std::memset(votes_.data(), 0, votes_.size() * sizeof votes_[0]);
  voters_.resize(points.size());
  std::iota(voters_.begin(), voters_.end(), 0);
  gone_.clear();
  is_gone_.assign(points.size(), 0);
  known_gone_.assign(static_cast<std::size_t>(angles_), 0);
  most_.assign(static_cast<std::size_t>(in_lanes(angles_)), -1);
  vote_all(points.size());
  for (int k = 0; k < angles_; ++k) most_[static_cast<std::size_t>(k)] = largest(row(k), stride_);
}

/// Point by point: neighbours in a row would wait for each other's buckets.
void HoughVotes::vote_all(std::size_t points) {
  for (int angle = 0; angle < angles_; ++angle) rows_(angle) = angle * stride_;
  for (std::size_t k = 0; k < points; ++k) {
    buckets_ = (normal_x_ * x_[k] + normal_y_ * y_[k] + static_cast<float>(half_)).cast<int>() + rows_;
    std::int16_t* votes = votes_.data();
    for (int angle = 0; angle < angles_; ++angle) add(votes[buckets_(angle)], 1);
  }
}

void HoughVotes::take_back(const std::vector<int>& points) {
  for (const int k : points) is_gone_[static_cast<std::size_t>(k)] = 1;
  gone_.insert(gone_.end(), points.begin(), points.end());
  voters_.erase(std::remove_if(voters_.begin(), voters_.end(), [&](int k) { return is_gone_[static_cast<std::size_t>(k)]; }), voters_.end());
}

/// Takes back the votes of those that went since the last look, or counts those that stayed, whichever are fewer.
void HoughVotes::bring_up_to_date(int angle) {
  std::size_t& known = known_gone_[static_cast<std::size_t>(angle)];
  const bool afresh = voters_.size() < gone_.size() - known;
  const int *first = afresh ? voters_.data() : gone_.data() + known, *end = afresh ? first + voters_.size() : gone_.data() + gone_.size();
  std::int16_t* votes = row(angle);
  if (afresh) std::fill(votes, votes + stride_, std::int16_t{0});
  const float nx = normal_x_(angle), ny = normal_y_(angle), half = static_cast<float>(half_);
  const int sign = afresh ? 1 : -1;
  for (; first != end; ++first) add(votes[static_cast<int>(nx * x_[static_cast<std::size_t>(*first)] + ny * y_[static_cast<std::size_t>(*first)] + half)], sign);
  known = gone_.size();
}

HoughVotes::Bucket HoughVotes::fullest() {
  // Votes only go: what was the most of an angle bounds it, and few angles need another look.
  for (;;) {
    const std::int16_t bound = largest(most_.data(), static_cast<int>(most_.size()));
    const int angle = place_of(bound, most_.data(), static_cast<int>(most_.size()));
    if (known_gone_[static_cast<std::size_t>(angle)] < gone_.size()) {
      bring_up_to_date(angle);
      std::int16_t& most = most_[static_cast<std::size_t>(angle)];
      most = largest(row(angle), stride_);
      if (most < bound) continue;
    }
    const Eigen::Vector2d normal(normal_x_(angle), normal_y_(angle));
    return {bound, normal, (place_of(bound, row(angle), stride_) - half_ + 0.5) * cell_m_ + normal.dot(origin_)};
  }
}

}  // namespace modslam
