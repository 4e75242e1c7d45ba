// SPDX-License-Identifier: BSD-3-Clause
#include "common/places/place_model.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/ml.hpp>
#include <stdexcept>

#include "common/places/scan_features.hpp"

namespace modslam {
namespace {

constexpr int kTrees = 100, kDepth = 3;
constexpr std::size_t kMostSamples = 20000;  // neighbours on a path look alike: every n-th is learned from
constexpr double kLeastKnown = 0.05;  // share of the circle: less says nothing
constexpr std::array<PlaceKind, kPlaceKinds> kKinds = {PlaceKind::kRoom, PlaceKind::kCorridor, PlaceKind::kDoorway};

std::size_t feature_count() { return place_features(Panorama()).size(); }

cv::Ptr<cv::ml::Boost> train_one(const cv::Mat1f& features, const cv::Mat1i& is_it) {
  const cv::Ptr<cv::ml::Boost> boost = cv::ml::Boost::create();
  boost->setBoostType(cv::ml::Boost::REAL);
  boost->setWeakCount(kTrees);
  boost->setMaxDepth(kDepth);
  boost->setWeightTrimRate(0.95);
  boost->setUseSurrogates(false);
  boost->train(cv::ml::TrainData::create(features, cv::ml::ROW_SAMPLE, is_it));
  return boost;
}

/// As counted on the paths, each pair of kinds once more than it was seen: nothing is impossible.
PlaceTransitions count_transitions(const std::vector<PlacePath>& paths) {
  PlaceTransitions transitions;
  for (PlaceConfidence& row : transitions) row.fill(1);
  for (const PlacePath& path : paths)
    for (std::size_t k = 1; k < path.size(); ++k) ++transitions[static_cast<std::size_t>(path[k - 1].kind)][static_cast<std::size_t>(path[k].kind)];
  for (PlaceConfidence& row : transitions) {
    const double sum = row[0] + row[1] + row[2];
    for (double& p : row) p /= sum;
  }
  return transitions;
}

/// How often each hint is given at places of each kind.
std::array<PlaceConfidence, kPlaceHints> count_hints(const std::vector<PlacePath>& paths) {
  std::array<PlaceConfidence, kPlaceHints> hints;
  for (PlaceConfidence& row : hints) row.fill(1);
  PlaceConfidence all;
  all.fill(kPlaceHints);
  for (const PlacePath& path : paths)
    for (const PlaceSample& sample : path) {
      const auto kind = static_cast<std::size_t>(sample.kind);
      ++hints[static_cast<std::size_t>(sample.on_map.hint)][kind];
      ++all[kind];
    }
  for (PlaceConfidence& row : hints)
    for (std::size_t kind = 0; kind < kPlaceKinds; ++kind) row[kind] /= all[kind];
  return hints;
}

void write_rows(cv::FileStorage& file, const char* name, const PlaceConfidence* rows, std::size_t count) {
  file << name << "[";
  for (std::size_t k = 0; k < count; ++k)
    for (const double p : rows[k]) file << p;
  file << "]";
}

void read_rows(const cv::FileStorage& file, const char* name, PlaceConfidence* rows, std::size_t count) {
  const cv::FileNode numbers = file[name];
  if (numbers.size() != count * kPlaceKinds) throw std::runtime_error(std::string("has no ") + name);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const double p = static_cast<double>(numbers[static_cast<int>(k)]);
    if (!(p > 0 && p < 1)) throw std::runtime_error(std::string("has a number among its ") + name + " that is no probability");
    rows[k / kPlaceKinds][k % kPlaceKinds] = p;
  }
}

}  // namespace

const char* place_name(PlaceKind kind) {
  return kind == PlaceKind::kCorridor ? "corridor" : kind == PlaceKind::kDoorway ? "doorway" : "room";
}

struct PlaceModel::Boosts {
  std::array<cv::Ptr<cv::ml::Boost>, kPlaceKinds> of_kind;
};

