// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_track.h"

#include "map_source.h"
#include "translation.h"

#include <ctime>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace fs = std::filesystem;
using follow::Time;

namespace {

/// The CPU time of all threads.
Time
cpu_time()
{
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

constexpr Time kLookEvery = std::chrono::seconds(1); ///< at a faulty track's file

/// The same again and again where there is none.
fs::file_time_type
changed_at(const std::string &folder)
{
  std::error_code error;
  return fs::last_write_time(folder, error);
}

std::string
uri_of(const std::string &path)
{
  g_autofree gchar *uri = gst_filename_to_uri(path.c_str(), nullptr);
  return uri != nullptr ? uri : "";
}

} // namespace

FilmTrack::FilmTrack(Settings settings, Events events)
    : settings_(std::move(settings)), events_(std::move(events)), library_(settings_.library),
      cache_(settings_.cache)
{
}

void
FilmTrack::open(const std::string &film, const std::shared_ptr<const tactile::Track> &known,
                std::optional<Time> length)
{
  probe_.reset();
  search_.reset();
  reader_.reset();
  what_.clear();
  fault_.clear();
  complaint_.clear();
  told_.clear();
  library_changed_ = changed_at(settings_.library);
  told_too_slow_ = false;
  film_ = film;
  path_ = film.empty() ? "" : library::local_path(film);
  events_.found(nullptr);
  if (film.empty())
    return;
  if (known) {
    choose("the track of its entry");
    events_.found(std::make_shared<tactile::Draft>(*known));
    return;
  }
  std::erase_if(passed_over_, [this](const std::string &path) { return has_changed(path); });
  file_ = { .complaint = "it is no file on this computer" };
  file_.duration = length;
  has_new_length_ = false;
  const auto beside = library_.beside(film, passed_over_, complaint_);
  probe();
  is_beside_ = beside.has_value();
  if (beside)
    play(*beside);
  else if (!probe_)
    look_in_library();
}

void
FilmTrack::take_length(Time length)
{
  if (film_.empty() || probe_ || file_.has_picture || file_.duration == length)
    return;
  file_.duration = length;
  has_new_length_ = true;
}

/// A track that is put into the library while its film plays is found, and a film whose length the
/// player reports late.
void
FilmTrack::look_again(Time now)
{
  if (film_.empty() || !what_.empty() || !fault_.empty() || is_looking()
      || now - looked_at_ < kLookEvery)
    return;
  looked_at_ = now;
  const auto changed = changed_at(settings_.library);
  const bool is_other = std::exchange(library_changed_, changed) != changed;
  if (std::exchange(has_new_length_, false) || is_other)
    look_in_library();
}

/// Also reports the film's 0:00, whatever its track.
void
FilmTrack::probe()
{
  std::error_code error;
  if (!fs::is_regular_file(path_, error)) // opening another kind of file may block
    return;
  try {
    probe_ = std::make_unique<FilmProbe>(uri_of(path_));
  } catch (const std::runtime_error &failure) {
    complaint_ = failure.what();
  }
}

void
FilmTrack::step(Time position, Time now)
{
  if (!fault_.empty() && now - looked_at_ >= kLookEvery) {
    looked_at_ = now;
    if (has_changed(faulty_)) {
      open(std::string(film_));
      return;
    }
  }
  look_again(now);
  if (probe_ && probe_->result()) {
    file_ = *std::exchange(probe_, nullptr)->result();
    events_.probed();
    if (!is_beside_)
      look_in_file();
  }
  if (search_ && search_->result())
    take(*std::exchange(search_, nullptr)->result());
  if (!reader_)
    return;
  const bool had_none = reader_->draft() == nullptr;
  reader_->step(position, now, cpu_time());
  if (had_none && reader_->draft() != nullptr)
    events_.found(reader_->draft());
  if (reader_->is_too_slow() && !std::exchange(told_too_slow_, true))
    events_.told("'" + library::film_name(film_)
                 + "' is decoded more slowly than it plays: parts of it are not felt;"
                   " tactile-track author makes its track beforehand");
  if (!reader_->failure().empty() && reader_->is_faulty())
    stop_at({ .path = path_,
              .fault = "'" + path_ + "': " + reader_->failure(),
              .version = library::file_version(path_) });
  else if (!reader_->failure().empty())
    fail(reader_->failure());
  else if (reader_->is_complete())
    complete();
}

std::optional<Time>
FilmTrack::known_until(Time position) const
{
  return reader_ ? std::optional(reader_->known_until(position)) : std::nullopt;
}

void
FilmTrack::choose(std::string what)
{
  what_ = std::move(what);
  events_.chosen();
}

void
FilmTrack::play(const library::FoundTrack &found)
{
  if (!found.fault.empty()) {
    stop_at(found);
    return;
  }
  choose("'" + found.path + "'");
  events_.found(std::make_shared<tactile::Draft>(found.track));
}

void
FilmTrack::stop_at(const library::FoundTrack &faulty)
{
  if (std::exchange(reader_, nullptr)) {
    what_.clear();
    events_.found(nullptr);
  }
  fault_ = faulty.fault;
  faulty_ = faulty.path;
  versions_[faulty.path] = faulty.version;
  events_.told("nothing is felt of '" + library::film_name(film_) + "': its track is faulty: "
               + fault_ + "; mend it, or pass it over with visuotactile-follow --pass-over");
}

/// Whether the file has changed since the faulty track was read.
bool
FilmTrack::has_changed(const std::string &path) const
{
  return library::file_version(path) != versions_.at(path);
}

void
FilmTrack::pass_over()
{
  if (fault_.empty())
    throw std::runtime_error(_("there is no faulty track to skip"));
  passed_over_.insert(faulty_);
  open(std::string(film_));
}

void
FilmTrack::look_in_file()
{
  reads_file_ = file_.may_have_track && !passed_over_.contains(path_);
  if (!reads_file_) {
    look_in_library();
    return;
  }
  try {
    read(open_embedded(path_, file_.start.stream), "the track in its file");
  } catch (const std::runtime_error &error) {
    fail(error.what());
  }
}

void
FilmTrack::look_in_library()
{
  search_ = std::make_unique<LibrarySearch>(library_, film_, file_.duration, passed_over_);
  if (search_->result())
    take(*std::exchange(search_, nullptr)->result());
}

void
FilmTrack::take(const LibrarySearch::Result &result)
{
  const auto &[found, complaints] = result;
  if (!complaints.library.empty())
    complaint_ = complaints.library;
  if (!found && !complaints.alike.empty())
    events_.told("a track that '" + library::film_name(film_)
                 + "' may have is faulty: " + complaints.alike);
  if (!found && library_.is_on_server() && !complaints.library.empty())
    events_.told("no track of the library can be used: " + complaints.library);
  if (found)
    play(*found);
  else if (settings_.makes_drafts && file_.has_picture)
    make_draft();
  else
    fail(settings_.makes_drafts ? file_.complaint : "");
}

void
FilmTrack::make_draft()
{
  analysis_ = settings_.analysis;
  if (!file_.has_sound)
    analysis_.sound = nullptr;
  if (const auto kept = cache_.find(path_, analysis_)) {
    choose("a draft of an earlier time");
    events_.found(std::make_shared<tactile::Draft>(*kept));
    return;
  }
  made_of_ = library::file_version(path_);
  try {
    read(open_analysis(uri_of(path_), file_.start.stream, analysis_),
         "a draft that is made while it plays");
  } catch (const std::runtime_error &error) {
    fail(error.what());
  }
}

void
FilmTrack::read(std::unique_ptr<follow::MapSource> source, const std::string &what)
{
  reader_ = std::make_unique<follow::AheadReader>(std::move(source));
  choose(what);
}

/// Ends reading: there is no track, or no more of it. The known part stays.
void
FilmTrack::fail(std::string why) // by value: it may be the reader's
{
  const bool has_some = reader_ && reader_->draft() != nullptr;
  reader_.reset();
  if (reads_file_ && !has_some) { // the probe has found one
    reads_file_ = false;
    complaint_ = std::move(why);
    look_in_library();
    return;
  }
  if (has_some) {
    events_.told("no more of '" + library::film_name(film_) + "' is felt: " + why);
    return;
  }
  what_.clear();
  std::string expected
      = complaint_.empty() ? library_.expected(film_) : "a track, got " + complaint_;
  if (!why.empty())
    expected += "; no draft can be made: " + why;
  const std::string text = "no track for '" + library::film_name(film_) + "': expected " + expected
                           + "; make one with tactile-track author";
  if (std::exchange(told_, text) != text)
    events_.told(text);
}

void
FilmTrack::complete()
{
  const follow::Time end = reader_->end();
  const std::shared_ptr<tactile::Draft> draft = reader_->draft();
  reader_.reset(); // what is felt stays
  if (reads_file_)
    return;
  what_ = "a whole draft";
  try {
    cache_.keep(draft->track(end, analysis_.rate), path_, made_of_, analysis_);
    events_.told("the draft of '" + library::film_name(film_)
                 + "' is complete, and kept for the next time");
  } catch (const std::runtime_error &error) {
    events_.told(std::string("the draft is complete, but not kept: ") + error.what());
  }
}
