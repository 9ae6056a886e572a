// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contents.h"

#include "film/background.h"
#include "film/progress.h"
#include "translation.h"

#include <cmath>
#include <exception>
#include <stdexcept>

FilmContents::FilmContents(const Film &film, const std::string &path,
                           const AnalysisSettings &settings)
    : film_(film), settings_(settings), strip_(film, path), draft_(path, settings)
{
  if (strip_.glances() > 0)
    glance_ = std::make_unique<Glance>(
        film, strip_.width(), strip_.height(), strip_.glances(),
        Glance::Events{
            .taken = [this](gint64 ms, std::string jpeg) { strip_.glimpse(ms, std::move(jpeg)); },
            .done =
                [this] {
                  strip_.glanced();
                  read();
                } });
  else if (!strip_.is_whole() || !draft_.track())
    read();
}

void
FilmContents::read()
{
  try {
    part_ = std::make_unique<FilmPart>(
        film_, settings_, Span{},
        FilmPart::Events{ .analyzed
                          = [this](FilmMap map) -> tl::expected<void, tactile::FormatError> {
                           draft_.add(std::move(map)); // pictures go on
                           return {};
                         },
                          .finished =
                              [this](const std::string &failure) {
                                end(failure);
                              } },
        strip_.is_whole() ? "" : strip_.line(film_));
    if (draft_.track()) // the pictures alone are missing
      g_object_set(element(part_->pipeline(), "analysis").get(), "max-rate", 0.1, nullptr);
    run_in_background(part_->pipeline().get());
    if (!strip_.is_whole())
      strip_.listen(part_->pipeline());
    part_->start();
  } catch (const std::exception &error) {
    end(error.what());
  }
}

void
FilmContents::end(const std::string &failure)
{
  if (part_)
    part_->stop();
  strip_.end(failure);
  draft_.end(failure);
}

const tactile::Track &
FilmContents::wait_for_draft() const
{
  Progress progress;
  const auto show = [&] {
    if (part_ && progress.is_on_terminal() && GST_CLOCK_TIME_IS_VALID(film_.duration))
      progress.show(
          std::to_string(part_->done().count() * 100 / static_cast<gint64>(film_.duration + 1))
          + " %");
  };
  using Show = decltype(show);
  const guint tick = g_timeout_add(
      500,
      +[](gpointer data) -> gboolean {
        (*static_cast<Show *>(data))();
        return G_SOURCE_CONTINUE;
      },
      const_cast<void *>(static_cast<const void *>(&show)));
  while (!draft_.track() && draft_.failure().empty())
    g_main_context_iteration(nullptr, TRUE);
  g_source_remove(tick);
  if (!draft_.track())
    throw std::runtime_error(in_text("no draft could be authored: {}", draft_.failure()));
  return *draft_.track();
}
