// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/grid_map.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

namespace modslam {
namespace {

namespace fs = std::filesystem;

/// The keys of a flat YAML file; text behind '#' is comment.
class FlatYaml {
 public:
  explicit FlatYaml(const std::string& path) : path_(path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + ": cannot be read");
    for (std::string line; std::getline(file, line);) {
      line = line.substr(0, line.find('#'));
      const auto colon = line.find(':');
      if (colon != std::string::npos) values_[trimmed(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
    }
  }
  std::string text(const std::string& key) const {
    const auto found = values_.find(key);
    if (found == values_.end() || found->second.empty()) throw std::runtime_error(path_ + ": no '" + key + "'");
    return found->second;
  }
  double number(const std::string& key, double low, double high) const { return number_in(key, text(key), low, high); }
  double number_or(const std::string& key, double otherwise, double low, double high) const {
    return values_.count(key) ? number(key, low, high) : otherwise;
  }
  double number_in(const std::string& key, const std::string& word, double low, double high) const {
    std::istringstream in(word);
    double value = 0;
    in >> value;
    if (in.fail() || !std::isfinite(value) || value < low || value > high) {
      std::ostringstream what;
      what << path_ << ": " << key << ": '" << word << "' is no number from " << low << " to " << high;
      throw std::runtime_error(what.str());
    }
    return value;
  }

 private:
  static std::string trimmed(const std::string& s) {
    const char* kSpace = " \t\r\"'";
    const auto from = s.find_first_not_of(kSpace);
    return from == std::string::npos ? "" : s.substr(from, s.find_last_not_of(kSpace) - from + 1);
  }
  std::string path_;
  std::map<std::string, std::string> values_;
};

Eigen::Vector2d origin_of(const FlatYaml& yaml, const std::string& path) {
  std::string list = yaml.text("origin");
  for (char& c : list)
    if (c == '[' || c == ']' || c == ',') c = ' ';
  std::istringstream words(list);
  std::string x, y, turn;
  words >> x >> y >> turn;
  constexpr double kFar_m = 1e6;
  if (!turn.empty() && yaml.number_in("origin", turn, -10, 10) != 0) throw std::runtime_error(path + ": origin: a turned map is not supported");
  return {yaml.number_in("origin", x, -kFar_m, kFar_m), yaml.number_in("origin", y, -kFar_m, kFar_m)};
}

cv::Mat1b picture_of(const FlatYaml& yaml, const std::string& yaml_path) {
  fs::path path = fs::path(yaml_path).parent_path() / yaml.text("image");
  if (!fs::exists(path)) path.replace_extension(".png");
  const cv::Mat picture = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
  if (picture.empty()) throw std::runtime_error(yaml_path + ": image: " + path.string() + " is no picture that can be read");
  return picture;
}

}  // namespace

MapImage read_grid_map(const std::string& yaml_path) {
  const FlatYaml yaml(yaml_path);
  const double free_below = yaml.number_or("free_thresh", 0.196, 0, 1), occupied_above = yaml.number_or("occupied_thresh", 0.65, 0, 1);
  const bool negate = yaml.number_or("negate", 0, 0, 1) != 0;
  MapImage map;
  map.resolution_m = yaml.number("resolution", 1e-3, 10);
  map.origin_m = origin_of(yaml, yaml_path);
  const cv::Mat1b picture = picture_of(yaml, yaml_path);
  map.width = picture.cols;
  map.height = picture.rows;
  map.cells.reserve(picture.total());
  for (int row = picture.rows - 1; row >= 0; --row)
    for (int column = 0; column < picture.cols; ++column) {
      const double value = picture(row, column) / 255.0, occupied = negate ? value : 1 - value;
      map.cells.push_back(occupied < free_below ? 1 : occupied > occupied_above ? 255 : 0);
    }
  return map;
}

}  // namespace modslam
