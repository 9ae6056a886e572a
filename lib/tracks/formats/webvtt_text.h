// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/formats/webvtt_cues.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// The text of a WebVTT track in pieces, each with its bytes in the file: unchanged pieces are
/// written with them. So a file that is saved differs where it was edited and nowhere else. Copies
/// share the text.
///
/// A changed cue keeps the identifier and settings of the one that began at its time, or else of
/// the first that it overlaps. Other blocks than notes, such as styles, regions and remarks, stay
/// where they are, even if their cue is gone.
class WebvttText
{
public:
  /// `text` is a track that read_webvtt() reads, of this grid.
  WebvttText(std::string text, const Grid &grid);

  /// In order of time.
  std::vector<WebvttCue> cues() const;

  /// The file with other cues, in order of time. "NOTE tactile" and the grid are added where there
  /// is neither cue nor note.
  std::string with(const std::vector<WebvttCue> &cues, double rate) const;

  /// The file with a track that was made of it, perhaps with another grid, and moved by `offset`.
  /// Cues that are before 0 then are gone with their notes.
  std::string with(const Track &track, Time offset) const;

private:
  struct Piece
  {
    WebvttCue cue;
    std::string_view lead;  ///< empty lines before it
    std::string_view front; ///< notes and other blocks, up to the cue
    std::string kept;       ///< blocks that are no notes, each with an empty line after it
    bool has_note_before_kept = false;
    std::string_view identifier;  ///< its line
    std::string_view timing;      ///< its line
    std::string_view after_times; ///< settings and what is around them, of that line
    std::string_view picture;
  };
  class Builder;
  friend class Builder;

  void read_pieces();
  void read_cue(const struct WebvttBlock &block, Piece &piece) const;
  std::vector<const Piece *> origins(const std::vector<WebvttCue> &cues) const;

  std::shared_ptr<const std::string> text_;
  Grid grid_;
  std::string_view header_;
  std::vector<Piece> pieces_; ///< in order of time
  std::string_view tail_;
  std::string line_end_ = "\n";
  bool has_grid_note_ = false;   ///< so that it needs no cue
  bool header_has_grid_ = false; ///< else the first cue gives it
  bool is_moved_ = false;        ///< lines of times do not stay
  bool is_resampled_ = false;    ///< nor do pictures
};

} // namespace tactile
