// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/text_fields.hpp"

#include <charconv>
#include <cmath>

namespace modslam {
namespace {

std::string shown(std::string_view field) {
  return "'" + std::string(field.substr(0, 24)) + (field.size() > 24 ? "...'" : "'");
}

}  // namespace

TextFields::TextFields(std::string_view line, std::string_view separators) {
  while (!line.empty()) {
    const std::size_t end = line.find_first_of(separators);
    const std::string_view field = line.substr(0, end);
    if (!field.empty() || separators == ",") fields_.push_back(field);
    line.remove_prefix(end == std::string_view::npos ? line.size() : end + 1);
  }
}

std::string_view TextFields::word(const char* what) {
  if (next_ >= fields_.size()) throw BadLine(std::string("ends before ") + what);
  return fields_[next_++];
}

double TextFields::number(const char* what, double bound) {
  std::string_view field = word(what);
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size())
    throw BadLine(std::string(what) + " is " + shown(field) + ", not a number");
  if (!std::isfinite(value) || std::abs(value) > bound)
    throw BadLine(std::string(what) + " is " + shown(field) + ", beyond any sense");
  return value;
}

std::int64_t TextFields::integer(const char* what, std::int64_t low, std::int64_t high) {
  const double value = number(what);
  if (value != std::floor(value) || value < static_cast<double>(low) ||
      value > static_cast<double>(high))
    throw BadLine(std::string(what) + " is " + shown(fields_[next_ - 1]) +
                  ", expected a whole number from " + std::to_string(low) + " to " +
                  std::to_string(high));
  return static_cast<std::int64_t>(value);
}

Pose2 TextFields::pose(const char* what, double metres) {
  const double x = number(what, 1e9), y = number(what, 1e9), heading_rad = number(what, 1e6);
  if (std::abs(x * metres) >= 1e6 || std::abs(y * metres) >= 1e6)
    throw BadLine(std::string(what) + " is not within 1e6 m");
  return {x * metres, y * metres, wrap_angle(heading_rad)};
}

void TextFields::expect_left(std::size_t count) const {
  if (left() != count)
    throw BadLine("has " + std::to_string(fields_.size()) + " fields, expected " +
                  std::to_string(next_ + count));
}

}  // namespace modslam
