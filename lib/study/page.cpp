// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/page.h"

#include "json/json_reader.h"

namespace study {

namespace {

using visuotactile::json::write_text;

const char *
name_of(Phase phase)
{
  return phase == Phase::ready ? "ready" : phase == Phase::playing ? "playing" : "failed";
}

std::string
member(const char *name, const std::string &json)
{
  return std::string(", \"") + name + "\": " + json;
}

template <typename Texts>
std::string
array(const Texts &texts)
{
  std::string json;
  for (const auto &text : texts)
    json += (json.empty() ? "" : ", ") + write_text(text);
  return "[" + json + "]";
}

std::string
question_json(const Question &question)
{
  return "{\"name\": " + write_text(question.name) + member("text", write_text(question.text))
         + member("kind", write_text(name_of(question.kind)))
         + member("low", write_number(question.low)) + member("high", write_number(question.high))
         + member("step", write_number(question.step)) + member("labels", array(question.labels))
         + "}";
}

std::string
step_json(const Participant &participant, Phase phase, std::int64_t at)
{
  const Step &step = participant.step();
  return "{\"name\": " + write_text(step.name) + member("kind", write_text(name_of(step.kind)))
         + member("session", std::to_string(step.session))
         + member("done", std::to_string(participant.steps_done()))
         + member("count", std::to_string(participant.steps().size() - 1))
         + member("phase", write_text(name_of(phase)))
         + member("restLeft", std::to_string(participant.rest_left(at)))
         + (step.question ? member("question", question_json(*step.question)) : "") + "}";
}

std::string
session_json(const Participant &participant, int session)
{
  const auto plays = participant.plays_of(session);
  std::string json = "{\"session\": " + std::to_string(session)
                     + member("condition", session == Step::kPractice
                                               ? "{}"
                                               : object_json(participant.condition(session).levels))
                     + member("plays", std::to_string(plays.size()))
                     + member("marks", array(participant.marks(session)));
  if (!plays.empty()) {
    const Play &play = *plays.back();
    json += member("outcome", write_text(name_of(play.outcome)))
            + member("text", write_text(play.text.empty() ? play.chair : play.text))
            + member("commands", std::to_string(play.timing.commands))
            + member("p99", write_number(play.timing.p99))
            + member("max", write_number(play.timing.max))
            + member("frames", std::to_string(play.frames))
            + member("dropped", std::to_string(play.frames_dropped));
  }
  return json + "}";
}

} // namespace

std::string
object_json(const Settings &settings)
{
  std::string json;
  for (const auto &[name, value] : settings)
    json += (json.empty() ? "" : ", ") + write_text(name) + ": " + write_text(value);
  return "{" + json + "}";
}

std::string
page_state(const Study &study, const Participant *participant, Phase phase, std::int64_t at)
{
  if (participant && participant->state() != Participant::State::running
      && participant->state() != Participant::State::done)
    participant = nullptr; // was dropped
  const Study &of = participant ? participant->study() : study;
  std::string json
      = "{\"title\": " + write_text(of.title)
        + member("participant", participant ? write_text(participant->name()) : "null");
  if (participant == nullptr)
    return json + "}";
  json += member("sessions", std::to_string(participant->sessions()))
          + member("step", step_json(*participant, phase, at));
  switch (participant->step().kind) {
  case Step::Kind::consent:
    json += member("text", write_text(of.consent))
            + member("version", write_text(of.consent_version));
    break;
  case Step::Kind::instructions:
    json += member("text", write_text(of.instructions));
    break;
  case Step::Kind::done:
    json += member("text", write_text(of.thanks));
    break;
  default:
    break;
  }
  return json + "}";
}

std::string
overview(const Folder &folder, const Participant *active, Phase phase, std::int64_t at)
{
  std::string people;
  for (const auto &participant : folder.participants())
    people += std::string(people.empty() ? "" : ", ")
              + "{\"name\": " + write_text(participant->name())
              + member("state", write_text(name_of(participant->state())))
              + member("done", std::to_string(participant->steps_done()))
              + member("count", std::to_string(participant->steps().size() - 1)) + "}";
  for (const auto &[name, why] : folder.damaged())
    people += std::string(people.empty() ? "" : ", ") + "{\"name\": " + write_text(name)
              + member("state", "\"damaged\"") + member("done", "0") + member("count", "0") + "}";
  std::string json = "{\"title\": " + write_text(folder.study().title)
                     + member("people", std::to_string(folder.study().people))
                     + member("participants", "[" + people + "]")
                     + member("active", active ? write_text(active->name()) : "null");
  if (active != nullptr) {
    std::string sessions;
    for (int session = active->study().practice ? Step::kPractice : 1;
         session <= active->sessions(); session++)
      sessions += (sessions.empty() ? "" : ", ") + session_json(*active, session);
    json += member("group", object_json(active->group().levels))
            + member("step", step_json(*active, phase, at))
            + member("sessions", "[" + sessions + "]");
  }
  return json + "}";
}

} // namespace study
