// SPDX-License-Identifier: BSD-3-Clause
/// procs/ask — QUERY → ANSWER: where is this, which way is it there. Asks the run that is going on.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <modslam/answer_t.hpp>
#include <modslam/query_t.hpp>
#include <optional>

#include <unistd.h>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"

namespace {

using namespace modslam;
using Clock = std::chrono::steady_clock;

constexpr const char* kUsage =
    "ask what? room PLACE | route FROM to TO | map\n"
    "a place is X Y in metres, a room's name, or its id: ask room 1.5 2, ask route Room 3 to Corridor 1";

std::string joined(const std::vector<std::string>& words, std::size_t from, std::size_t to) {
  std::string out;
  for (std::size_t k = from; k < to; ++k) out += (k > from ? " " : "") + words[k];
  return out;
}

query_t query_of(const std::vector<std::string>& words) {
  query_t query{};
  const std::size_t n = words.size();
  if (n > 1 && words[0] == "room") {
    query.kind = query_t::ROOM_AT;
    query.from = joined(words, words[1] == "at" ? 2 : 1, n);
    return query;
  }
  if (n == 1 && words[0] == "map") {
    query.kind = query_t::MAP;
    return query;
  }
  if (n < 3 || words[0] != "route") throw std::invalid_argument(kUsage);
  query.kind = query_t::ROUTE;
  std::size_t cut = 2;  // without the word `to` two single words are the two places
  while (cut < n && words[cut] != "to") ++cut;
  if (cut == n && n != 3) throw std::invalid_argument(kUsage);
  query.from = joined(words, 1, cut == n ? 2 : cut);
  query.to = joined(words, cut == n ? 2 : cut + 1, n);
  return query;
}

/// Asks each half second until the answer comes.
std::optional<answer_t> ask(const std::string& url, query_t query, double seconds) {
  Transport transport(url);
  Bus bus(transport, "ask" + std::to_string(getpid()));
  std::optional<answer_t> answer;
  query.requester = bus.name();
  query.id = 1;
  bus.subscribe<answer_t>(channel::kAnswer, [&](const answer_t& m) {
    if (m.requester == query.requester && m.id == query.id) answer = m;
  });
  const auto start = Clock::now();
  const auto passed_s = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  for (double next_s = 0; !answer && passed_s() < seconds; transport.poll(20))
    if (passed_s() >= next_s) {
      bus.publish(channel::kQuery, query);
      next_s += 0.5;
    }
  return answer;
}

void print(const answer_t& answer, const query_t& query) {
  std::cout << answer.words << "\n";
  if (query.kind != query_t::MAP) return;
  for (int k = 0; k < answer.nrooms; ++k)
    std::cout << "  " << answer.name[k] << ": id " << answer.room[k] << ", of group " << answer.building[k] << "\n";
  for (int k = 0; k < answer.ndoors; ++k)
    std::cout << "  " << (answer.door[k] ? "door " + std::to_string(answer.door[k]) : std::string("opening")) << ": " << answer.room_a[k] << " - "
              << answer.room_b[k] << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Asks the run that is going on about rooms and the ways between them.");
  std::vector<std::string> words;
  std::string url;
  double seconds = 5;
  app.add_option("--url", url, "LCM url [LCM_DEFAULT_URL]");
  app.add_option("--timeout", seconds, "seconds to wait for the answer")->capture_default_str();
  app.add_option("words", words, kUsage)->required();
  app.positionals_at_end();
  app.prefix_command(false);
  CLI11_PARSE(app, argc, argv);
  try {
    const query_t query = query_of(words);
    const std::optional<answer_t> answer = ask(url, query, seconds);
    if (!answer) throw std::runtime_error("nobody answers; is a run with the semantic classifier going on?");
    print(*answer, query);
    return answer->result == answer_t::FOUND ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "modslam-ask: " << error.what() << std::endl;
    return 1;
  }
}
