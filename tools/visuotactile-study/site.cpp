// SPDX-License-Identifier: LGPL-2.1-or-later
#include "site.h"

#include "web/soup.h"
#include "json/json_reader.h"

#include <gst/gst.h>

#include <algorithm>

namespace {

namespace json = visuotactile::json;

using study::Event;
using study::Step;

std::string
gstreamer_version()
{
  g_autofree gchar *text = gst_version_string();
  return text;
}

} // namespace

const StudySite::Route StudySite::kRoutes[] = {
  { false, "state", "GET", &StudySite::state },
  { false, "events", "GET", &StudySite::events },
  { false, "step", "POST", &StudySite::step },
  { false, "play", "POST", &StudySite::play },
  { true, "play", "POST", &StudySite::play_film },
  { true, "overview", "GET", &StudySite::overview },
  { true, "events", "GET", &StudySite::all_events },
  { true, "act", "POST", &StudySite::act },
};

StudySite::StudySite(study::Folder &folder, Settings settings)
    : folder_(folder), settings_(std::move(settings)), active_(folder.unfinished()),
      events_([](const std::string &) {}), of_experimenter_([](const std::string &) {}),
      tick_(g_timeout_add(
          100,
          +[](gpointer data) -> gboolean {
            auto *self = static_cast<StudySite *>(data);
            if (self->play_)
              self->of_experimenter_.send(Events::event("chair", self->chair_json()));
            return G_SOURCE_CONTINUE;
          },
          this))
{
}

StudySite::~StudySite()
{
  g_source_remove(tick_);
  stop_film("the program was ended");
}

const StudySite::Route *
StudySite::find(const std::string &path, bool &of_experimenter, std::string &rest) const
{
  of_experimenter = path.starts_with(settings_.experimenter);
  rest = of_experimenter ? path.substr(settings_.experimenter.size()) : path;
  const auto *const found = std::ranges::find_if(kRoutes, [&](const Route &route) {
    return route.of_experimenter == of_experimenter && route.path == rest;
  });
  return found != std::end(kRoutes) ? found : nullptr;
}

std::string
StudySite::methods(const std::string &path) const
{
  bool of_experimenter = false;
  std::string rest;
  const Route *route = find(path, of_experimenter, rest);
  return route ? route->methods : "GET, HEAD";
}

void
StudySite::answer(SoupServerMessage *message, const std::string &path)
{
  bool of_experimenter = false;
  std::string rest;
  const Route *route = find(path, of_experimenter, rest);
  if (route == nullptr) {
    constexpr std::string_view kVendor = "vendor-";
    if (rest.starts_with(kVendor))
      return answer_page(message, settings_.page + "/vendor", rest.substr(kVendor.size()));
    const char *first = of_experimenter ? "experimenter.html" : "index.html";
    return answer_page(message, settings_.page, rest.empty() ? first : rest);
  }
  const SoupMessageBody *body = soup_server_message_get_request_body(message);
  (this->*route->handler)(message,
                          { body->data ? body->data : "", static_cast<std::size_t>(body->length) });
}

study::Phase
StudySite::phase() const
{
  if (play_)
    return study::Phase::playing;
  const bool has_failed = active_ && active_->step().kind == Step::Kind::film
                          && !active_->plays().empty()
                          && active_->plays().back().step == active_->step().name;
  return has_failed ? study::Phase::failed : study::Phase::ready;
}

std::string
StudySite::state_json() const
{
  return study::page_state(folder_.study(), active_, phase());
}

std::string
StudySite::chair_json() const
{
  const ChairLevels now = play_ ? play_->levels() : ChairLevels{};
  std::string levels;
  for (const float level : now.levels)
    levels += (levels.empty() ? "" : ", ") + study::write_number(level);
  return "{\"rows\": " + std::to_string(now.rows) + ", \"columns\": " + std::to_string(now.columns)
         + ", \"position\": " + study::write_number(now.position) + ", \"levels\": [" + levels
         + "]}";
}

std::string
StudySite::overview_json() const
{
  return study::overview(folder_, active_, phase());
}

void
StudySite::tell()
{
  events_.send(Events::event("state", state_json()));
  of_experimenter_.send(Events::event("overview", overview_json()));
}

void
StudySite::state(SoupServerMessage *message, std::string_view)
{
  answer_json(message, state_json());
}

void
StudySite::overview(SoupServerMessage *message, std::string_view)
{
  answer_json(message, overview_json());
}

void
StudySite::events(SoupServerMessage *message, std::string_view)
{
  events_.add(message, "", Events::event("state", state_json()));
}

void
StudySite::all_events(SoupServerMessage *message, std::string_view)
{
  of_experimenter_.add(message, "",
                       Events::event("overview", overview_json())
                           + Events::event("chair", chair_json()));
}

bool
StudySite::add(SoupServerMessage *message, const Event &event)
{
  const auto added = folder_.add(*active_, event);
  if (!added)
    answer_error(message, 507, added.error());
  return added.has_value();
}

