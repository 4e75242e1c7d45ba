// SPDX-License-Identifier: BSD-3-Clause
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/formats/atomic_file.hpp"
#include "common/formats/g2o_writer.hpp"
#include "common/formats/map_server.hpp"
#include "common/formats/tum_writer.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
namespace fs = std::filesystem;

TEST_CASE("a TUM line keeps every microsecond of today's stamps") {
  REQUIRE(tum_text({{1'700'000'000'123'456, {1, -2, kPi}}}) ==
          "1700000000.123456 1.000000000 -2.000000000 0 0 0 1.000000000 0.000000000\n");
  REQUIRE(tum_text({{-250'000, {}}}).substr(0, 9) == "-0.250000");
  REQUIRE(tum_text({{-1'250'000, {}}}).substr(0, 9) == "-1.250000");
  REQUIRE(tum_text({}).empty());
}

TEST_CASE(
    "a g2o file fixes its first vertex, orders information as readers expect and drops dangling "
    "edges") {
  GraphEdge edge;
  edge.from = 0, edge.to = 1;
  edge.T_from_to = {1, 2, 0.5};
  edge.information << 11, 12, 13, 12, 22, 23, 13, 23, 33;
  GraphEdge dangling = edge;
  dangling.to = 7;
  int left_out = 0;
  REQUIRE(g2o_text({{0, {}}, {1, {1, 2, 0.5}}}, {{0, edge}, {1, dangling}}, &left_out) ==
          "VERTEX_SE2 0 0.000000000 0.000000000 0.000000000\n"
          "VERTEX_SE2 1 1.000000000 2.000000000 0.500000000\n"
          "FIX 0\n"
          "EDGE_SE2 0 1 1.000000000 2.000000000 0.500000000 11 12 13 22 23 33\n");
  REQUIRE(left_out == 1);
  REQUIRE(g2o_text({}, {}).empty());
}

TEST_CASE("cells become the three greys that map_server knows") {
  REQUIRE(map_server_pixel(0) == 205);
  REQUIRE(map_server_pixel(1) == 254);
  REQUIRE(map_server_pixel(128) == 205);  // as likely as not
  REQUIRE(map_server_pixel(255) == 0);
  REQUIRE(map_server_png(MapImage()).substr(1, 3) == "PNG");
}

TEST_CASE("a file is written whole or stays as it was") {
  std::string folder = fs::temp_directory_path() / "modslam-atomic-XXXXXX";
  folder = mkdtemp(folder.data());
  const std::string path = folder + "/file";
  write_atomically(path, "before");

  SECTION("a second write replaces the first") {
    write_atomically(path, std::string("aft\0er", 6));
  }
  SECTION("a folder that is not there is named") {
    REQUIRE_THROWS_WITH(write_atomically(folder + "/no/file", "x"),
                        Catch::Contains("/no/file") && Catch::Contains("No such"));
  }
  SECTION("a disk that is full leaves the old file and nothing else") {
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit tight{1000, before.rlim_max};
    std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &tight);
    REQUIRE_THROWS_WITH(write_atomically(path, std::string(5000, 'x')),
                        Catch::Contains(path + ": cannot be written"));
    setrlimit(RLIMIT_FSIZE, &before);
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    REQUIRE(text.str() == "before");
  }
  REQUIRE(std::distance(fs::directory_iterator(folder), {}) == 1);  // no temporary is left
  fs::remove_all(folder);
}
