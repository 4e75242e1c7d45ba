// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/config.hpp"

#include <stdexcept>
// Some broken files trip an assertion of toml++ 3.3 before it finds the words for them.
#define TOML_ASSERT(holds) ((holds) ? void() : throw std::logic_error("the syntax is broken"))
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wterminate"
#include <toml++/toml.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace modslam {
namespace {

std::string show(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", value);
  std::string s = text;
  if (s.find_first_of(".en") == std::string::npos) s += ".0";
  return s;
}

std::string quote(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

std::string join(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " | ") + word;
  return out;
}

/// Fills the fields of one struct from one table; every key must be known.
class Reader : public ConfigVisitor {
 public:
  Reader(const toml::table* table, std::string file, std::string name)
      : table_(table), file_(std::move(file)), name_(std::move(name)) {}

  void number(const char* key, double& value, double low, double high, const char* unit,
              const char*) override {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_number()) fail(*node, key, "must be a number");
    const double read = *node->value<double>();
    if (!(read >= low && read <= high))
      fail(*node, key, "= " + show(read) + " is outside [" + show(low) + ", " + show(high) + "] " + unit);
    value = read;
  }
  void integer(const char* key, std::int64_t& value, std::int64_t low, std::int64_t high,
               const char* unit, const char*) override {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_integer()) fail(*node, key, "must be a whole number");
    const std::int64_t read = *node->value<std::int64_t>();
    if (read < low || read > high)
      fail(*node, key, "= " + std::to_string(read) + " is outside [" + std::to_string(low) + ", " +
                           std::to_string(high) + "] " + unit);
    value = read;
  }
  void flag(const char* key, bool& value, const char*) override {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_boolean()) fail(*node, key, "must be true or false");
    value = *node->value<bool>();
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& allowed,
              const char* effect) override {
    const toml::node* node = find(key);
    std::string read = value;
    text(key, read, effect);
    if (node && std::find(allowed.begin(), allowed.end(), read) == allowed.end())
      fail(*node, key, "= " + quote(read) + " is not one of " + join(allowed));
    value = read;
  }
  void text(const char* key, std::string& value, const char*) override {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_string()) fail(*node, key, "must be a text in quotes");
    value = *node->value<std::string>();
  }
  void refuse_unknown() const {
    if (!table_) return;
    for (const auto& [key, node] : *table_)
      if (!known_.count(std::string(key.str()))) fail(node, std::string(key.str()), "is not a known key");
  }

 private:
  const toml::node* find(const char* key) {
    known_.insert(key);
    return table_ ? table_->get(key) : nullptr;
  }
  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& why) const {
    throw ConfigError(file_ + ":" + std::to_string(node.source().begin.line) + ": " + name_ + "." + key +
                      " " + why);
  }
  const toml::table* table_;
  std::string file_, name_;
  std::set<std::string> known_;
};

/// Writes the fields of one struct as TOML.
class Writer : public ConfigVisitor {
 public:
  explicit Writer(bool comments) : comments_(comments) {}
  void number(const char* key, double& value, double low, double high, const char* unit,
              const char* effect) override {
    line(key, show(value), "[" + show(low) + ", " + show(high) + "] " + unit, effect);
  }
  void integer(const char* key, std::int64_t& value, std::int64_t low, std::int64_t high,
               const char* unit, const char* effect) override {
    line(key, std::to_string(value), "[" + std::to_string(low) + ", " + std::to_string(high) + "] " + unit,
         effect);
  }
  void flag(const char* key, bool& value, const char* effect) override {
    line(key, value ? "true" : "false", "true | false", effect);
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& allowed,
              const char* effect) override {
    line(key, quote(value), join(allowed), effect);
  }
  void text(const char* key, std::string& value, const char* effect) override {
    line(key, quote(value), "text", effect);
  }
  void line(const std::string& key, const std::string& value, std::string range, const char* effect) {
    while (!range.empty() && range.back() == ' ') range.pop_back();
    if (comments_) out << "# " << effect << "\n# " << range << "\n";
    out << key << " = " << value << "\n";
  }
  std::ostringstream out;

