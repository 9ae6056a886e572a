// SPDX-License-Identifier: LGPL-2.1-or-later
#include "routes.h"

#include "web/sent_file.h"
#include "web/soup.h"

#include "tactor/motor_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace {

using desk::write_text;

std::string
number(double value)
{
  std::array<char, G_ASCII_DTOSTR_BUF_SIZE> text{};
  return g_ascii_formatd(text.data(), static_cast<gint>(text.size()), "%.15g", value);
}

std::string
name_of(const std::string &path)
{
  g_autofree gchar *name = g_path_get_basename(path.c_str());
  return name;
}

std::string
limits_json()
{
  const tactor::MotorLimits limits;
  const auto ms = [](tactor::Time time) {
    return std::to_string(time / std::chrono::milliseconds(1));
  };
  return "{\"maxOnTime\": " + ms(limits.max_on_time) + ", \"maxDuty\": " + number(limits.max_duty)
         + ", \"dutyWindow\": " + ms(tactor::MotorUse::kDutyWindow)
         + ", \"maxActive\": " + std::to_string(limits.max_active)
         + ", \"shortestRest\": " + ms(tactor::MotorUse::kShortestRest) + "}";
}

} // namespace

const Routes::Route Routes::kRoutes[] = {
  { "session", "GET", &Routes::session },       { "track", "GET", &Routes::track },
  { "draft", "GET", &Routes::draft },           { "events", "GET", &Routes::events },
  { "film", "GET, HEAD", &Routes::film },       { "film.webm", "GET", &Routes::proxy },
  { "thumbnails", "GET", &Routes::thumbnails }, { "thumbnail", "GET", &Routes::thumbnail },
  { "sound", "GET", &Routes::sound },           { "cuts", "GET", &Routes::cuts },
  { "export", "GET", &Routes::export_track },   { "export.html", "GET", &Routes::export_page },
  { "edits", "POST", &Routes::edits },          { "save", "POST", &Routes::save },
  { "operation", "POST", &Routes::operation },  { "writer", "POST", &Routes::writer },
  { "position", "POST", &Routes::position },    { "feel", "POST", &Routes::feel },
};

Routes::Routes(DeskSettings settings, desk::Session &session, const FilmContents &contents)
    : settings_(std::move(settings)), session_(session),
      events_([this](const std::string &page) { left(page); }), draft_(contents.draft()),
      strip_(contents.strip()), proxies_(settings_.found),
      feel_(settings_.sink, session_,
            [this] { events_.send(Events::event("chair", chair_json())); }),
      tick_(g_timeout_add(
          500,
          +[](gpointer self) -> gboolean {
            static_cast<Routes *>(self)->tell_progress();
            return G_SOURCE_CONTINUE;
          },
          this))
{
}

Routes::~Routes()
{
  g_source_remove(tick_);
}

std::string
Routes::methods(const std::string &path) const
{
  const auto *const found = std::ranges::find(kRoutes, path, &Route::path);
  return found != std::end(kRoutes) ? found->methods : "GET, HEAD";
}

goffset
Routes::largest_body(const std::string &path) const
{
  return path == "edits" ? goffset{ 32 } << 20 : kLargestBody;
}

void
Routes::answer(SoupServerMessage *message, const std::string &path)
{
  const auto *const found = std::ranges::find(kRoutes, path, &Route::path);
  if (found == std::end(kRoutes))
    return answer_page(message, settings_.page, path.empty() ? "index.html" : path);
  const SoupMessageBody *body = soup_server_message_get_request_body(message);
  (this->*found->handler)(message,
                          { body->data ? body->data : "", static_cast<std::size_t>(body->length) });
}

bool
Routes::may_write(SoupServerMessage *message, const std::string &page) const
{
  if (seat_.has(page))
    return true;
  answer_error(message, 423, "this page does not write; take over first",
               "\"writer\": " + (seat_.writer() ? write_text(*seat_.writer()) : "null"));
  return false;
}

