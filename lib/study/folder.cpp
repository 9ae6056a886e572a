// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/folder.h"

#include "files/whole_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>

#include <glib.h>

namespace fs = std::filesystem;

namespace study {

namespace {

constexpr const char *kFile = "study.ini";
constexpr const char *kEnding = ".journal";
constexpr files::Journal::Kind kJournal = { .header = "visuotactile study journal 1 ",
                                            .name = "the journal of a participant",
                                            .in_use = "the study runs already; close that one",
                                            .if_full = "drop the participant and start the next" };

tl::expected<void, std::string>
make_folder(const std::string &path)
{
  if (g_mkdir_with_parents(path.c_str(), 0700) != 0)
    return tl::unexpected(files::file_error(path));
  return {};
}

tl::expected<void, std::string>
write_new(const std::string &path, const std::string &text)
{
  std::error_code error;
  if (fs::exists(path, error))
    return tl::unexpected("'" + path + "' exists; expected a folder without it");
  return files::replace_file(path, text).map([](const std::string &) {});
}

} // namespace

Folder::Folder(std::string path, std::string text, Study study)
    : path_(std::move(path)), text_(std::move(text)), study_(std::move(study))
{
}

tl::expected<void, std::string>
Folder::make(const std::string &path, const std::string &film)
{
  return make_folder(path + "/films")
      .and_then([&] { return write_new(path + "/" + kFile, paper_study(film)); })
      .and_then([&] { return write_new(path + "/published.csv", kPaperResults); })
      .and_then([&] { return write_new(path + "/questionnaire.txt", kQuestionnaireForm); });
}

tl::expected<std::unique_ptr<Folder>, std::string>
Folder::open(const std::string &path, Use use)
{
  const std::string file = path + "/" + kFile;
  const auto text = files::read_whole(file, kMostText);
  if (!text)
    return tl::unexpected(text.error()
                          + "; expected a study's folder, which visuotactile-study new makes");
  auto whole = whole_study(*text, path);
  auto study = whole.and_then(read_study);
  if (!study)
    return tl::unexpected("'" + file + "': " + study.error());
  std::unique_ptr<Folder> folder(new Folder(path, *std::move(whole), *std::move(study)));
  if (use == Use::writes) {
    if (const auto made = make_folder(folder->data("")); !made)
      return tl::unexpected(made.error());
    const std::string lock = folder->data(".lock");
    folder->lock_ = files::File(::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
    if (!folder->lock_)
      return tl::unexpected(files::file_error(lock));
    if (flock(folder->lock_.descriptor(), LOCK_EX | LOCK_NB) != 0)
      return tl::unexpected("'" + path + "' is in use: " + kJournal.in_use);
  }
  if (const auto all = folder->read_participants(); !all)
    return tl::unexpected(all.error());
  return folder;
}

std::string
Folder::data(const std::string &name) const
{
  return path_ + "/data/" + name;
}

std::string
Folder::film(const std::string &name) const
{
  return g_path_is_absolute(name.c_str()) ? name : path_ + "/" + name;
}

tl::expected<void, std::string>
Folder::read_participants()
{
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(data(""), error), none; !error && entry != none;
       entry.increment(error))
    if (entry->path().extension() == kEnding)
      names.push_back(entry->path().stem().string());
  if (error && error != std::errc::no_such_file_or_directory) // Use::reads makes no folder
    return tl::unexpected("'" + data("") + "': " + error.message());
  std::ranges::sort(names);
  for (const std::string &name : names)
    if (const auto read = read_participant(name); !read)
      damaged_.emplace(name, read.error());
  return {};
}

tl::expected<void, std::string>
Folder::read_participant(const std::string &name)
{
  const auto content = files::Journal::peek(data(name + kEnding), kJournal);
  if (!content)
    return tl::unexpected(content.error());
  if (content->damaged)
    return tl::unexpected("'" + data(name + kEnding)
                          + "' is damaged; expected a journal of visuotactile-study");
  if (content->entries.empty())
    return {}; // the program ended before the participant began
  return Participant::read(name, content->base, content->entries)
      .map([&](std::unique_ptr<Participant> &&participant) {
        participants_.push_back(std::move(participant));
      });
}

Participant *
Folder::find(const std::string &name) const
{
  for (const auto &participant : participants_)
    if (participant->name() == name)
      return participant.get();
  return nullptr;
}

Participant *
Folder::unfinished() const
{
  Participant *last = nullptr;
  for (const auto &participant : participants_)
    if (participant->state() == Participant::State::running
        && (last == nullptr || participant->last_time() > last->last_time()))
      last = participant.get();
  return last;
}

std::vector<GivenPlace>
Folder::given_places() const
{
  std::vector<GivenPlace> given;
  for (const auto &participant : participants_)
    if (participant->state() != Participant::State::forgotten)
      given.push_back({ .place = participant->place(),
                        .is_free = participant->state() == Participant::State::dropped });
  return given;
}

tl::expected<files::Journal *, std::string>
Folder::journal(const std::string &name)
{
  const auto found = journals_.find(name);
  if (found != journals_.end())
    return &found->second;
  auto opened = files::Journal::open(data(name + kEnding), kJournal);
  if (!opened)
    return tl::unexpected(opened.error());
  if (const auto content = opened->read(); !content)
    return tl::unexpected(content.error());
  else if (content->damaged)
    return tl::unexpected("'" + data(name + kEnding) + "' is damaged");
  return &journals_.emplace(name, *std::move(opened)).first->second;
}

tl::expected<Participant *, std::string>
Folder::start(const std::string &program)
{
  int number = 1;
  const auto take = [&number](const std::string &name) {
    number = std::max(number, std::atoi(name.c_str() + 1) + 1);
  };
  for (const auto &participant : participants_)
    take(participant->name());
  for (const auto &[damaged, why] : damaged_)
    take(damaged);
  g_autofree gchar *name = g_strdup_printf("P%02d", number);
  const Place place = next_place(study_.groups().size(), study_.square(), given_places());
  const std::string line = Participant::start(place, program).line();
  auto participant = Participant::read(name, text_, { line });
  if (!participant)
    return tl::unexpected(participant.error());
  const auto written
      = journal(name).and_then([&](files::Journal *journal) -> tl::expected<void, std::string> {
          if (!journal->is_empty())
            return tl::unexpected("'" + data(std::string(name) + kEnding)
                                  + "' is there already; expected none of a new participant. Start "
                                    "visuotactile-study run again");
          return journal->append(text_, line);
        });
  if (!written)
    return tl::unexpected(written.error());
  participants_.push_back(*std::move(participant));
  return participants_.back().get();
}

tl::expected<void, std::string>
Folder::add(Participant &participant, const Event &event)
{
  // Only an event that fits is written, and only a written one is kept in memory.
  const std::string line = event.line();
  return participant.fits(line)
      .and_then([&] { return journal(participant.name()); })
      .and_then([&](files::Journal *journal) { return journal->append("", line); })
      .and_then([&] { return participant.apply(line); })
      .map([&] {
        if (participant.state() != Participant::State::running)
          journals_.erase(participant.name()); // hundreds of them would be too many open files
      });
}

tl::expected<std::string, std::string>
Folder::next_trace(const Participant &participant, int session)
{
  const std::string name = participant.name() + "/" + std::to_string(session) + "."
                           + std::to_string(participant.plays_of(session).size() + 1) + ".csv";
  return make_folder(data(participant.name())).map([&] { return name; });
}

tl::expected<void, std::string>
Folder::forget(const std::string &name)
{
  if (find(name) == nullptr && !damaged_.contains(name))
    return tl::unexpected("there is no participant '" + name + "'");
  const std::string line = Event("forgotten").line();
  auto forgotten = Participant::read(name, text_, { line });
  if (!forgotten)
    return tl::unexpected(forgotten.error());
  // Traces first: as long as the journal has the participant, the next try finds the rest.
  std::error_code error;
  fs::remove_all(data(name), error);
  if (error)
    return tl::unexpected("'" + data(name) + "': " + error.message());
  journals_.erase(name); // its lock, too
  auto journal = files::Journal::open(data(name + kEnding), kJournal);
  const auto written
      = journal.and_then([&](files::Journal &journal) { return journal.replace(text_, line); });
  if (!written)
    return written;
  damaged_.erase(name);
  const auto old = std::ranges::find(participants_, name, &Participant::name);
  if (old != participants_.end())
    *old = *std::move(forgotten);
  else
    participants_.push_back(*std::move(forgotten));
  return {};
}

} // namespace study