void
StudySite::step(SoupServerMessage *message, std::string_view body)
{
  const json::ObjectText text(body);
  constexpr std::int64_t kDay = std::int64_t{ 86400 } * 1000;
  const auto response
      = text.object() ? json::integer(text.object(), "response", 0, kDay) : std::nullopt;
  const std::string name = json::whole_text(text.object(), "step");
  if (!response || name.empty())
    return answer_error(message, 400, "expected step, answer and response, in ms");
  if (active_ == nullptr)
    return answer_error(message, 409, "no participant has begun", "\"state\": " + state_json());
  const auto event = active_->answer(name, json::whole_text(text.object(), "answer"), *response);
  if (!event)
    return answer_error(message, 409, event.error(), "\"state\": " + state_json());
  if (!add(message, *event))
    return;
  answer_json(message, state_json());
  tell();
}

void
StudySite::play(SoupServerMessage *message, std::string_view body)
{
  // A page that had no answer sends it again.
  if (phase() == study::Phase::failed)
    return answer_error(message, 409, "the experimenter decides about a film that was cut off",
                        "\"state\": " + state_json());
  play_film(message, body);
}

void
StudySite::play_film(SoupServerMessage *message, std::string_view body)
{
  const json::ObjectText text(body);
  const std::string name = json::whole_text(text.object(), "step");
  if (active_ == nullptr || play_ || active_->step().kind != Step::Kind::film
      || active_->step().name != name)
    return answer_error(message, 409, "no such film is to be played now",
                        "\"state\": " + state_json());
  const int session = active_->step().session;
  study::Settings settings = active_->settings(session);
  for (const auto &[key, value] : settings_.overrides)
    settings[key] = value;
  add_defaults(settings, settings_.defaults);
  const auto trace = folder_.next_trace(*active_, session);
  if (!trace)
    return answer_error(message, 507, trace.error());
  Event event("play");
  event.add("step", name)
      .add("film", settings["film"])
      .add_json("settings", study::object_json(settings))
      .add("trace", *trace)
      .add("program", std::string(PACKAGE_VERSION))
      .add("gstreamer", gstreamer_version());
  if (!add(message, event))
    return;
  step_played_ = name;
  try {
    play_ = std::make_unique<FilmPlay>(FilmPlay::Order{ .film = folder_.film(settings["film"]),
                                                        .settings = settings,
                                                        .trace = folder_.data(*trace),
                                                        .window = settings_.window,
                                                        .screen = settings_.screen },
                                       [this](const study::Play &result) { played(result); });
  } catch (const std::exception &error) {
    study::Play failed;
    failed.outcome = study::Play::Outcome::failed;
    failed.text = error.what();
    played(failed);
  }
  answer_json(message, state_json());
  tell();
}

void
StudySite::played(const study::Play &result)
{
  Event event("played");
  event.add("step", step_played_)
      .add("outcome", std::string(study::name_of(result.outcome)))
      .add("text", result.text)
      .add("chair", result.chair)
      .add("doubts", study::joined(result.doubts))
      .add("commands", result.timing.commands)
      .add("late", result.timing.late)
      .add("error_p50_ms", result.timing.p50)
      .add("error_p99_ms", result.timing.p99)
      .add("error_max_ms", result.timing.max)
      .add("frames", result.frames)
      .add("frames_dropped", result.frames_dropped);
  over_ = std::move(play_); // which has called this
  if (const auto added = folder_.add(*active_, event); !added)
    of_experimenter_.send(Events::event("trouble", json::write_text(added.error())));
  tell();
}

void
StudySite::stop_film(const std::string &why)
{
  if (play_)
    play_->stop(why);
}

void
StudySite::act(SoupServerMessage *message, std::string_view body)
{
  const json::ObjectText text(body);
  const std::string act = json::whole_text(text.object(), "act");
  const std::string name = json::whole_text(text.object(), "participant");
  const auto refuse = [&](const std::string &why) {
    answer_error(message, 409, why);
  };
  if (act == "stop") {
    stop_film("the experimenter stopped it");
  } else if (play_) {
    return refuse("a film plays; stop it first");
  } else if (act == "start") {
    if (active_ && active_->state() == study::Participant::State::running)
      return refuse("expected no participant in a session; drop or finish " + active_->name());
    const auto started = folder_.start(PACKAGE_VERSION);
    if (!started)
      return answer_error(message, 507, started.error());
    active_ = *started;
  } else if (act == "resume") {
    study::Participant *wanted = folder_.find(name);
    if (wanted == nullptr || wanted->state() != study::Participant::State::running)
      return refuse("expected a participant who has not finished");
    active_ = wanted;
  } else if (act == "drop" || act == "go-on") {
    if (active_ == nullptr || active_->name() != name)
      return refuse("expected the participant in the session");
    Event event(act.c_str());
    if (act == "go-on")
      event.add("step", active_->step().name);
    if (!add(message, event))
      return;
  } else {
    return answer_error(message, 400, "expected start, resume, stop, go-on or drop");
  }
  answer_json(message, overview_json());
  tell();
}
