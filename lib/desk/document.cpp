// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/document.h"

#include "tracks/formats/utf16.h"
#include "tracks/formats/webvtt.h"

#include <glib.h>

#include <algorithm>
#include <utility>

namespace desk {

namespace {

using Applied = tl::expected<void, std::string>;

tl::unexpected<std::string>
refused(std::string reason)
{
  return tl::unexpected(std::move(reason));
}

std::string
times_of(const Cue &cue)
{
  return std::to_string(cue.start) + " to " + std::to_string(cue.end) + " ms";
}

/// Applies splices in a row. Cues move between the part before the place of a splice and the part
/// after it, so that a splice near the last one costs little, whatever the number of cues.
class Splicing
{
public:
  explicit Splicing(std::vector<Cue> &cues) : before_(cues)
  {
  }
  ~Splicing()
  {
    go_to(size());
  }
  Splicing(const Splicing &) = delete;
  Splicing &operator=(const Splicing &) = delete;

  std::size_t size() const
  {
    return before_.size() + after_.size();
  }
  /// How many cues have been moved.
  std::size_t steps() const
  {
    return steps_;
  }

  /// Applies a splice that fits, and returns the one that takes it back.
  Splice operator()(const Splice &splice)
  {
    Splice back{ .at = splice.at, .remove = splice.insert.size(), .insert = {} };
    go_to(splice.at);
    back.insert.reserve(splice.remove);
    for (std::size_t i = 0; i < splice.remove; i++)
      back.insert.push_back(take(after_));
    before_.insert(before_.end(), splice.insert.begin(), splice.insert.end());
    return back;
  }

private:
  static Cue take(std::vector<Cue> &cues)
  {
    Cue cue = std::move(cues.back());
    cues.pop_back();
    return cue;
  }

  void go_to(std::size_t at)
  {
    for (; before_.size() > at; steps_++)
      after_.push_back(take(before_));
    for (; before_.size() < at; steps_++)
      before_.push_back(take(after_));
  }

