// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/opening_model.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "common/semantics/openings.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace modslam;

namespace {

std::string written(const test::TemporaryFolder& folder, const std::string& text) {
  const std::string path = folder.path + "/trees";
  std::ofstream(path) << text;
  return path;
}

}  // namespace

TEST_CASE("a tree from a file says what its leaves say") {
  const test::TemporaryFolder folder;
  const OpeningModel model(written(folder, "bias 0.5\nroot 0\nnode 0 1.2 1 2 0\nnode -1 0 0 0 -1\nnode -1 0 0 0 2\n"));
  std::array<float, kOpeningFeatures> features{};
  REQUIRE(model.probability(features.data()) == Approx(1 / (1 + std::exp(0.5))));
  features[kWidth] = 1.3F;
  REQUIRE(model.probability(features.data()) == Approx(1 / (1 + std::exp(-2.5))));
}

TEST_CASE("trees that lead nowhere, in circles or to unknown features are refused") {
  const test::TemporaryFolder folder;
  for (const char* text : {"root 0\n", "node 0 1 0 0 0\n", "node 0 1 1 2 0\nnode -1 0 0 0 1\n", "node 99 1 1 1 0\nnode -1 0 0 0 1\n", "nodes 3\n",
                           "node 0 nan\n", "bias x\n"})
    REQUIRE_THROWS_WITH(OpeningModel(written(folder, text)), Catch::Contains("trees"));
  REQUIRE_THROWS_AS(OpeningModel(folder.path + "/none"), std::runtime_error);
}

TEST_CASE("maps of a robot and finished ones are judged by trees of their own, and a file stands for both") {
  using Kind = OpeningModel::Kind;
  std::array<float, kOpeningFeatures> features{};
  features[kWidth] = 0.9F;
  features[kSolidLess] = features[kSolidMore] = features[kHitLess] = features[kHitMore] = 1;
  features[kDepthLess] = features[kDepthMore] = 4;
  const double sensed = OpeningModel(Kind::kSensed).probability(features.data()), finished = OpeningModel(Kind::kFinished).probability(features.data());
  CHECK(sensed != finished);
  CHECK(OpeningModel("", Kind::kFinished).probability(features.data()) == finished);
  const test::TemporaryFolder folder;
  const std::string file = written(folder, "bias 0\n");
  CHECK(OpeningModel(file, Kind::kSensed).probability(features.data()) == 0.5);
  CHECK(OpeningModel(file, Kind::kFinished).probability(features.data()) == 0.5);
}
