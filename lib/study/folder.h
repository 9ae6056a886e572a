// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/participant.h"

#include "files/journal.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace study {

/// A folder with a study's file and its data. A function that adds data returns after the disk has
/// it. Errors are texts for the user. Not thread-safe.
class Folder
{
public:
  enum class Use
  {
    reads,
    writes, ///< one process at a time
  };
  static tl::expected<std::unique_ptr<Folder>, std::string> open(const std::string &path, Use use);

  /// Makes the folder and its files; none may be there.
  static tl::expected<void, std::string> make(const std::string &path, const std::string &film);

  const std::string &path() const
  {
    return path_;
  }
  /// The path of a file of data.
  std::string data(const std::string &name) const;
  /// The path of a film in the settings, relative to the folder.
  std::string film(const std::string &name) const;

  const Study &study() const ///< of the next participant
  {
    return study_;
  }
  const std::vector<std::unique_ptr<Participant>> &participants() const
  {
    return participants_;
  }
  /// Those whose journal cannot be read: name → why. Their numbers are not given again.
  const Settings &damaged() const
  {
    return damaged_;
  }
  Participant *find(const std::string &name) const;
  /// The participant whose session was cut off last; null: none.
  Participant *unfinished() const;
  std::vector<GivenPlace> given_places() const;

  /// Adds the next participant, at next_place().
  tl::expected<Participant *, std::string> start(const std::string &program);
  tl::expected<void, std::string> add(Participant &participant, const Event &event);
  /// The name for the trace of a session's next play, below the folder of data.
  tl::expected<std::string, std::string> next_trace(const Participant &participant, int session);
  /// Removes all data of a participant but the number.
  tl::expected<void, std::string> forget(const std::string &name);

private:
  Folder(std::string path, std::string text, Study study);
  tl::expected<void, std::string> read_participants();
  tl::expected<void, std::string> read_participant(const std::string &name);
  tl::expected<files::Journal *, std::string> journal(const std::string &name);

  std::string path_;
  std::string text_; ///< of the study
  Study study_;
  files::File lock_;
  std::vector<std::unique_ptr<Participant>> participants_;
  Settings damaged_;
  std::map<std::string, files::Journal> journals_; ///< open for writing
};

} // namespace study
