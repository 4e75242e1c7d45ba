// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/chamfer.hpp"

#include <algorithm>
#include <array>
#include <opencv2/core/hal/intrin.hpp>

namespace modslam {
namespace {

using Lanes = cv::v_float32x4;

constexpr int kLanes = 4;
constexpr float kFar = 1e6F;

/// Lengths of steps to the side, across a corner and as a knight moves, in whole numbers of 2^-16: sums of them are exact, in whatever order.
struct Steps {
  float side, corner, knight;
};

constexpr float fixed(double length) { return static_cast<float>(static_cast<int>(length * 65536 + 0.5)) / 65536; }

/// Borgefors' two sweeps (Computer Vision, Graphics, and Image Processing 1986) over a picture with a border.
template <bool kKnight>
class Chamfer {
 public:
  Chamfer(const cv::Mat1b& mask, const Steps& steps, float outside, float most)
      : steps_(steps), most_(most), size_(mask.size()), width_((mask.cols + kLanes - 1) / kLanes * kLanes), field_(mask.rows + 2 * kBorder, width_ + 2 * kLanes) {
    for (int k = 0; k < kBorder; ++k)
      for (const int y : {k, field_.rows - 1 - k}) std::fill_n(field_[y], field_.cols, outside);
    for (int y = 0; y < size_.height; ++y) {
      float* row = row_of(y);
      std::fill_n(row - kLanes, kLanes, outside);
      forward(mask[y], row);
      std::fill(row + size_.width, row + width_ + kLanes, outside);
    }
    for (int y = size_.height - 1; y >= 0; --y) backward(row_of(y), outside);
  }

  cv::Mat1f field() const { return field_(cv::Rect(kLanes, kBorder, size_.width, size_.height)); }

 private:
  static constexpr int kBorder = 2;

  float* row_of(int y) { return field_[y + kBorder] + kLanes; }

  /// From the rows on one side of this one. @param next  to the next row on that side.
  Lanes across(const float* at, std::ptrdiff_t next) const {
    const float* one = at + next;
    Lanes out = cv::v_min(cv::v_load(one) + cv::v_setall_f32(steps_.side), cv::v_min(cv::v_load(one - 1), cv::v_load(one + 1)) + cv::v_setall_f32(steps_.corner));
    if (!kKnight) return out;
    const float* two = one + next;
    const Lanes near = cv::v_min(cv::v_load(one - 2), cv::v_load(one + 2)), far = cv::v_min(cv::v_load(two - 1), cv::v_load(two + 1));
    return cv::v_min(out, cv::v_min(near, far) + cv::v_setall_f32(steps_.knight));
  }

  void forward(const std::uint8_t* mask, float* row) const {
    const float s = steps_.side;
    const Lanes one = cv::v_setall_f32(s), two = cv::v_setall_f32(2 * s), far = cv::v_setall_f32(kFar), most = cv::v_setall_f32(most_), ramp(s, 2 * s, 3 * s, 4 * s);
    Lanes before = cv::v_setall_f32(row[-1]);
    for (int x = 0; x < width_; x += kLanes) {
      std::array<std::uint8_t, kLanes> set{};
      std::copy(mask + x, mask + std::min(x + kLanes, size_.width), set.begin());
      const cv::v_uint32x4 is_set = cv::v_load_expand_q(set.data()) != cv::v_setzero_u32();
      Lanes d = cv::v_min(across(row + x, -field_.cols), most) & cv::v_reinterpret_as_f32(is_set);
      d = cv::v_min(d, cv::v_rotate_left<1>(d, far) + one);
      d = cv::v_min(d, cv::v_rotate_left<2>(d, far) + two);
      d = cv::v_min(d, before + ramp);
      cv::v_store(row + x, d);
      before = cv::v_broadcast_element<kLanes - 1>(d);
    }
  }

  void backward(float* row, float outside) const {
    const float s = steps_.side;
    const Lanes one = cv::v_setall_f32(s), two = cv::v_setall_f32(2 * s), far = cv::v_setall_f32(kFar), ramp(4 * s, 3 * s, 2 * s, s);
    Lanes after = cv::v_setall_f32(row[width_]);
    for (int x = width_ - kLanes; x >= 0; x -= kLanes) {
      Lanes d = cv::v_min(cv::v_load(row + x), across(row + x, field_.cols));
      d = cv::v_min(d, cv::v_rotate_right<1>(d, far) + one);
      d = cv::v_min(d, cv::v_rotate_right<2>(d, far) + two);
      d = cv::v_min(d, after + ramp);
      cv::v_store(row + x, d);
      if (x + kLanes > size_.width) std::fill(row + size_.width, row + width_, outside);
      after = cv::v_broadcast_element<0>(d);
    }
  }

  Steps steps_;
  float most_;
  cv::Size size_;
  int width_;         ///< of the picture, in whole lanes
  cv::Mat1f field_;
};

}  // namespace

cv::Mat1f distances(const cv::Mat1b& mask, float most) { return Chamfer<true>(mask, {fixed(1), fixed(1.4F), fixed(2.1969F)}, kFar, most).field(); }

float deepest(const cv::Mat1b& mask) {
  const cv::Mat1f field = Chamfer<false>(mask, {fixed(0.955F), fixed(1.3693F), 0}, 0, kFar).field();
  double out = 0;
  cv::minMaxLoc(field, nullptr, &out);
  return static_cast<float>(out);
}

}  // namespace modslam
