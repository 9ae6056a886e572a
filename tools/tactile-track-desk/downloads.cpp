// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Requests that change nothing: the page's files, film, strip, draft, exports.
#include "routes.h"

#include "web/sent_file.h"
#include "web/soup.h"

#include "files/whole_file.h"
#include "tracks/formats/track_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>

namespace {

constexpr std::size_t kLargestPage = std::size_t{ 8 } << 20;

using desk::write_text;

std::string
stem_of(const std::string &path)
{
  return std::filesystem::path(path).stem().string();
}

std::string
read_file(const std::string &path)
{
  return files::read_whole(path, kLargestPage).value_or("");
}

/// A script of the page and the modules that it imports, as one; empty if one is missing.
std::string
read_script(const std::string &folder, const std::string &name)
{
  constexpr std::string_view kFrom = " from './";
  constexpr std::string_view kExport = "export ";
  std::string modules;
  std::string own;
  std::istringstream lines(read_file(folder + "/" + name));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t from = line.find(kFrom);
    if (!line.starts_with("import ") || from == std::string::npos) {
      own += line.substr(line.starts_with(kExport) ? kExport.size() : 0) + "\n";
      continue;
    }
    const std::size_t begin = from + kFrom.size();
    const std::string module = read_script(folder, line.substr(begin, line.rfind('\'') - begin));
    if (module.empty())
      return "";
    modules += module;
  }
  return own.empty() ? "" : modules + own;
}

/// As a Content-Security-Policy names the content of an element.
std::string
hash_of(const std::string &content)
{
  std::array<guint8, 32> digest{};
  gsize size = digest.size();
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  g_checksum_update(sum, reinterpret_cast<const guchar *>(content.data()),
                    static_cast<gssize>(content.size()));
  g_checksum_get_digest(sum, digest.data(), &size);
  g_autofree gchar *text = g_base64_encode(digest.data(), size);
  return std::string("'sha256-") + text + "'";
}

/// False if `text` has no `place`.
bool
replace(std::string &text, std::string_view place, const std::string &by)
{
  const std::size_t at = text.find(place);
  if (at != std::string::npos)
    text.replace(at, place.size(), by);
  return at != std::string::npos;
}

} // namespace

void
Routes::draft(SoupServerMessage *message, std::string_view)
{
  if (!draft_.track())
    return answer_error(message, 404,
                        !draft_.failure().empty()
                            ? "no draft could be authored"
                            : "the draft is being authored; wait for progress");
  const auto document = desk::Document::read(
      tactile::write_track(*draft_.track(), tactile::TrackFormat::webvtt, ""));
  if (!document)
    return answer_error(message, 500, document.error().text());
  answer_json(message, "{\"cues\": " + desk::write_cues(document->cues()) + "}");
}

void
Routes::film(SoupServerMessage *message, std::string_view)
{
  const std::string type = settings_.found.type.substr(0, settings_.found.type.find(';'));
  answer_file(message, settings_.film, type.empty() ? "application/octet-stream" : type.c_str());
}

void
Routes::proxy(SoupServerMessage *message, std::string_view)
{
  const std::string text = query_value(message, "from");
  const double from = text.empty() ? 0 : g_ascii_strtod(text.c_str(), nullptr);
  if (!(from >= 0 && from <= desk::kLatest / 1000))
    return answer_error(message, 400, "expected from, in seconds");
  proxies_.answer(message, static_cast<GstClockTime>(from * GST_SECOND));
}

void
Routes::thumbnails(SoupServerMessage *message, std::string_view)
{
  answer_json(message, "{\"interval\": " + std::to_string(strip_.interval())
                           + ", \"width\": " + std::to_string(strip_.width())
                           + ", \"height\": " + std::to_string(strip_.height())
                           + ", \"count\": " + std::to_string(strip_.shown())
                           + ", \"final\": " + std::to_string(strip_.count())
                           + ", \"total\": " + std::to_string(strip_.total()) + "}");
}

void
Routes::thumbnail(SoupServerMessage *message, std::string_view)
{
  const gint64 index = query_number(message, "index", -1);
  const std::string jpeg = index >= 0 ? strip_.picture(static_cast<std::size_t>(index)) : "";
  if (jpeg.empty())
    return answer_error(message, 404, "this picture is not there, or not yet");
  ::answer(message, 200, "image/jpeg", jpeg);
}

void
Routes::sound(SoupServerMessage *message, std::string_view)
{
  const gint64 from = query_number(message, "from", 0);
  if (from < 0)
    return answer_error(message, 400, "expected from, a whole number from 0 on");
  ::answer(message, 200, "application/octet-stream", strip_.peaks(static_cast<std::size_t>(from)));
}

void
Routes::cuts(SoupServerMessage *message, std::string_view)
{
  const auto list = [](const std::vector<gint64> &times) {
    std::string text;
    for (const gint64 time : times)
      text += (text.empty() ? "" : ", ") + std::to_string(time);
    return "[" + text + "]";
  };
  const Strip::Events events = strip_.events();
  answer_json(message, "{\"cuts\": " + list(events.cuts)
                           + ", \"until\": " + std::to_string(events.until)
                           + ", \"impacts\": " + list(events.impacts) + "}");
}

void
Routes::export_track(SoupServerMessage *message, std::string_view)
{
  const std::string format = query_value(message, "format");
  const auto known = tactile::written_format("track." + format);
  if (!known)
    return answer_error(message, 400, "format: " + known.error().reason);
  const desk::Document &document = session_.document();
  g_autoptr(GDateTime) now = g_date_time_new_now_utc();
  g_autofree gchar *date = g_date_time_format(now, "%Y-%m-%dT%H:%M:%S+00:00");
  const bool is_vtt = *known == tactile::TrackFormat::webvtt; // with comments
  name_attachment(message, stem_of(session_.path()) + "." + format);
  ::answer(message, 200, is_vtt ? "text/vtt; charset=utf-8" : "application/octet-stream",
           is_vtt ? document.text() : write_track(document.track(), *known, date));
}

/// One file that needs no other: film_page.html with its style, its script, film and track. Its
/// policy allows only these, by their hashes.
void
Routes::export_page(SoupServerMessage *message, std::string_view)
{
  const std::string name = std::filesystem::path(settings_.film).filename().string();
  g_autofree gchar *link = g_uri_escape_string(name.c_str(), nullptr, FALSE);
  std::string data = "{\"film\": {\"name\": " + write_text(name) + ", \"href\": " + write_text(link)
                     + "}, \"track\": {" + track_json()
                     + ", \"cues\": " + desk::write_cues(session_.document().cues()) + "}}";
  // It stands in a script element, which "</script" would end.
  for (std::size_t at = 0; (at = data.find('<', at)) != std::string::npos;)
    data.replace(at, 1, "\\u003c");
  std::string page = read_file(settings_.page + "/film_page.html");
  const std::string style = read_file(settings_.page + "/film_page.css");
  const std::string script = read_script(settings_.page, "film_page.js");
  if (style.empty() || script.empty() || !replace(page, "@SCRIPT_HASH@", hash_of(script))
      || !replace(page, "@SCRIPT@", script) || !replace(page, "@STYLE_HASH@", hash_of(style))
      || !replace(page, "@STYLE@", style) || !replace(page, "@DATA@", data))
    return answer_error(message, 404, "the page has no template for exports");
  name_attachment(message, stem_of(session_.path()) + ".html");
  ::answer(message, 200, "text/html; charset=utf-8", page);
}
