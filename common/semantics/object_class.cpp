// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/object_class.hpp"

#include <cmath>
#include <utility>

namespace modslam {
namespace {

constexpr double kLeast = 0.6;  // of all that it may be: less sure is not said

/// Sides as they show in a grid of 0.05 m, where a small thing looks longer than it is: its far side is seen from few places. `weight`: how common the class
/// is where things stand free in the simulated worlds; small things were measured there.
struct Kind {
  const char* name;
  double weight, long_m, long_sigma_m, short_m, short_sigma_m;
};

constexpr Kind kKinds[] = {
    {"car", 6, 4.45, 0.40, 1.95, 0.25},   {"bed", 2, 2.05, 0.15, 1.65, 0.25},   {"sofa", 5, 2.10, 0.20, 0.85, 0.08},
    {"desk", 25, 1.65, 0.12, 0.82, 0.07}, {"table", 9, 1.50, 0.60, 0.85, 0.20}, {"counter", 4, 2.80, 0.60, 0.68, 0.08},
    {"shelf", 22, 1.70, 0.50, 0.43, 0.07}, {"bench", 5, 1.75, 0.30, 0.48, 0.07}, {"chair", 25, 0.75, 0.12, 0.57, 0.05},
    {"box", 7, 0.75, 0.12, 0.65, 0.10},   {"pillar", 12, 0.58, 0.12, 0.45, 0.04}, {"plant", 3, 0.48, 0.035, 0.38, 0.02}};

/// Things of any size, as many as all shelves, over sides of up to 6 x 3 m.
constexpr double kAnything = 22.0 / (6.0 * 3.0);

double density(double x, double mean, double sigma) { return std::exp(-0.5 * (x - mean) * (x - mean) / (sigma * sigma)) / (2.5066 * sigma); }

}  // namespace

ObjectClass classify_footprint(double long_m, double short_m) {
  if (!std::isfinite(long_m) || !std::isfinite(short_m)) return {};
  if (long_m < short_m) std::swap(long_m, short_m);
  double all = kAnything, most = 0;
  const Kind* likeliest = nullptr;
  for (const Kind& kind : kKinds) {
    const double likely = kind.weight * density(long_m, kind.long_m, kind.long_sigma_m) * density(short_m, kind.short_m, kind.short_sigma_m);
    all += likely;
    if (likely > most) most = likely, likeliest = &kind;
  }
  return likeliest && most >= kLeast * all ? ObjectClass{likeliest->name, most / all} : ObjectClass{};
}

}  // namespace modslam
