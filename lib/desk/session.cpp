// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/session.h"

#include "desk/files.h"

#include "files/whole_file.h"
#include "tracks/formats/track_file.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace fs = std::filesystem;

namespace desk {

namespace {

using files::Journal;

std::string
name_of(const EditMessage &message)
{
  return message.page + " " + message.edit;
}

std::string
edits(std::size_t count)
{
  return std::to_string(count) + (count == 1 ? " edit" : " edits");
}

/// Applies edits up to the first one that fails; returns their number.
std::size_t
replay(Document &document, const std::vector<std::string> &lines, std::string &last)
{
  std::size_t count = 0;
  for (const std::string &line : lines) {
    const auto edit = read_edit(line);
    if (!edit || !document.apply(edit->splices))
      break;
    last = name_of(*edit);
    count++;
  }
  return count;
}

/// An unused name beside the track.
std::string
free_name(const std::string &path)
{
  const fs::path whole(path);
  for (int number = 1;; number++) {
    fs::path name = whole;
    name.replace_filename(whole.stem().string() + ".recovered"
                          + (number > 1 ? "-" + std::to_string(number) : "")
                          + whole.extension().string());
    std::error_code ignored;
    if (!fs::exists(name, ignored))
      return name.string();
  }
}

/// From the first of these cues to the last.
Session::Span
span_of(std::initializer_list<const std::vector<Splice> *> all)
{
  Session::Span span{ .start = kLatest, .end = 0 };
  for (const std::vector<Splice> *splices : all)
    for (const Splice &splice : *splices)
      for (const Cue &cue : splice.insert)
        span = { .start = std::min(span.start, cue.start), .end = std::max(span.end, cue.end) };
  return span;
}

tl::unexpected<Refusal>
on_disk(std::string text)
{
  return tl::unexpected(Refusal{ .kind = Refusal::Kind::disk, .text = std::move(text) });
}

} // namespace

Session::Session(std::string path, std::string text, Document document, Journal journal)
    : path_(std::move(path)), text_(std::move(text)), document_(std::move(document)),
      journal_(std::move(journal))
{
}

Session::~Session()
{
  if (revision_ == saved_ && journal_.is_empty())
    journal_.remove();
}

tl::expected<std::unique_ptr<Session>, std::string>
Session::open(const std::string &path)
{
  std::error_code error;
  const std::string real = fs::canonical(path, error).string(); // a link is not replaced
  if (error)
    return tl::unexpected("'" + path + "': " + error.message());
  if (!real.ends_with(".vtt"))
    return tl::unexpected("'" + path
                          + "': expected a track in WebVTT (.vtt); make one with "
                            "tactile-track convert");
  auto text = files::read_whole(real, tactile::kMaxTrackFile);
  if (!text)
    return tl::unexpected(text.error());
  auto document = Document::read(*text);
  if (!document)
    return tl::unexpected(std::move(document.error()).within("'" + path + "'").text());
  auto journal = Journal::open(real + ".journal", kJournal);
  if (!journal)
    return tl::unexpected(journal.error());
  std::unique_ptr<Session> session(
      new Session(real, *std::move(text), *std::move(document), *std::move(journal)));
  if (const auto restored = session->restore(); !restored)
    return tl::unexpected(restored.error());
  return session;
}

tl::expected<void, std::string>
Session::restore()
{
  const auto content = journal_.read();
  if (!content)
    return tl::unexpected(content.error());
  if (content->damaged) {
    return journal_.set_aside().map([&](const std::string &name) {
      messages_.push_back("the journal is damaged; it was kept as '" + name + "'");
    });
  }
  if (content->entries.empty())
    return journal_.clear();
  if (content->base != text_)
    return recover(*content);
  const std::size_t count = replay(document_, content->entries, last_);
  revision_ = count;
  if (count > 0)
    messages_.push_back(edits(count) + " that had not been saved " + (count == 1 ? "was" : "were")
                        + " restored from the journal");
  if (count == content->entries.size())
    return {};
  // The edits after a damaged line are lost for the track, but stay in a file.
  return journal_.set_aside().and_then([&](const std::string &name) {
    messages_.push_back("the journal is damaged after " + edits(count) + "; it was kept as '" + name
                        + "'");
    tl::expected<void, std::string> written;
    for (std::size_t i = 0; i < count && written; i++)
      written = journal_.append(text_, content->entries[i]);
    return written;
  });
}

/// Keeps edits of the journal that are for another text, after a save that was cut off or another
/// program's work.
tl::expected<void, std::string>
Session::recover(const Journal::Content &content)
{
  auto document = Document::read(content.base);
  std::string last;
  const std::size_t count = document ? replay(*document, content.entries, last) : 0;
  if (count == content.entries.size() && document->text() == text_)
    return journal_.clear();
  if (count < content.entries.size()) {
    if (const auto name = journal_.set_aside(); name)
      messages_.push_back("the journal is damaged; it was kept as '" + *name + "'");
    else
      return tl::unexpected(name.error());
  }
  if (count > 0) {
    const std::string name = free_name(path_);
    const auto written = files::replace_file(name, document->text());
    if (!written)
      return tl::unexpected(written.error());
    if (!written->empty())
      messages_.push_back(*written);
    messages_.push_back("another program has changed the track since it was edited here; the "
                        "edited one is '"
                        + name + "'");
  }
  return journal_.clear();
}

tl::expected<Session::Span, Refusal>
Session::edit(const EditMessage &message)
{
  const std::string name = name_of(message);
  if (name == last_)
    return Span{};
  if (message.revision != revision_)
    return tl::unexpected(Refusal{
        .kind = Refusal::Kind::stale,
        .text = "expected an edit of revision " + std::to_string(revision_) + ", got one of "
                + std::to_string(message.revision) + "; load the track again" });
  const auto back = document_.apply(message.splices);
  if (!back)
    return tl::unexpected(Refusal{ .kind = Refusal::Kind::invalid, .text = back.error() });
  if (const auto written = journal_.append(text_, write_edit(message)); !written) {
    document_.apply(*back);
    return on_disk(written.error());
  }
  revision_++;
  last_ = name;
  return span_of({ &message.splices, &*back });
}

tl::expected<Session::Saved, Refusal>
Session::save(bool over)
{
  const auto there = files::read_whole(path_, tactile::kMaxTrackFile);
  if (revision_ == saved_ && there && *there == text_)
    return Saved{};
  std::string text = document_.text();
  auto document = Document::read(text);
  if (!document || document->cues() != document_.cues())
    return tl::unexpected(Refusal{ .kind = Refusal::Kind::invalid,
                                   .text = "the track would not be read as it is; nothing was "
                                           "saved, and the journal has all edits"
                                           + (document ? "" : ": " + document.error().text()) });
  std::error_code ignored;
  const bool is_known = there ? *there == text_ || *there == text : !fs::exists(path_, ignored);
  if (!is_known && !over)
    return tl::unexpected(Refusal{
        .kind = Refusal::Kind::changed,
        .text = "another program has changed '" + path_
                + "' since it was opened or saved here; expected the same file, or \"over\": its "
                  "text is kept as another version then" });
  auto kept = keep_version(path_, kMostVersions);
  if (!kept)
    return on_disk(kept.error());
  const auto written = files::replace_file(path_, text);
  if (!written)
    return on_disk(written.error());
  if (!written->empty())
    messages_.push_back(*written);
  text_ = std::move(text);
  document_ = *std::move(document);
  saved_ = revision_;
  // A journal that stays is known at the next start: its edits give the file that is there.
  if (const auto cleared = journal_.clear(); !cleared)
    messages_.push_back(cleared.error());
  return Saved{ .kept = *std::move(kept) };
}

} // namespace desk