void
Routes::refuse(SoupServerMessage *message, const desk::Refusal &refusal) const
{
  using Kind = desk::Refusal::Kind;
  const bool is_changed = refusal.kind == Kind::changed;
  const guint status = refusal.kind == Kind::invalid               ? 400
                       : refusal.kind == Kind::stale || is_changed ? 409
                                                                   : 507;
  answer_error(message, status, refusal.text,
               "\"revision\": " + std::to_string(session_.revision())
                   + (is_changed ? ", \"changed\": true" : ""));
}

void
Routes::edits(SoupServerMessage *message, std::string_view body)
{
  const auto edit = desk::read_edit(body);
  if (!edit)
    return answer_error(message, 400, edit.error());
  if (!may_write(message, edit->page))
    return;
  const auto changed = session_.edit(*edit);
  if (!changed)
    return refuse(message, changed.error());
  feel_.track_changed(*changed);
  events_.send(Events::event("revision", revision_json()));
  answer_json(message, revision_json());
}

void
Routes::save(SoupServerMessage *message, std::string_view body)
{
  const auto page = desk::read_page(body);
  if (!page)
    return answer_error(message, 400, page.error());
  if (!may_write(message, page->page))
    return;
  const auto saved = session_.save(page->over);
  if (!saved)
    return refuse(message, saved.error());
  events_.send(Events::event("revision", revision_json()));
  std::string json = revision_json();
  json.pop_back();
  json += ", \"path\": " + write_text(session_.path());
  if (!saved->kept.empty())
    json += ", \"kept\": " + write_text(saved->kept);
  answer_json(message, json + "}");
}

void
Routes::operation(SoupServerMessage *message, std::string_view body)
{
  const auto asked = desk::read_operation(body);
  if (!asked)
    return answer_error(message, 400, asked.error());
  if (asked->revision != session_.revision())
    return refuse(message, { .kind = desk::Refusal::Kind::stale,
                             .text = "the track has been edited since; load it again" });
  const auto splices = desk::operate(session_.document(),
                                     draft_.track() ? &*draft_.track() : nullptr, asked->operation);
  if (!splices)
    return answer_error(message, 400, splices.error());
  answer_json(message, "{\"revision\": " + std::to_string(session_.revision())
                           + ", \"splices\": " + desk::write_splices(*splices) + "}");
}

void
Routes::writer(SoupServerMessage *message, std::string_view body)
{
  const auto page = desk::read_page(body);
  if (!page)
    return answer_error(message, 400, page.error());
  const auto before = seat_.writer();
  if (page->give)
    seat_.give(page->page);
  else
    seat_.take(page->page, page->take);
  if (before && before != seat_.writer())
    feel_.left(*before);
  if (before != seat_.writer())
    events_.send(Events::event("writer", writer_json()));
  answer_json(message,
              std::string("{\"writer\": ") + (seat_.has(page->page) ? "true" : "false") + "}");
}

void
Routes::position(SoupServerMessage *message, std::string_view body)
{
  const auto position = desk::read_position(body);
  if (!position)
    return answer_error(message, 400, position.error());
  if (!may_write(message, position->page))
    return;
  feel_.position(*position);
  soup_server_message_set_status(message, 204, nullptr);
}

void
Routes::feel(SoupServerMessage *message, std::string_view body)
{
  const auto asked = desk::read_feel(body);
  if (!asked)
    return answer_error(message, 400, asked.error());
  const desk::Document &document = session_.document();
  if (asked->levels.size() != document.cells())
    return answer_error(message, 400, "expected " + std::to_string(document.cells()) + " levels");
  if (!may_write(message, asked->page))
    return;
  const tactile::TactileMap map = document.map({ .levels = asked->levels });
  feel_.feel(map, std::chrono::milliseconds(asked->duration), asked->page);
  soup_server_message_set_status(message, 204, nullptr);
}