  std::vector<Cue> &before_;
  std::vector<Cue> after_; ///< the last first
  std::size_t steps_ = 0;
};

/// Upper bound for the size of a cue in a file.
std::size_t
size_in_file(const Cue &cue)
{
  constexpr std::size_t kTimes = 64; // and a frequency
  constexpr std::size_t kLevel = 6;  // "100%" and a line end
  constexpr std::size_t kNote = 16;  // "NOTE" and line ends
  std::size_t size = kTimes + kLevel * cue.levels.size();
  for (const std::string &note : cue.notes)
    size += kNote + 2 * note.size(); // each \n may become \r\n
  return size;
}

} // namespace

Document::Document(tactile::WebvttText text, const tactile::Grid &grid, double rate,
                   std::size_t size, std::size_t most)
    : text_(std::move(text)), grid_(grid), rate_(rate), cues_(text_.cues()), most_(most),
      size_(size)
{
}

tl::expected<Document, tactile::FormatError>
Document::read(std::string_view bytes, std::size_t most)
{
  std::string text = tactile::as_utf8(std::string(bytes));
  if (!g_utf8_validate(text.data(), static_cast<gssize>(text.size()), nullptr))
    return tl::unexpected(tactile::FormatError{
        .place = {}, .reason = "expected UTF-8; save it as that in a text editor" });
  const auto track = tactile::read_webvtt(text);
  if (!track)
    return tl::unexpected(track.error());
  const tactile::Grid grid{ track->rows(), track->columns() };
  Document document(tactile::WebvttText(text, grid), grid, track->rate(), text.size(), most);
  if (document.cues_.size() > kMostCues)
    return tl::unexpected(
        tactile::FormatError{ .place = {},
                              .reason = "expected at most " + std::to_string(kMostCues)
                                        + " cues, got " + std::to_string(document.cues_.size())
                                        + "; tactile-track edit --merge=5 makes fewer" });
  Applied checked = document.check_order();
  for (std::size_t i = 0; i < document.cues_.size() && checked; i++)
    if (checked = document.check(document.cues_[i]); !checked)
      checked = refused("the cue from " + times_of(document.cues_[i]) + ": " + checked.error());
  if (!checked)
    return tl::unexpected(tactile::FormatError{ .place = {}, .reason = checked.error() });
  return document;
}

Applied
Document::check(const Cue &cue) const
{
  if (cue.start < 0 || cue.end <= cue.start || cue.end > kLatest)
    return refused("expected a cue with 0 <= start < end <= " + std::to_string(kLatest)
                   + " ms, got one from " + times_of(cue));
  if (cue.levels.size() != cells())
    return refused("expected " + std::to_string(cells()) + " levels in a cue, got "
                   + std::to_string(cue.levels.size()));
  if (std::ranges::any_of(cue.levels, [](int level) { return level > kMostPercent; }))
    return refused("expected levels from 0 to 100");
  if (cue.frequency < 0 || cue.frequency > tactile::kHighestFrequency)
    return refused("expected a frequency from 0 to 1000 Hz");
  if (cue.notes.size() > tactile::kMostWebvttNotes
      || !std::ranges::all_of(cue.notes, tactile::is_webvtt_note))
    return refused("expected at most " + std::to_string(tactile::kMostWebvttNotes) + " notes of "
                   + std::to_string(tactile::kLongestWebvttNote)
                   + " bytes, without empty lines and -->, that do not begin with 'tactile'");
  return {};
}

Applied
Document::check_order() const
{
  if (cues_.size() > kMostCues || (2 * cues_.size() + 1) * cells() > tactile::Track::kMaxLevels)
    return refused("the track is full: it has " + std::to_string(cues_.size()) + " cues");
  for (std::size_t i = 1; i < cues_.size(); i++)
    if (cues_[i].start < cues_[i - 1].end)
      return refused("the cue from " + times_of(cues_[i]) + " would overlap the one from "
                     + times_of(cues_[i - 1]));
  return {};
}

/// Computes the exact size if the bound may be too large.
Applied
Document::check_size(std::size_t &size) const
{
  if (size > most_)
    size = text().size();
  if (size <= most_)
    return {};
  return refused("the track would have " + std::to_string(size) + " bytes, more than the "
                 + std::to_string(most_) + " that are read again");
}

tl::expected<std::vector<Splice>, std::string>
Document::apply(const std::vector<Splice> &splices)
{
  constexpr std::size_t kMostSteps = 100 * kMostCues;
  Applied applied;
  std::vector<Splice> back; // the last first
  std::size_t size = size_;
  {
    Splicing splicing(cues_);
    for (const Splice &splice : splices) {
      if (splice.at > splicing.size() || splice.remove > splicing.size() - splice.at)
        applied = refused("expected a splice within " + std::to_string(splicing.size())
                          + " cues, got one at " + std::to_string(splice.at) + " that removes "
                          + std::to_string(splice.remove));
      else if (splicing.steps() > kMostSteps)
        applied = refused("expected splices in the order of their cues, got "
                          + std::to_string(splices.size()) + " far from each other");
      for (const Cue &cue : splice.insert) {
        if (applied)
          applied = check(cue);
        size += size_in_file(cue);
      }
      if (!applied)
        break;
      back.push_back(splicing(splice));
    }
  }
  std::ranges::reverse(back);
  if (applied)
    applied = check_order();
  if (applied)
    applied = check_size(size);
  if (applied) {
    size_ = size;
    return back;
  }
  Splicing splicing(cues_);
  for (const Splice &splice : back)
    splicing(splice);
  return tl::unexpected(applied.error());
}

std::string
Document::text() const
{
  return text_.with(cues_, rate_);
}

tactile::TactileMap
Document::map(const Cue &cue) const
{
  return tactile::map_of(cue, grid_);
}

tactile::Track
Document::track() const
{
  // Cannot fail: cues are in order, and check_order() keeps the limits.
  tactile::Track track(grid_.rows, grid_.columns);
  track.set_rate(rate_);
  const tactile::TactileMap silent(grid_.rows, grid_.columns);
  for (const Cue &cue : cues_) {
    (void)track.append(std::chrono::milliseconds(cue.start), map(cue));
    (void)track.append(std::chrono::milliseconds(cue.end), silent);
  }
  (void)track.set_end(std::chrono::milliseconds(cues_.empty() ? 0 : cues_.back().end));
  return track;
}

} // namespace desk
