// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "desk/cue.h"
#include "tracks/text_cue.h"

#include <string>
#include <string_view>
#include <vector>

namespace desk {

/// Whether a note can stand in a file in front of a cue and be read again as it is.
bool is_note(std::string_view note);

/// The text of a WebVTT track in pieces, each with the bytes it has in the file. A cue that has not
/// changed is written with them, so that a saved file differs where it was edited and nowhere else.
class TrackText
{
public:
  /// `text` is a track that tactile::read_webvtt() reads, of this grid.
  TrackText(std::string_view text, const tactile::Grid &grid);

  /// In order of time.
  std::vector<Cue> cues() const;

  /// Whether the file says its grid, so that it needs no cue.
  bool has_grid_note() const
  {
    return has_grid_note_;
  }

  /// The file with other cues, in order of time. A changed cue keeps identifier and settings of the
  /// one that began at its time. What is no note stays where it is, even if its cue is gone.
  /// `grid_note` ("tactile grid=3x3") is added where there is neither cue nor note.
  std::string with(const std::vector<Cue> &cues, const std::string &grid_note) const;

private:
  struct Block;
  struct Piece
  {
    Cue cue;
    std::string lead; ///< empty lines before it
    std::string text;
    std::string kept; ///< blocks that are no notes, each with an empty line after it
    bool has_note_before_kept = false;
    std::string identifier;
    std::string settings;
  };

  static std::vector<Block> blocks_of(std::string_view text, std::string &tail);
  void read_cue(const Block &block, Piece &piece) const;
  std::string written(const Cue &cue, const Piece *before) const;

  tactile::Grid grid_;
  std::string header_;
  std::vector<Piece> pieces_; ///< in order of time
  std::string tail_;
  std::string line_end_ = "\n";
  bool has_grid_note_ = false;
  bool header_has_grid_ = false; ///< else the first cue gives it
};

} // namespace desk
