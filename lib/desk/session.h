// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "desk/document.h"
#include "desk/messages.h"

#include "files/journal.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace desk {

/// Why an edit or a save was refused.
struct Refusal
{
  enum class Kind
  {
    invalid, ///< it does not fit the track, or cues would overlap
    stale,   ///< it was made for another revision
    changed, ///< another program has changed the file
    disk,    ///< the file cannot be written now
  };
  Kind kind = Kind::invalid;
  std::string text;
};

/// The edits of a track that are not yet saved.
inline constexpr files::Journal::Kind kJournal
    = { .header = "visuotactile desk journal 1 ",
        .name = "the journal of edits",
        .in_use = "the track is open at another desk; close that one",
        .if_full = "save the track, which empties it" };

/// A track's file under edit: its content in memory, in the journal and on the disk. A refused call
/// changes nothing. Not thread-safe.
class Session
{
public:
  static constexpr int kMostVersions = 20;

  /// Opens a track in WebVTT, with the edits of its journal ("PATH.journal") if an earlier session
  /// was cut off. If the file has changed since, the edited track is written beside it. Fails with
  /// a text for the user.
  static tl::expected<std::unique_ptr<Session>, std::string> open(const std::string &path);

  /// Messages of open() for the user.
  const std::vector<std::string> &messages() const
  {
    return messages_;
  }
  const std::string &path() const
  {
    return path_;
  }
  const Document &document() const
  {
    return document_;
  }
  std::uint64_t revision() const
  {
    return revision_;
  }
  /// The revision in the file.
  std::uint64_t saved() const
  {
    return saved_;
  }

  /// The part of the track that an edit changed, in ms; none if the end is not after the start.
  struct Span
  {
    std::int32_t start = 0;
    std::int32_t end = 0;
  };
  /// Applies an edit, and returns after the disk has it. A repeated last edit changes nothing.
  tl::expected<Span, Refusal> edit(const EditMessage &message);

  struct Saved
  {
    std::string kept; ///< name of the version before; empty: there was none, or no change
  };
  /// Refuses to replace the work of another program since the file was opened or saved here, unless
  /// `over`.
  tl::expected<Saved, Refusal> save(bool over = false);

  /// Removes the journal if all is saved.
  ~Session();
  Session(const Session &) = delete;
  Session &operator=(const Session &) = delete;

private:
  Session(std::string path, std::string text, Document document, files::Journal journal);
  tl::expected<void, std::string> restore();
  tl::expected<void, std::string> recover(const files::Journal::Content &content);

  std::string path_;
  std::string text_; ///< of the file
  Document document_;
  files::Journal journal_;
  std::uint64_t revision_ = 0;
  std::uint64_t saved_ = 0;
  std::string last_; ///< page and name of the last edit
  std::vector<std::string> messages_;
};

} // namespace desk
