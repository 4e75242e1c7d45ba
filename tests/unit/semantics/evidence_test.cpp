// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/evidence.hpp"

#include <catch2/catch.hpp>

#include "common/semantics/walls.hpp"
#include "tests/support/ray_world.hpp"

using namespace modslam;

namespace {

/// Everything in the grids that is not zero, as numbers.
std::vector<int> content(const Evidence& evidence) {
  std::vector<int> out;
  evidence.hits().each([&](int ix, int iy, const HitCell& c) {
    if (c.hits() || c.dx_mm || c.dy_mm || c.cos2 || c.sin2 || c.view_x || c.view_y)
      out.insert(out.end(),
                 {ix, iy, c.wall, c.object, c.dx_mm, c.dy_mm, c.cos2, c.sin2, c.view_x, c.view_y});
  });
  evidence.free().each([&](int ix, int iy, std::int32_t count) {
    if (count) out.insert(out.end(), {ix, iy, count});
  });
  return out;
}

std::vector<WallFace> faces_seen(test::RayWorld& world, const std::vector<Pose2>& poses) {
  Evidence evidence(0.05);
  for (const Pose2& pose : poses)
    evidence.insert(make_evidence(world.scan(pose), test::RayWorld::sensor(), 15, {}), pose);
  const auto cells = oriented_cells(evidence);
  return merge_faces(find_faces(cells, evidence, 0.5), cells, evidence, 1.5);
}

}  // namespace

TEST_CASE("Taking a scan out restores the evidence exactly", "[semantics]") {
  test::RayWorld world;
  world.box(-4, -3, 4, 3);
  world.box(1, 1, 1.7, 1.5);
  Evidence evidence(0.05);
  const EvidenceScan first =
      make_evidence(world.scan({0.3, -0.2, 0.4}), test::RayWorld::sensor(), 15, {});
  const EvidenceScan second =
      make_evidence(world.scan({-1.1, 0.7, 2.9}), test::RayWorld::sensor(), 15, {});
  evidence.insert(first, {0.3, -0.2, 0.4});
  const std::vector<int> before = content(evidence);
  REQUIRE(before.size() > 1000);
  evidence.insert(second, {-1.1, 0.7, 2.9});
  CHECK(content(evidence) != before);
  evidence.remove(second, {-1.1, 0.7, 2.9});
  CHECK(content(evidence) == before);
  evidence.remove(first, {0.3, -0.2, 0.4});
  CHECK(content(evidence).empty());
}

TEST_CASE("Merging joins two halves of a wall that something hides in the middle", "[semantics]") {
  test::RayWorld world;
  world.wall(-4, 3, 4, 3);
  world.wall(-0.3, 1.8, 0.3, 1.8);  // hides about a metre of it
  std::vector<Pose2> poses;
  for (int i = 0; i < 8; ++i) poses.emplace_back(0.01 * i, 0.0, 0.003 * i);
  int on_wall = 0;
  for (const WallFace& face : faces_seen(world, poses)) {
    if (std::abs(face.segment.centre().y() - 3) > 0.1) continue;
    ++on_wall;
    CHECK(face.segment.length_m() == Approx(8).margin(0.2));
  }
  CHECK(on_wall == 1);
}

TEST_CASE("Merging keeps apart what free space parts and faces half a metre apart", "[semantics]") {
  test::RayWorld world;
  world.wall(-4, 2, -0.6, 2);
  world.wall(0.6, 2, 4, 2);
  world.wall(-4, -2, 0, -2);
  world.wall(0.05, -2.5, 4, -2.5);
  world.box(-9, -9, 9, 9);
  std::vector<Pose2> poses;
  for (int i = 0; i < 12; ++i) poses.emplace_back(0.2 * i - 1.2, 0.0, 0.003 * i);
  int up = 0, left = 0, right = 0;
  for (const WallFace& face : faces_seen(world, poses)) {
    const Eigen::Vector2d c = face.segment.centre();
    if (std::abs(face.segment.direction().y()) > 0.2) continue;
    up += std::abs(c.y() - 2) < 0.1;
    left += std::abs(c.y() + 2) < 0.1;
    right += std::abs(c.y() + 2.5) < 0.1;
  }
  CHECK(up == 2);
  CHECK(left == 1);
  CHECK(right == 1);
}
