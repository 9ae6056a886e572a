// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "desk/cue.h"
#include "tracks/formats/track_file.h"
#include "tracks/formats/webvtt_text.h"
#include "tracks/text_cue.h"
#include "tracks/track.h"

#include <string>
#include <vector>

namespace desk {

/// A track under edit: the text of its file, and its present cues. A value type.
class Document
{
public:
  /// Fails if the text is no WebVTT track in UTF-8 or UTF-16, which is saved as UTF-8, or has over
  /// kMostCues cues. Edits that would make it larger than `most` bytes are refused.
  static tl::expected<Document, tactile::FormatError>
  read(std::string_view bytes, std::size_t most = tactile::kMaxTrackFile);

  const tactile::Grid &grid() const
  {
    return grid_;
  }
  /// Maps per second for which the track was authored; 0: unknown.
  double rate() const
  {
    return rate_;
  }
  std::size_t cells() const
  {
    return static_cast<std::size_t>(grid_.rows) * static_cast<std::size_t>(grid_.columns);
  }
  /// In order of time; they do not overlap.
  const std::vector<Cue> &cues() const
  {
    return cues_;
  }

  /// Applies all splices in order and returns those that undo them, or applies none and returns the
  /// error. The time grows with the cues between one splice and the next, which is limited: any
  /// number of splices fits in their order.
  tl::expected<std::vector<Splice>, std::string> apply(const std::vector<Splice> &splices);

  /// The file with the present cues.
  std::string text() const;

  /// The levels of a cue that fits.
  tactile::TactileMap map(const Cue &cue) const;

  /// The track with the present cues.
  tactile::Track track() const;

private:
  Document(tactile::WebvttText text, const tactile::Grid &grid, double rate, std::size_t size,
           std::size_t most);
  tl::expected<void, std::string> check(const Cue &cue) const;
  tl::expected<void, std::string> check_order() const;
  tl::expected<void, std::string> check_size(std::size_t &size) const;

  tactile::WebvttText text_;
  tactile::Grid grid_;
  double rate_;
  std::vector<Cue> cues_;
  std::size_t most_;
  std::size_t size_; ///< an upper bound for the file
};

} // namespace desk
