// SPDX-License-Identifier: BSD-3-Clause
/// Objects on rasters drawn by hand, and kept in step with what changes there.
#include "common/semantics/object_finder.hpp"

#include <catch2/catch.hpp>

#include "tests/support/floor_raster.hpp"

using namespace modslam;

namespace {

struct Scene {
  KnownSpace space = test::unknown_floor(12, 12);
  Floor floor;
  ObjectMap objects;
  Scene() { test::fill(space, 0.5, 0.5, 11.5, 11.5, test::kFree); }
  void update(const Boxes& changed) {
    const FloorChange change = update_floor(floor, space, 14, changed);
    update_objects(objects, space, floor, changed, change.islands);
  }
  void update_all() { update({cv::Rect({0, 0}, space.occupancy.size())}); }
};

/// Two walls of 0.2 m that meet in a corner and stand free, with a shelf of 0.8 x 1.6 m against one of them.
void add_corner_with_shelf(KnownSpace& space) {
  test::fill(space, 3, 3, 8, 3.2, test::kSolid);
  test::fill(space, 3, 3, 3.2, 7, test::kSolid);
  test::fill(space, 5, 3.2, 6.6, 4.0, test::kSolid);
}

}  // namespace

TEST_CASE("what stands against a free-standing piece of wall is an object, the wall is none") {
  Scene scene;
  add_corner_with_shelf(scene.space);
  scene.update_all();
  REQUIRE(scene.objects.objects.size() == 1);
  REQUIRE(scene.objects.objects[0].object.area_m2 == Approx(1.6).margin(0.25));
  REQUIRE(scene.objects.mask(scene.space.cell({5.8, 3.6})));
  REQUIRE_FALSE(scene.objects.mask(scene.space.cell({3.1, 5})));
  REQUIRE_FALSE(scene.objects.mask(scene.space.cell({7.5, 3.1})));
}

TEST_CASE("a block of building that a wall runs into is no object, a table of any small shape is one") {
  Scene scene;
  test::fill(scene.space, 2, 2, 6, 2.2, test::kSolid);
  for (int k = 0; k < 20; ++k) test::fill(scene.space, 6, 2 - 0.05 * k, 6.05 + 0.1 * k, 2.1 - 0.05 * k, test::kSolid);  // a wedge
  for (int k = 0; k < 20; ++k) test::fill(scene.space, 6, 2 + 0.05 * k, 8 - 0.1 * k, 2.1 + 0.05 * k, test::kSolid);
  scene.update_all();
  REQUIRE(scene.objects.objects.empty());
  test::fill(scene.space, 4, 8, 5.1, 8.4, test::kSolid);
  test::fill(scene.space, 4, 8, 4.4, 9.1, test::kSolid);
  scene.update_all();
  REQUIRE(scene.objects.objects.size() == 1);
}

TEST_CASE("objects on pieces of wall are the same however the raster came to be") {
  Scene scene, anew;
  add_corner_with_shelf(scene.space);
  scene.update_all();
  const auto change = [&](double x0, double y0, double x1, double y1, std::uint8_t value) {
    test::fill(scene.space, x0, y0, x1, y1, value);
    scene.update({cv::Rect(scene.space.cell({x0, y0}), scene.space.cell({x1, y1}) + cv::Point(1, 1))});
    anew.space = scene.space;
    anew.floor = Floor();
    anew.objects = ObjectMap();
    anew.update_all();
    REQUIRE(difference(scene.objects.mask, anew.objects.mask).area() == 0);
    REQUIRE(scene.objects.objects.size() == anew.objects.objects.size());
    for (std::size_t k = 0; k < anew.objects.objects.size(); ++k) {
      REQUIRE(scene.objects.objects[k].object.outline == anew.objects.objects[k].object.outline);
      REQUIRE(scene.objects.objects[k].object.area_m2 == anew.objects.objects[k].object.area_m2);
    }
  };
  change(3, 5, 3.2, 7, test::kFree);          // a shorter arm, far from the shelf
  change(3, 3, 4.5, 5, test::kFree);          // the corner is gone
  change(6.6, 3, 8, 3.2, test::kFree);        // no wall left but behind the shelf
  change(6.6, 3, 9, 3.2, test::kSolid);
  change(7.2, 3.2, 8.4, 4.1, test::kSolid);   // a second shelf on the same piece
}
