// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tactile {

/// Settings and version of a draft. They are in its file, after the grid:
///
///     NOTE tactile grid=3x3 rate=5 profile=tuned sound=off version=0.2.0 sum=af63dc4c8601ec8c
///
/// The sum is of all the file's other bytes, so that a change by anybody is seen.
struct DraftNote
{
  std::string made_with;     ///< the words before the sum, as far as there are any
  bool is_unchanged = false; ///< since it was made
};

/// The note in a file's text; none if the text does not have a grid.
std::optional<DraftNote> draft_note(std::string_view text);

/// A track's file with these words in place of its grid and rate, and the sum. Formats without a
/// grid stay as they are.
std::string with_draft_note(std::string text, std::string_view made_with);

} // namespace tactile