void
Routes::events(SoupServerMessage *message, std::string_view)
{
  const std::string page = query_value(message, "page");
  if (!desk::is_name(page))
    return answer_error(message, 400, "expected page, a name of 1 to 64 letters and digits");
  seat_.listens(page);
  told_progress_ = progress_json();
  events_.add(message, page,
              Events::event("writer", writer_json()) + Events::event("revision", revision_json())
                  + Events::event("progress", told_progress_)
                  + Events::event("chair", chair_json()));
}

void
Routes::left(const std::string &page)
{
  const auto before = seat_.writer();
  if (!seat_.left(page))
    return;
  feel_.left(page);
  if (before != seat_.writer())
    events_.send(Events::event("writer", writer_json()));
}

void
Routes::tell_progress()
{
  std::string json = progress_json();
  if (json == told_progress_)
    return;
  told_progress_ = std::move(json);
  events_.send(Events::event("progress", told_progress_));
}

std::string
Routes::writer_json() const
{
  return "{\"writer\": " + (seat_.writer() ? write_text(*seat_.writer()) : "null") + "}";
}

std::string
Routes::revision_json() const
{
  return "{\"revision\": " + std::to_string(session_.revision())
         + ", \"saved\": " + std::to_string(session_.saved()) + "}";
}

std::string
Routes::progress_json() const
{
  const double strip = strip_.progress();
  const char *draft = draft_.track() ? "1" : draft_.failure().empty() ? "0" : "null";
  return std::string("{\"draft\": ") + draft
         + ", \"strip\": " + (strip < 0 ? "null" : number(std::floor(strip * 1000) / 1000)) + "}";
}

std::string
Routes::chair_json() const
{
  const Feel::State &state = feel_.state();
  return "{\"driver\": " + write_text(settings_.driver) + ", \"state\": " + write_text(state.state)
         + ", \"text\": " + write_text(state.text) + "}";
}

std::string
Routes::track_json() const
{
  const desk::Document &document = session_.document();
  return "\"name\": " + write_text(name_of(session_.path())) + ", \"grid\": ["
         + std::to_string(document.grid().rows) + ", " + std::to_string(document.grid().columns)
         + "], \"rate\": " + number(document.rate());
}

void
Routes::session(SoupServerMessage *message, std::string_view)
{
  const Film &film = settings_.found;
  const double duration
      = GST_CLOCK_TIME_IS_VALID(film.duration) ? static_cast<double>(film.duration) / 1e6 : 0;
  std::string messages;
  for (const std::string &text : session_.messages())
    messages += (messages.empty() ? "" : ", ") + write_text(text);
  answer_json(message,
              "{\"film\": {\"name\": " + write_text(name_of(settings_.film))
                  + ", \"duration\": " + std::to_string(std::llround(duration)) + ", \"width\": "
                  + std::to_string(film.width) + ", \"height\": " + std::to_string(film.height)
                  + ", \"frameDuration\": " + number(film.fps > 0 ? 1000 / film.fps : 0)
                  + ", \"sound\": " + (film.has_sound ? "true" : "false")
                  + ", \"type\": " + write_text(film.type) + "}, \"track\": {" + track_json()
                  + ", \"path\": " + write_text(session_.path())
                  + "}, \"revision\": " + std::to_string(session_.revision())
                  + ", \"saved\": " + std::to_string(session_.saved())
                  + ", \"writer\": " + (seat_.writer() ? write_text(*seat_.writer()) : "null")
                  + ", \"review\": " + (settings_.review ? "true" : "false")
                  + ", \"draft\": " + (draft_.track() ? "true" : "false")
                  + ", \"chair\": " + chair_json() + ", \"limits\": " + limits_json()
                  + ", \"messages\": [" + messages + "], \"version\": \"" PACKAGE_VERSION "\"}");
}

void
Routes::track(SoupServerMessage *message, std::string_view)
{
  std::string json = revision_json();
  json.pop_back();
  answer_json(message, json + ", \"cues\": " + desk::write_cues(session_.document().cues()) + "}");
}