PlaceModel PlaceModel::train(const std::vector<PlacePath>& paths) {
  std::vector<const PlaceSample*> samples;
  for (const PlacePath& path : paths)
    for (const PlaceSample& sample : path) samples.push_back(&sample);
  const std::size_t stride = samples.size() / kMostSamples + 1;
  for (std::size_t k = 0; k * stride < samples.size(); ++k) samples[k] = samples[k * stride];
  samples.resize((samples.size() + stride - 1) / stride);
  const int rows = static_cast<int>(samples.size()), columns = static_cast<int>(feature_count());
  cv::Mat1f features(rows, columns);
  for (int r = 0; r < rows; ++r) std::copy(samples[r]->features.begin(), samples[r]->features.end(), features[r]);
  auto boosts = std::make_shared<Boosts>();
  for (std::size_t kind = 0; kind < kPlaceKinds; ++kind) {
    cv::Mat1i is_it(rows, 1);
    int count = 0;
    for (int r = 0; r < rows; ++r) count += is_it(r) = samples[r]->kind == kKinds[kind];
    if (count == 0 || count == rows)
      throw std::invalid_argument(std::string("places: nothing to tell apart: ") + (count ? "all are a " : "none is a ") + place_name(kKinds[kind]));
    boosts->of_kind[kind] = train_one(features, is_it);
  }
  PlaceModel model;
  model.boosts_ = boosts;
  model.transitions_ = count_transitions(paths);
  model.hints_ = count_hints(paths);
  return model;
}

std::string PlaceModel::text() const {
  cv::FileStorage file("places.yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  file << "features" << static_cast<int>(feature_count());
  write_rows(file, "transitions", transitions_.data(), transitions_.size());
  write_rows(file, "hints", hints_.data(), hints_.size());
  for (const PlaceKind kind : kKinds) {
    file << place_name(kind) << "{";
    boosts_->of_kind[static_cast<std::size_t>(kind)]->write(file);
    file << "}";
  }
  return file.releaseAndGetString();
}

PlaceModel PlaceModel::parse(const std::string& text) {
  PlaceModel model;
  auto boosts = std::make_shared<Boosts>();
  try {
    const cv::FileStorage file(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (static_cast<int>(file["features"]) != static_cast<int>(feature_count())) throw std::runtime_error("made for other features");
    read_rows(file, "transitions", model.transitions_.data(), model.transitions_.size());
    read_rows(file, "hints", model.hints_.data(), model.hints_.size());
    for (const PlaceKind kind : kKinds) {
      const cv::Ptr<cv::ml::Boost> boost = cv::ml::Boost::create();
      boost->read(file[place_name(kind)]);
      if (!boost->isTrained() || boost->getVarCount() != static_cast<int>(feature_count())) throw std::runtime_error("lacks a classifier");
      boosts->of_kind[static_cast<std::size_t>(kind)] = boost;
    }
  } catch (const std::exception& error) {  // cv::Exception is one
    throw std::runtime_error(std::string("is no model of places: ") + error.what());
  }
  model.boosts_ = boosts;
  return model;
}

PlaceConfidence PlaceModel::confidence(const Panorama& panorama) const {
  if (panorama.known < kLeastKnown) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
  return confidence(place_features(panorama));
}

/// The sum of the trees is half the log-odds of a kind (Friedman, Hastie and Tibshirani 2000).
PlaceConfidence PlaceModel::confidence(const std::vector<float>& features) const {
  PlaceConfidence out;
  double sum = 0;
  for (std::size_t kind = 0; kind < kPlaceKinds; ++kind) {
    const float votes = boosts_->of_kind[kind]->predict(features, cv::noArray(), cv::ml::StatModel::RAW_OUTPUT | cv::ml::DTrees::PREDICT_SUM);
    sum += out[kind] = 1 / (1 + std::exp(-2.0 * votes));
  }
  for (double& p : out) p /= sum;
  return out;
}

}  // namespace modslam