 private:
  bool comments_;
};

/// toml++ 3.3 runs into undefined behaviour at letters beyond ASCII that stand outside of texts and comments.
void refuse_foreign_letters(const std::string& text, const std::string& path) {
  int line = 1;
  char quote = 0;
  bool comment = false;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      quote = 0;
      comment = false;
    } else if (!comment && quote == 0 && static_cast<unsigned char>(c) >= 0x80) {
      throw ConfigError(path + ":" + std::to_string(line) + ": a letter beyond ASCII outside of a text or comment");
    } else if (!comment && (c == '"' || c == '\'')) {
      quote = quote == 0 ? c : quote == c ? '\0' : quote;
    } else if (quote == 0 && c == '#') {
      comment = true;
    }
  }
}

toml::table parse_file(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw ConfigError(path + ": there is no such file");
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  refuse_foreign_letters(text.str(), path);
  try {
    return toml::parse(text.str(), path);
  } catch (const toml::parse_error& error) {
    throw ConfigError(path + ":" + std::to_string(error.source().begin.line) + ": " +
                      std::string(error.description()));
  } catch (const std::logic_error& error) {
    throw ConfigError(path + ": " + error.what());
  }
}

/// "table.key=value" as a one-table document. A value that is no TOML is taken as text.
toml::table parse_override(const std::string& text) {
  const std::size_t dot = text.find('.'), equals = text.find('=');
  if (dot == std::string::npos || equals == std::string::npos || dot > equals)
    throw ConfigError("--set " + text + ": expected table.key=value");
  const std::string table = text.substr(0, dot), key = text.substr(dot + 1, equals - dot - 1),
                    value = text.substr(equals + 1);
  const std::string head = "[" + table + "]\n" + key + " = ";
  try {
    return toml::parse(head + value);
  } catch (const std::exception&) {
  }
  try {
    return toml::parse(head + quote(value));
  } catch (const toml::parse_error& error) {
    throw ConfigError("--set " + text + ": " + std::string(error.description()));
  } catch (const std::logic_error& error) {
    throw ConfigError("--set " + text + ": " + error.what());
  }
}

void fill(SystemConfig& config, const toml::table& root, const std::string& file) {
  std::set<std::string> tables;
  config.each([&](auto& part) {
    using Part = std::decay_t<decltype(part)>;
    tables.insert(Part::kTable);
    const toml::node* node = root.get(Part::kTable);
    if (node && !node->is_table())
      throw ConfigError(file + ":" + std::to_string(node->source().begin.line) + ": " + Part::kTable +
                        " must be a table");
    Reader reader(node ? node->as_table() : nullptr, file, Part::kTable);
    part.visit(reader);
    reader.refuse_unknown();
  });
  for (const auto& [key, node] : root)
    if (!tables.count(std::string(key.str())))
      throw ConfigError(file + ":" + std::to_string(node.source().begin.line) + ": " +
                        std::string(key.str()) + " is not a known table");
}

}  // namespace

SystemConfig load_config(const std::string& path, const std::vector<std::string>& overrides) {
  SystemConfig config;
  fill(config, parse_file(path), path);
  for (const std::string& text : overrides) fill(config, parse_override(text), "--set " + text);
  return config;
}

std::string config_value(const SystemConfig& config, const std::string& table_dot_key) {
  const toml::table root = toml::parse(to_toml(config, false));
  const auto node = root.at_path(table_dot_key);
  if (const auto text = node.value<std::string>(); text && node.is_string()) return *text;
  if (!node.is_value()) throw ConfigError("there is no key " + table_dot_key);
  std::ostringstream out;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_value<decltype(value)>) out << value;
  });
  return out.str();
}

std::string to_toml(SystemConfig config, bool comments) {
  Writer writer(comments);
  config.each([&](auto& part) {
    using Part = std::decay_t<decltype(part)>;
    writer.out << (writer.out.tellp() > 0 ? "\n[" : "[") << Part::kTable << "]\n";
    part.visit(writer);
  });
  return writer.out.str();
}

}  // namespace modslam
