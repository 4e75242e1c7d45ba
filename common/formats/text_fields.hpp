// SPDX-License-Identifier: BSD-3-Clause
/// @file The fields of one line of text, read in turn. Anything unexpected is said, never guessed.
#pragma once
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// Text says which field is wrong and how; the caller adds file and line.
struct BadLine : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class TextFields {
 public:
  /// Splits at any of `separators`; empty fields count only for "," alone.
  explicit TextFields(std::string_view line, std::string_view separators = " \t\r");

  std::size_t size() const { return fields_.size(); }
  std::string_view operator[](std::size_t i) const { return fields_[i]; }
  std::size_t left() const { return fields_.size() - next_; }

  /// @throws BadLine when the line has ended, or the field is no finite number within +-`bound`.
  double number(const char* what, double bound = 1e12);
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);
  std::string_view word(const char* what);
  /// x y heading in the file's length unit; `metres` is that unit.
  Pose2 pose(const char* what, double metres = 1.0);
  /// @throws BadLine unless exactly `count` fields are left.
  void expect_left(std::size_t count) const;

 private:
  std::vector<std::string_view> fields_;
  std::size_t next_ = 0;
};

/// Calls handle(line number from 1, line) for each line that is not blank.
template <class Handle>
void for_each_line(std::string_view text, Handle&& handle) {
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++number;
    if (line.find_first_not_of(" \t\r") != std::string_view::npos) handle(number, line);
  }
}

}  // namespace modslam
