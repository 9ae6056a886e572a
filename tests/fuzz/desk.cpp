// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes what pages send to the desk, and tracks that it opens: an edit that is applied gives a
// track that is read again as it is, and can be taken back.
#include "desk/document.h"
#include "desk/messages.h"
#include "desk/operation.h"
#include "fuzz.h"
#include "tracks/formats/utf16.h"

#include <string_view>

namespace {

template <typename T>
bool
read(const desk::Read<T> &message)
{
  expect(message || !message.error().empty());
  return message.has_value();
}

void
edit(desk::Document document, const std::vector<desk::Splice> &splices)
{
  const std::string before = document.text();
  const auto back = document.apply(splices);
  expect(back || !back.error().empty());
  if (back) {
    const std::string text = document.text();
    const auto again = desk::Document::read(text);
    expect(again && again->cues() == document.cues() && again->text() == text);
    expect(again->track() == document.track());
    expect(document.apply(*back).has_value());
  }
  expect(document.text() == before);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  static const auto kDocument
      = desk::Document::read("WEBVTT\n\nNOTE tactile grid=1x2\n\nNOTE a\n\n00:01.000 --> "
                             "00:02.000\n 50  0\n\n00:02.000 --> "
                             "00:03.000\n  0 75\n");
  const std::string_view text(reinterpret_cast<const char *>(data), size);
  if (const auto message = desk::read_edit(text); read(message))
    edit(*kDocument, message->splices);
  if (const auto message = desk::read_operation(text); read(message)) {
    const auto splices = operate(*kDocument, nullptr, message->operation);
    expect(splices || !splices.error().empty());
    if (splices)
      edit(*kDocument, *splices);
  }
  read(desk::read_page(text));
  read(desk::read_position(text));
  read(desk::read_feel(text));
  if (const auto document = desk::Document::read(text)) {
    // What has not changed has its bytes.
    expect(document->text() == tactile::as_utf8(std::string(text)) || document->cues().empty());
    edit(*document, { { .at = 0, .remove = document->cues().size(), .insert = {} } });
    // A cue before all others, one after them, and one in the place of each.
    desk::Cue one{ .end = 1, .levels = std::vector<std::uint8_t>(document->cells(), 1) };
    if (document->cues().empty() || document->cues().front().start > 0)
      edit(*document, { { .at = 0, .remove = 0, .insert = { one } } });
    one.start = document->cues().empty() ? 0 : document->cues().back().end;
    one.end = one.start + 1;
    edit(*document, { { .at = document->cues().size(), .remove = 0, .insert = { one } } });
    for (std::size_t i = 0; i < document->cues().size() && i < 20; i++) {
      one = document->cues()[i];
      one.levels.front() = one.levels.front() == 1 ? 2 : 1;
      edit(*document, { { .at = i, .remove = 1, .insert = { one } } });
      one.notes.clear();
      edit(*document, { { .at = i, .remove = 1, .insert = { one } } });
      edit(*document, { { .at = i, .remove = 1, .insert = {} } });
    }
  }
  return 0;
}
