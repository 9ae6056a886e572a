// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stored_track.h"

#include "film/command_line.h"
#include "film/or_throw.h"
#include "library/library.h"
#include "tracks/formats/webvtt.h"
#include "tracks/track_edit.h"

#include <glib/gstdio.h>

#include <stdexcept>
#include <utility>

std::optional<StoredTrack>
StoredTrack::find(const Film &film, const std::string &tracks)
{
  const library::Library library(tracks);
  library::Library::Complaints complaints;
  const auto duration = GST_CLOCK_TIME_IS_VALID(film.duration)
                            ? std::optional(tactile::Time(static_cast<gint64>(film.duration)))
                            : std::nullopt;
  std::string subtitles;
  auto found = library.beside(film.uri, {}, subtitles);
  if (!found)
    found = library.stored(film.uri, duration, {}, complaints);
  if (!found) {
    for (const std::string &complaint : { subtitles, complaints.library, complaints.alike })
      if (!complaint.empty())
        print_error("visuotactile-play", complaint);
    return std::nullopt;
  }
  if (!found->fault.empty())
    throw std::runtime_error(found->fault);
  const std::string text = tactile::write_webvtt(or_throw(shift(found->track, film.start.stream)));
  g_autofree gchar *name = nullptr;
  g_autoptr(GError) error = nullptr;
  const int file = g_file_open_tmp("visuotactile-XXXXXX.vtt", &name, &error);
  if (file < 0)
    throw std::runtime_error(error->message);
  g_close(file, nullptr);
  StoredTrack stored(name, std::move(found->path));
  if (!g_file_set_contents(name, text.data(), static_cast<gssize>(text.size()), &error))
    throw std::runtime_error(error->message);
  return stored;
}

StoredTrack::StoredTrack(std::string path, std::string source)
    : path_(std::move(path)), source_(std::move(source))
{
}

StoredTrack::StoredTrack(StoredTrack &&other) noexcept
    : path_(std::exchange(other.path_, {})), source_(std::move(other.source_))
{
}

StoredTrack::~StoredTrack()
{
  if (!path_.empty())
    g_unlink(path_.c_str());
}

const std::string &
StoredTrack::path() const
{
  return path_;
}

const std::string &
StoredTrack::source() const
{
  return source_;
}
