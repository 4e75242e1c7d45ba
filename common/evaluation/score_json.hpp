// SPDX-License-Identifier: BSD-3-Clause
/// @file Scores as JSON, for programs, and as a table, for people.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "common/evaluation/relations.hpp"
#include "common/evaluation/semantic_scores.hpp"
#include "common/evaluation/truth.hpp"

namespace modslam {

nlohmann::ordered_json to_json(const Statistics& s);
nlohmann::ordered_json to_json(const RelationScores& s);
nlohmann::ordered_json to_json(const TruthScores& s);
nlohmann::ordered_json to_json(const SemanticScores& s);

/// `exact_only`: the row over relations whose two stamps are exact alone.
std::string to_table(const RelationScores& s, bool exact_only = false);
std::string to_table(const TruthScores& s);
std::string to_table(const SemanticScores& s);

}  // namespace modslam
