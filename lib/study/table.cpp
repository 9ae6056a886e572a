// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/table.h"

#include <algorithm>
#include <string_view>

namespace study {

namespace {

/// Rows of fields, quoted where they need it.
class Csv
{
public:
  /// A text of a person. A spreadsheet would compute one that begins like a formula.
  Csv &written(const std::string &text)
  {
    const bool is_formula
        = !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos;
    return field(is_formula ? "'" + text : text);
  }
  Csv &field(const std::string &text)
  {
    if (!at_begin_)
      text_ += ',';
    at_begin_ = false;
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
      text_ += text;
      return *this;
    }
    text_ += '"';
    for (const char c : text) {
      text_ += c;
      if (c == '"')
        text_ += c;
    }
    text_ += '"';
    return *this;
  }
  Csv &field(std::int64_t number)
  {
    return field(std::to_string(number));
  }
  Csv &field(double number)
  {
    return field(write_number(number));
  }
  void end()
  {
    text_ += "\r\n";
    at_begin_ = true;
  }
  const std::string &text() const
  {
    return text_;
  }

private:
  std::string text_;
  bool at_begin_ = true;
};

std::string
levels_text(const Settings &levels)
{
  std::string text;
  for (const auto &[factor, level] : levels)
    text += (text.empty() ? "" : " ") + factor + "=" + level;
  return text;
}

/// The factors of all participants, whose studies may differ.
std::vector<std::string>
factors_of(const Folder &folder)
{
  std::vector<std::string> names;
  const auto add = [&names](const Study &study) {
    for (const Factor &factor : study.factors)
      if (std::ranges::find(names, factor.name) == names.end())
        names.push_back(factor.name);
  };
  add(folder.study());
  for (const auto &participant : folder.participants())
    add(participant->study());
  return names;
}

void
add_play(Csv &csv, const Participant &participant, int session)
{
  const auto plays = participant.plays_of(session);
  if (plays.empty()) {
    for (int i = 0; i < 14; i++)
      csv.field("");
    return;
  }
  const Play &play = *plays.back();
  csv.field(joined(participant.marks(session)))
      .field(static_cast<std::int64_t>(plays.size()))
      .field(play.film)
      .field(play.settings)
      .field(play.program)
      .field(play.gstreamer)
      .field(play.trace)
      .field(play.timing.commands)
      .field(play.timing.late)
      .field(play.timing.p50)
      .field(play.timing.p99)
      .field(play.timing.max)
      .field(play.frames)
      .field(play.frames_dropped);
}

} // namespace

std::string
answer_table(const Folder &folder)
{
  const std::vector<std::string> factors = factors_of(folder);
  Csv csv;
  for (const char *name : { "participant", "state", "group", "session" })
    csv.field(name);
  for (const std::string &factor : factors)
    csv.field(factor);
  for (const char *name :
       { "question",     "kind",         "answer", "text",          "time",      "response_ms",
         "study",        "consent",      "marks",  "plays",         "film_file", "settings",
         "program",      "gstreamer",    "trace",  "commands",      "late",      "error_p50_ms",
         "error_p99_ms", "error_max_ms", "frames", "frames_dropped" })
    csv.field(name);
  csv.end();
  for (const auto &participant : folder.participants())
    for (const Answer &answer : participant->answers()) {
      const int session = answer.step->session;
      Settings levels = participant->group().levels;
      if (session > Step::kPractice)
        levels.merge(Settings(participant->condition(session).levels));
      csv.field(participant->name())
          .field(name_of(participant->state()))
          .field(static_cast<std::int64_t>(participant->place().group) + 1)
          .field(session == Step::kNone       ? "end"
                 : session == Step::kPractice ? "practice"
                                              : std::to_string(session));
      for (const std::string &factor : factors) {
        const auto level = levels.find(factor);
        csv.field(level == levels.end() ? "" : level->second);
      }
      const Question &question = *answer.step->question;
      const bool is_text = question.kind == Question::Kind::text;
      csv.field(question.name)
          .field(name_of(question.kind))
          .field(is_text ? "" : answer.text)
          .written(is_text ? answer.text : "")
          .field(date_text(answer.at))
          .field(answer.response)
          .field(participant->study_sum())
          .field(participant->consent());
      add_play(csv, *participant, session);
      csv.end();
    }
  return csv.text();
}

std::string
order_table(const Folder &folder)
{
  std::size_t sessions = folder.study().conditions().size();
  for (const auto &participant : folder.participants())
    sessions = std::max(sessions, static_cast<std::size_t>(participant->sessions()));
  Csv csv;
  csv.field("participant").field("state").field("group").field("row");
  for (std::size_t i = 1; i <= sessions; i++)
    csv.field("session " + std::to_string(i));
  csv.end();
  for (const auto &participant : folder.participants()) {
    if (participant->state() == Participant::State::forgotten)
      continue;
    csv.field(participant->name())
        .field(name_of(participant->state()))
        .field(static_cast<std::int64_t>(participant->place().group) + 1)
        .field(static_cast<std::int64_t>(participant->place().row) + 1);
    for (int session = 1; session <= static_cast<int>(sessions); session++)
      csv.field(session <= participant->sessions()
                    ? levels_text(participant->condition(session).levels)
                    : "");
    csv.end();
  }
  return csv.text();
}

} // namespace study
