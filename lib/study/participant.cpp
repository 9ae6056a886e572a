// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/participant.h"

#include "json/json_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace study {

namespace {

namespace json = visuotactile::json;

constexpr std::int64_t kLatest = std::int64_t{ 1 } << 52;
constexpr std::size_t kMostAnswer = 30000; ///< bytes: 10,000 characters of the page, all long
constexpr std::size_t kSum = 12;
constexpr std::array kOutcomes
    = { Play::Outcome::lost, Play::Outcome::ended, Play::Outcome::stopped, Play::Outcome::failed };

tl::unexpected<std::string>
expected(const std::string &what)
{
  return tl::unexpected("expected " + what);
}

/// At most so many words of a text.
std::vector<std::string>
words_of(const std::string &text)
{
  constexpr int kMost = 10;
  g_auto(GStrv) words = g_strsplit(text.c_str(), " ", kMost);
  std::vector<std::string> found;
  for (gchar **word = words; *word; word++)
    if (**word != '\0')
      found.emplace_back(*word);
  return found;
}

std::int64_t
count_of(JsonObject *object, const char *name)
{
  return json::integer(object, name, 0, kLatest).value_or(0);
}

std::string
json_of(JsonObject *object, const char *name)
{
  JsonNode *node = json_object_get_member(object, name);
  if (node == nullptr)
    return "";
  g_autofree gchar *text = json_to_string(node, FALSE);
  return text;
}

/// Fails unless the question's scale has the answer.
tl::expected<void, std::string>
check(const Question &question, const std::string &answer)
{
  if (question.kind == Question::Kind::text) {
    if (answer.size() > kMostAnswer)
      return expected("an answer of at most " + std::to_string(kMostAnswer) + " bytes");
    return {};
  }
  const bool is_slider = question.kind == Question::Kind::slider;
  const double low = is_slider ? question.low : 1;
  const double high = is_slider ? question.high : static_cast<double>(question.labels.size());
  gchar *end = nullptr;
  const double value = g_ascii_strtod(answer.c_str(), &end);
  if (answer.empty() || *end != '\0' || !(value >= low && value <= high)
      || (!is_slider && value != std::floor(value)))
    return expected(std::string(is_slider ? "a number" : "a whole number") + " from "
                    + write_number(low) + " to " + write_number(high));
  return {};
}

bool
is_asked(const Question &question, const Settings &levels)
{
  return std::ranges::all_of(question.when, [&](const auto &condition) {
    const auto found = levels.find(condition.first);
    return found != levels.end() && found->second == condition.second;
  });
}

} // namespace

const char *
name_of(Step::Kind kind)
{
  constexpr const char *kNames[]
      = { "consent", "instructions", "film", "question", "rest", "done" };
  return kNames[static_cast<std::size_t>(kind)];
}

const char *
name_of(Participant::State state)
{
  constexpr const char *kNames[] = { "running", "done", "dropped", "forgotten" };
  return kNames[static_cast<std::size_t>(state)];
}

const char *
name_of(Play::Outcome outcome)
{
  constexpr const char *kNames[] = { "lost", "ended", "stopped", "failed" };
  return kNames[static_cast<std::size_t>(outcome)];
}

Participant::Participant(std::string name, Study study, const std::string &text)
    : name_(std::move(name)), study_(std::move(study))
{
  g_autofree gchar *sum = g_compute_checksum_for_data(
      G_CHECKSUM_SHA256, reinterpret_cast<const guchar *>(text.data()), text.size());
  sum_.assign(sum, kSum);
}

tl::expected<std::unique_ptr<Participant>, std::string>
Participant::read(const std::string &name, const std::string &study,
                  const std::vector<std::string> &lines)
{
  auto parsed = read_study(study);
  if (!parsed)
    return tl::unexpected(name + ", its study: " + parsed.error());
  std::unique_ptr<Participant> participant(new Participant(name, *std::move(parsed), study));
  if (lines.empty())
    return tl::unexpected(name + ": expected a first line");
  for (std::size_t i = 0; i < lines.size(); i++) {
    const auto applied = i == 0 ? participant->begin(lines[i]) : participant->apply(lines[i]);
    if (!applied)
      return tl::unexpected(name + ", entry " + std::to_string(i + 1) + ": " + applied.error());
  }
  return participant;
}

Event
Participant::start(const Place &place, const std::string &program)
{
  return Event("start")
      .add("group", static_cast<std::int64_t>(place.group))
      .add("row", static_cast<std::int64_t>(place.row))
      .add("program", program);
}

