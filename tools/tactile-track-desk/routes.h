// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "contents.h"
#include "feel.h"
#include "proxy.h"
#include "web/events.h"

#include "desk/seat.h"
#include "desk/session.h"
#include "web/site.h"

#include <libsoup/soup.h>

#include <string>
#include <string_view>

/// The film of the desk, its page and chair.
struct DeskSettings
{
  std::string film; ///< path
  Film found;
  std::string page; ///< folder
  std::string sink; ///< as on a launch line
  std::string driver;
  bool review = false;
};

/// Answers requests for the paths in docs/design/desk.md; the requests have been admitted. Main
/// context's thread.
class Routes : public Site
{
public:
  Routes(DeskSettings settings, desk::Session &session, const FilmContents &contents);
  ~Routes() override;
  Routes(const Routes &) = delete;
  Routes &operator=(const Routes &) = delete;

  std::string methods(const std::string &path) const override;
  goffset largest_body(const std::string &path) const override;
  void answer(SoupServerMessage *message, const std::string &path) override;

  /// As SessionWatch reports.
  void rest(bool rests, const std::string &why)
  {
    feel_.rest(rests, why);
  }

private:
  using Handler = void (Routes::*)(SoupServerMessage *, std::string_view body);
  struct Route
  {
    const char *path;
    const char *methods;
    Handler handler;
  };
  static const Route kRoutes[];

  // GET
  void session(SoupServerMessage *message, std::string_view body);
  void track(SoupServerMessage *message, std::string_view body);
  void draft(SoupServerMessage *message, std::string_view body);
  void events(SoupServerMessage *message, std::string_view body);
  void film(SoupServerMessage *message, std::string_view body);
  void proxy(SoupServerMessage *message, std::string_view body);
  void thumbnails(SoupServerMessage *message, std::string_view body);
  void thumbnail(SoupServerMessage *message, std::string_view body);
  void sound(SoupServerMessage *message, std::string_view body);
  void cuts(SoupServerMessage *message, std::string_view body);
  void export_track(SoupServerMessage *message, std::string_view body);
  void export_page(SoupServerMessage *message, std::string_view body);
  // POST
  void edits(SoupServerMessage *message, std::string_view body);
  void save(SoupServerMessage *message, std::string_view body);
  void operation(SoupServerMessage *message, std::string_view body);
  void writer(SoupServerMessage *message, std::string_view body);
  void position(SoupServerMessage *message, std::string_view body);
  void feel(SoupServerMessage *message, std::string_view body);

  bool may_write(SoupServerMessage *message, const std::string &page) const;
  void refuse(SoupServerMessage *message, const desk::Refusal &refusal) const;
  void left(const std::string &page);
  std::string track_json() const;
  std::string writer_json() const;
  std::string revision_json() const;
  std::string progress_json() const;
  std::string chair_json() const;
  void tell_progress();

  DeskSettings settings_;
  desk::Session &session_;
  desk::Seat seat_;
  Events events_;
  const FilmDraft &draft_;
  const Strip &strip_;
  Proxies proxies_;
  Feel feel_;
  std::string told_progress_;
  guint tick_;
};
