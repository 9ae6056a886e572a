// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/events.h"
#include "study/study.h"
#include "study/timing.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace study {

/// A step of a participant: a page.
struct Step
{
  enum class Kind
  {
    consent,
    instructions,
    film,
    question,
    rest, ///< a break
    done,
  };
  static constexpr int kPractice = 0;
  static constexpr int kNone = -1; ///< a step of no session

  Kind kind = Kind::done;
  std::string name; ///< "consent", "1/film", "1/Q1", "1/break", "end/S1"
  int session = kNone;
  const Question *question = nullptr;
};

const char *name_of(Step::Kind kind);

/// A play of a film.
struct Play
{
  enum class Outcome
  {
    lost, ///< the program ended during it
    ended,
    stopped,
    failed,
  };
  std::string step;
  std::int64_t at = 0;
  std::int64_t ended = 0; ///< 0: not, or lost
  Outcome outcome = Outcome::lost;
  std::string text;     ///< why it failed
  std::string trace;    ///< file, below the folder of data
  std::string settings; ///< JSON
  std::string film;
  std::string program; ///< version
  std::string gstreamer;
  std::string chair;               ///< its fault; empty: none
  std::vector<std::string> doubts; ///< marks by the program: not-shown, no-noise, simulated
  Timing timing{};
  std::int64_t frames = 0;
  std::int64_t frames_dropped = 0;
};

struct Answer
{
  const Step *step = nullptr;
  std::int64_t at = 0;
  std::int64_t response = 0; ///< ms
  std::string text;          ///< also of a number
};

/// A participant, read from the journal. Pointers into it stay valid.
class Participant
{
public:
  enum class State
  {
    running,
    done,
    dropped,
    forgotten,
  };

  /// Reads the lines of a journal, the first of which is start() or that the participant is
  /// forgotten, with the text of the study. The error names the line that does not fit.
  static tl::expected<std::unique_ptr<Participant>, std::string>
  read(const std::string &name, const std::string &study, const std::vector<std::string> &lines);

  static Event start(const Place &place, const std::string &program);

  /// Fails unless apply() would take the line.
  tl::expected<void, std::string> fits(const std::string &line) const;
  /// Takes the next line of the journal. A line that does not fit changes nothing.
  tl::expected<void, std::string> apply(const std::string &line);

  /// The event for the answer of a page; an error unless the present step expects it.
  tl::expected<Event, std::string> answer(const std::string &step, const std::string &answer,
                                          std::int64_t response, std::int64_t at = now()) const;

  const std::string &name() const
  {
    return name_;
  }
  const Study &study() const
  {
    return study_;
  }
  /// The beginning of a checksum of the study's text.
  const std::string &study_sum() const
  {
    return sum_;
  }
  State state() const;
  const Place &place() const
  {
    return place_;
  }
  const std::string &program() const
  {
    return program_;
  }
  std::int64_t last_time() const
  {
    return last_;
  }
  const std::vector<Step> &steps() const
  {
    return steps_;
  }
  const Step &step() const
  {
    return steps_[at_];
  }
  std::size_t steps_done() const
  {
    return at_;
  }
  int sessions() const
  {
    return static_cast<int>(order_.size());
  }
  /// The condition of a session, 1 to sessions().
  const Condition &condition(int session) const
  {
    return order_[static_cast<std::size_t>(session - 1)];
  }
  const Condition &group() const
  {
    return group_;
  }
  /// The settings of a session or the practice: the study's, the group's and the condition's.
  Settings settings(int session) const;
  const std::vector<Play> &plays() const
  {
    return plays_;
  }
  std::vector<const Play *> plays_of(int session) const;
  const std::vector<Answer> &answers() const
  {
    return answers_;
  }
  const std::string &consent() const ///< its version; empty: none yet
  {
    return consent_;
  }
  /// ms until the break may end.
  std::int64_t rest_left(std::int64_t at = now()) const;
  /// Faults of a session, such as "late"; empty: none.
  std::vector<std::string> marks(int session) const;

private:
  Participant(std::string name, Study study, const std::string &text);
  tl::expected<void, std::string> begin(const std::string &line);
  void plan();

  std::string name_;
  Study study_;
  std::string sum_;
  Place place_{};
  std::string program_;
  Condition group_;
  std::vector<Condition> order_;
  std::vector<Step> steps_;
  std::size_t at_ = 0;
  std::vector<Play> plays_;
  std::vector<Answer> answers_;
  std::string consent_;
  std::int64_t last_ = 0;
  bool is_dropped_ = false;
  bool is_forgotten_ = false;
};

const char *name_of(Participant::State state);
const char *name_of(Play::Outcome outcome);

} // namespace study