tl::expected<void, std::string>
Participant::begin(const std::string &line)
{
  const json::ObjectText event(line);
  const std::string kind = event.object() ? json::whole_text(event.object(), "event") : "";
  if (kind == "forgotten") {
    is_forgotten_ = true;
    last_ = count_of(event.object(), "at");
    steps_ = { Step{} };
    return {};
  }
  if (kind != "start")
    return expected("the event start");
  const auto groups = study_.groups();
  const auto square = study_.square();
  place_ = { .group = static_cast<std::size_t>(count_of(event.object(), "group")),
             .row = static_cast<std::size_t>(count_of(event.object(), "row")) };
  if (place_.group >= groups.size() || place_.row >= square.size())
    return expected("a group and a row of the study");
  group_ = groups[place_.group];
  const auto conditions = study_.conditions();
  for (const std::size_t condition : square[place_.row])
    order_.push_back(conditions[condition]);
  program_ = json::whole_text(event.object(), "program");
  last_ = count_of(event.object(), "at");
  plan();
  return {};
}

/// The steps of a participant with this order.
void
Participant::plan()
{
  using Kind = Step::Kind;
  const auto add = [this](Kind kind, int session, const std::string &name,
                          const Question *question = nullptr) {
    steps_.push_back({ .kind = kind,
                       .name = session == Step::kNone ? name : std::to_string(session) + "/" + name,
                       .session = session,
                       .question = question });
  };
  const auto add_session = [&](int session, const Settings &levels) {
    add(Kind::film, session, "film");
    for (const Question &question : study_.questions)
      if (!question.at_end && is_asked(question, levels))
        add(Kind::question, session, question.name, &question);
  };
  add(Kind::consent, Step::kNone, "consent");
  if (!study_.instructions.empty())
    add(Kind::instructions, Step::kNone, "instructions");
  if (study_.practice)
    add_session(Step::kPractice, group_.levels);
  for (int session = 1; session <= sessions(); session++) {
    Settings levels = condition(session).levels;
    levels.insert(group_.levels.begin(), group_.levels.end());
    if (session > 1)
      add(Kind::rest, session - 1, "break");
    add_session(session, levels);
  }
  for (const Question &question : study_.questions)
    if (question.at_end && is_asked(question, group_.levels))
      add(Kind::question, Step::kNone, "end/" + question.name, &question);
  add(Kind::done, Step::kNone, "done");
}

Participant::State
Participant::state() const
{
  return is_forgotten_                     ? State::forgotten
         : is_dropped_                     ? State::dropped
         : step().kind == Step::Kind::done ? State::done
                                           : State::running;
}

tl::expected<void, std::string>
Participant::fits(const std::string &line) const
{
  const json::ObjectText text(line);
  JsonObject *event = text.object();
  if (event == nullptr)
    return expected("a JSON object");
  const std::string kind = json::whole_text(event, "event");
  const std::string name = json::whole_text(event, "step");
  if (state() == State::forgotten || state() == State::dropped)
    return expected(std::string("nothing more: the participant was ") + name_of(state()));
  if (kind == "drop")
    return {};
  if (name != step().name || step().kind == Step::Kind::done)
    return expected("the step '" + step().name + "', got '" + name + "'");
  const bool is_film = step().kind == Step::Kind::film;
  const bool is_playing = !plays_.empty() && plays_.back().step == name;
  const bool is_known
      = is_film ? kind == "play" || (is_playing && (kind == "played" || kind == "go-on"))
                : kind == "step";
  if (!is_known)
    return expected("an event of the step '" + step().name + "', got '" + kind + "'");
  return step().kind == Step::Kind::question
             ? check(*step().question, json::whole_text(event, "answer"))
             : tl::expected<void, std::string>();
}

