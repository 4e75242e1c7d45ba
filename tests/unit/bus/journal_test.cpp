// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/journal.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <modslam/command_t.hpp>

#include "tests/support/temporary_folder.hpp"

using namespace modslam;

namespace {

command_t word(const std::string& verb) {
  command_t message{};
  message.verb = verb;
  return message;
}

std::vector<std::string> verbs(Journal&& journal) {
  std::vector<std::string> found;
  journal.read_past([&](const LogEvent& record) {
    command_t message{};
    if (read_record(record, message)) found.push_back(message.verb);
  });
  return found;
}

}  // namespace

TEST_CASE("a journal gives its next life what was written, also when the last record is torn") {
  const test::TemporaryFolder folder;
  const JournalConfig config{folder.path};
  {
    Journal journal(config, "walker");
    REQUIRE(verbs(std::move(journal)).empty());
    journal.write("WORD", word("one"));
    journal.write("WORD", word("two"));
    // Nothing is closed or flushed here: what stands in the file now is what a kill leaves.
    REQUIRE(verbs(Journal(config, "walker")) == std::vector<std::string>{"one", "two"});
  }
  const std::string path = folder.path + "/walker.journal";
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 3);
  Journal again(config, "walker");
  REQUIRE(verbs(std::move(again)) == std::vector<std::string>{"one"});
  again.write("WORD", word("three"));
  REQUIRE(verbs(Journal(config, "walker")) == std::vector<std::string>{"one", "three"});
}

TEST_CASE("without a folder a journal keeps nothing and costs nothing") {
  Journal journal(JournalConfig{}, "walker");
  REQUIRE_FALSE(journal.on());
  journal.write("WORD", word("one"));
  REQUIRE(journal.trouble().empty());
}

TEST_CASE("a journal on a full disk ends with words, and its process goes on") {
  if (!std::filesystem::exists("/dev/full")) {
    WARN("no /dev/full: skipped");
    return;
  }
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.path + "/walker.journal");
  Journal journal(JournalConfig{folder.path}, "walker");
  journal.write("WORD", word("one"));
  REQUIRE_FALSE(journal.on());
  REQUIRE_THAT(journal.trouble(), Catch::Matchers::Contains("No space left"));
  journal.write("WORD", word("two"));
}
