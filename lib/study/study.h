// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/order.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

/// The parts of a study.
namespace study {

/// Settings of a session by name: the film, the masking noise, and options of visuotactile-play.
using Settings = std::map<std::string, std::string>;

/// The names of settings, with commas between.
std::string names_of_settings();

struct Level
{
  std::string name;
  std::string label; ///< for figures
  Settings settings;
};

struct Factor
{
  std::string name;
  std::string label;
  bool between = false; ///< each participant has only one of its levels
  std::vector<Level> levels;
};

struct Question
{
  enum class Kind
  {
    slider,
    likert,
    text,
  };
  std::string name;
  std::string text;
  Kind kind = Kind::slider;
  double low = 1; ///< of a slider
  double high = 100;
  double step = 1;
  std::vector<std::string> labels; ///< of a slider's ends, or one for each point
  bool at_end = false;             ///< once, after the last session
  Settings when;                   ///< factor → level; empty: in each session
};

const char *name_of(Question::Kind kind);

/// One level of each factor: of all factors within participants, or of all between them, in the
/// order of the study.
struct Condition
{
  Settings levels;   ///< factor → level
  Settings settings; ///< of these levels
};

struct Study
{
  std::string title;
  std::string description; ///< of a figure's values
  unsigned people = 12;
  double least_break = 121; ///< s from the end of a film to the next
  std::string consent;
  std::string consent_version;
  std::string instructions;
  std::string thanks;
  std::uint64_t seed = 1;
  double latest = 20;      ///< ms: a session is late if 1 % of its commands are later than this
  double most_dropped = 1; ///< percent of frames: likewise
  Settings settings;       ///< of all sessions
  std::optional<Settings> practice;
  std::vector<Factor> factors;
  std::vector<Question> questions;

  std::vector<Condition> conditions() const; ///< within
  std::vector<Condition> groups() const;     ///< between
  /// The square of the conditions, shuffled by the seed.
  std::vector<Row> square() const;
};

/// Bytes of a file with words or settings.
constexpr std::size_t kMostText = std::size_t{ 1 } << 20;

/// Reads a study's text. The error names what was expected and where.
tl::expected<Study, std::string> read_study(const std::string &text);

/// The study's text with the items of questionnaires, whose files are in the folder. It needs no
/// other file.
tl::expected<std::string, std::string> whole_study(const std::string &text,
                                                   const std::string &folder);

/// The text of the paper's study, with this name of the third film.
std::string paper_study(const std::string &film);
/// The results of the paper, as a table for the report.
extern const char *const kPaperResults;
/// The form of a questionnaire, without its words.
extern const char *const kQuestionnaireForm;

} // namespace study
