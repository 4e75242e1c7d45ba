// SPDX-License-Identifier: BSD-3-Clause
/// @file The few words of SVG and HTML that the report is written in.
#pragma once
#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace modslam::report {

using Points = std::vector<Eigen::Vector2d>;

/// "12.3", "12": no trailing zeros, "0" for what is not finite.
std::string number(double value, int decimals = 1);
/// "12.300": as many decimals as asked for, so that columns of a table line up.
std::string fixed(double value, int decimals);
/// Text that is safe between tags and inside quotes.
std::string escape(std::string_view text);
std::string base64(std::string_view bytes);

/// Leaves out points nearer than `tolerance` to the line that remains (Douglas and Peucker 1973).
Points simplify(const Points& points, double tolerance);

std::string polyline(const Points& points, const std::string& attributes);
std::string polygon(const Points& points, const std::string& attributes);
std::string line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const std::string& attributes);
std::string circle(const Eigen::Vector2d& centre, double radius, const std::string& attributes);
std::string text_at(const Eigen::Vector2d& place, std::string_view words,
                    const std::string& attributes);

/// The round step (1, 2 or 5 times a power of ten) that cuts `span` into at most `pieces`.
double round_step(double span, int pieces);

/// A point well inside a polygon, for its label.
Eigen::Vector2d label_point(const Points& polygon);

}  // namespace modslam::report
