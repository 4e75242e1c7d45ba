// SPDX-License-Identifier: BSD-3-Clause
/// @file How a configuration struct shows its fields: each listed once, with bounds, unit and effect.
///
/// A struct names its table (`static constexpr const char* kTable`) and lists its fields in
/// `void visit(ConfigVisitor&)`. Loading, range checks, printing and the shipped file all use that list.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace modslam {

class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;
  /// `low` and `high` are inclusive. `unit` is "" for pure numbers.
  virtual void number(const char* key, double& value, double low, double high, const char* unit,
                      const char* effect) = 0;
  virtual void integer(const char* key, std::int64_t& value, std::int64_t low, std::int64_t high,
                       const char* unit, const char* effect) = 0;
  virtual void flag(const char* key, bool& value, const char* effect) = 0;
  virtual void choice(const char* key, std::string& value, const std::vector<std::string>& allowed,
                      const char* effect) = 0;
  virtual void text(const char* key, std::string& value, const char* effect) = 0;
};

}  // namespace modslam