tl::expected<void, std::string>
Participant::apply(const std::string &line)
{
  if (const auto fitting = fits(line); !fitting)
    return fitting;
  const json::ObjectText text(line);
  JsonObject *event = text.object();
  const std::string kind = json::whole_text(event, "event");
  last_ = count_of(event, "at");
  if (kind == "drop") {
    is_dropped_ = true;
  } else if (kind == "step") {
    const std::string answer = json::whole_text(event, "answer");
    if (step().kind == Step::Kind::question)
      answers_.push_back({ .step = &step(),
                           .at = last_,
                           .response = count_of(event, "response_ms"),
                           .text = answer });
    if (step().kind == Step::Kind::consent)
      consent_ = answer;
    at_++;
  } else if (kind == "play") {
    plays_.push_back({ .step = step().name,
                       .at = last_,
                       .trace = json::whole_text(event, "trace"),
                       .settings = json_of(event, "settings"),
                       .film = json::whole_text(event, "film"),
                       .program = json::whole_text(event, "program"),
                       .gstreamer = json::whole_text(event, "gstreamer") });
  } else if (kind == "played") {
    Play &play = plays_.back();
    const std::string outcome = json::whole_text(event, "outcome");
    for (const Play::Outcome one : kOutcomes)
      if (outcome == name_of(one))
        play.outcome = one;
    play.ended = last_;
    play.text = json::whole_text(event, "text");
    play.chair = json::whole_text(event, "chair");
    play.doubts = words_of(json::whole_text(event, "doubts"));
    play.timing = { .commands = count_of(event, "commands"),
                    .late = count_of(event, "late"),
                    .p50 = json::number(event, "error_p50_ms").value_or(0),
                    .p99 = json::number(event, "error_p99_ms").value_or(0),
                    .max = json::number(event, "error_max_ms").value_or(0) };
    play.frames = count_of(event, "frames");
    play.frames_dropped = count_of(event, "frames_dropped");
    at_ += play.outcome == Play::Outcome::ended ? 1 : 0;
  } else { // go-on
    at_++;
  }
  return {};
}

tl::expected<Event, std::string>
Participant::answer(const std::string &name, const std::string &answer, std::int64_t response,
                    std::int64_t at) const
{
  if (state() != State::running || name != step().name || step().kind == Step::Kind::film)
    return expected("the step '" + step().name + "', got '" + name + "'");
  Event event("step", at);
  event.add("step", name);
  if (step().kind == Step::Kind::question) {
    if (const auto checked = check(*step().question, answer); !checked)
      return tl::unexpected(checked.error());
    event.add("answer", answer);
  } else if (step().kind == Step::Kind::consent) {
    if (answer != study_.consent_version)
      return expected("consent of version " + study_.consent_version);
    event.add("answer", answer);
  } else if (step().kind == Step::Kind::rest && rest_left(at) > 0) {
    return expected("the end of the break in " + std::to_string(rest_left(at) / 1000 + 1) + " s");
  }
  return event.add("response_ms", response);
}

Settings
Participant::settings(int session) const
{
  Settings all = study_.settings;
  const auto add = [&all](const Settings &more) {
    for (const auto &[name, value] : more)
      all[name] = value;
  };
  add(group_.settings);
  if (session == Step::kPractice)
    add(study_.practice.value_or(Settings{}));
  else
    add(condition(session).settings);
  return all;
}

std::vector<const Play *>
Participant::plays_of(int session) const
{
  std::vector<const Play *> plays;
  const std::string step = std::to_string(session) + "/film";
  for (const Play &play : plays_)
    if (play.step == step)
      plays.push_back(&play);
  return plays;
}

std::int64_t
Participant::rest_left(std::int64_t at) const
{
  const auto whole = static_cast<std::int64_t>(study_.least_break * 1000);
  if (plays_.empty() || step().kind != Step::Kind::rest)
    return 0;
  const Play &last = plays_.back();
  // A clock that was set back makes no break longer.
  return std::clamp<std::int64_t>(std::max(last.at, last.ended) + whole - at, 0, whole);
}

std::vector<std::string>
Participant::marks(int session) const
{
  const auto plays = plays_of(session);
  if (plays.empty())
    return {};
  const Play &last = *plays.back();
  std::vector<std::string> marks;
  const auto mark = [&marks](bool is_marked, const char *name) {
    if (is_marked)
      marks.emplace_back(name);
  };
  mark(plays.size() > 1, "repeated");
  mark(
      last.outcome != Play::Outcome::ended
          && (at_ >= steps_.size() || step().session != session || step().kind != Step::Kind::film),
      last.outcome == Play::Outcome::lost ? "interrupted" : name_of(last.outcome));
  mark(last.timing.commands > 0 && last.timing.p99 > study_.latest, "late");
  mark(static_cast<double>(last.frames_dropped) * 100
           > study_.most_dropped * static_cast<double>(last.frames + last.frames_dropped),
       "dropped-frames");
  mark(!last.chair.empty(), "chair");
  for (const std::string &doubt : last.doubts)
    mark(true, doubt.c_str());
  if (last.outcome == Play::Outcome::ended) {
    mark(last.frames == 0 && std::ranges::find(last.doubts, "not-shown") == last.doubts.end(),
         "not-shown");
    const Settings used = settings(session);
    const auto intensity = used.find("intensity");
    mark(last.timing.commands == 0
             && (intensity == used.end() || g_ascii_strtod(intensity->second.c_str(), nullptr) > 0),
         "no-commands");
  }
  return marks;
}

} // namespace study
