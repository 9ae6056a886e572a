// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/document.h"

#include "track_samples.h"

#include "desk/messages.h"
#include "desk/operation.h"
#include "tracks/formats/webvtt.h"
#include "tracks/formats/webvtt_timing.h"
#include "tracks/track_edit.h"

#include <algorithm>
#include <random>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using desk::Cue;
using desk::Document;
using desk::Splice;

namespace {

Document
document_of(std::string_view text)
{
  auto document = Document::read(text);
  fail_unless(document.has_value(), "%s", document ? "" : document.error().text().c_str());
  return *std::move(document);
}

Cue
cue(int start, int end, std::vector<std::uint8_t> levels, std::vector<std::string> notes = {})
{
  return { .start = start, .end = end, .levels = std::move(levels), .notes = std::move(notes) };
}

/// Splices that fit a document, at random: cues are removed, and others added in their place.
std::vector<Splice>
random_splices(std::mt19937 &random, std::vector<Cue> cues, std::size_t cells)
{
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random() % n);
  };
  std::vector<Splice> splices;
  for (std::size_t turn = 0; turn <= below(3); turn++) {
    const std::size_t at = below(cues.size() + 1);
    const std::size_t remove = std::min(below(3), cues.size() - at);
    const int from = at > 0 ? cues[at - 1].end : 0;
    const int to = at + remove < cues.size() ? cues[at + remove].start : from + 5000;
    Splice splice{ .at = at, .remove = remove, .insert = {} };
    for (int time = from; time + 10 < to && splice.insert.size() < 3;) {
      const int start = time + static_cast<int>(below(3)) * (to - time) / 8;
      const int end
          = start + 1 + static_cast<int>(below(static_cast<std::size_t>((to - start) / 2)));
      Cue one = cue(start, end, std::vector<std::uint8_t>(cells));
      for (auto &level : one.levels)
        level = static_cast<std::uint8_t>(below(2) * below(101));
      if (below(4) == 0)
        one.notes = { "a note", "of two\nlines " };
      splice.insert.push_back(one);
      time = end;
    }
    cues.erase(cues.begin() + static_cast<std::ptrdiff_t>(at),
               cues.begin() + static_cast<std::ptrdiff_t>(at + remove));
    cues.insert(cues.begin() + static_cast<std::ptrdiff_t>(at), splice.insert.begin(),
                splice.insert.end());
    splices.push_back(std::move(splice));
  }
  return splices;
}

} // namespace

CHECK_TEST(test_bytes_stay)
{
  const char *files[] = {
    "WEBVTT\n\nNOTE tactile grid=1x2\n\n00:01.000 --> 00:02.000\n1 2\n",
    "\xef\xbb\xbfWEBVTT - title\r\n\r\n7\r\n00:01.000 --> 00:02.000 line:0\r\n1 2\r\n\r\n\r\n",
    "WEBVTT\nKind: metadata\n\nSTYLE\n::cue { }\n\nNOTE mine\n\n\n\n00:01.000 --> "
    "00:02.000\n1.5%\t2\n\nNOTE the end\n",
    "WEBVTT\r\r00:01.000 --> 00:02.000\r1 2\r\r00:02.000 --> 00:03.000\r1 2",
    "WEBVTT\n\nNOTE tactile grid=1x2\n\nNOTE tactile rate=5\n\nNOTE\n\nNOTE a\nb\n\n00:01.000 --> "
    "00:02.000\n1 2\n\nNOTE tactile\n\n8\n00:05.000 --> 00:06.000\n1 2\n",
    "WEBVTT\n\nNOTE tactile grid=1x2",
    // A note that the standard does not allow.
    "WEBVTT\n\nNOTE 1 --> 2\n1 2\n\n00:01.000 --> 00:02.000\n1 2\n",
  };
  for (const char *file : files) {
    Document document = document_of(file);
    ASSERT_TEXT(document.text(), file);
    fail_unless(document.track() == *tactile::read_webvtt(file)
                || std::string_view(file).find(".5%") != std::string_view::npos);
    // There and back.
    const auto back
        = document.apply({ { .at = 0, .remove = document.cues().size(), .insert = {} } });
    fail_unless(back.has_value());
    const std::string without = document.text();
    fail_unless(tactile::read_webvtt(without).has_value(), "%s", without.c_str());
    fail_unless(document.apply(*back).has_value());
    ASSERT_TEXT(document.text(), file);
  }
}

CHECK_TEST(test_changed_cue)
{
  Document document = document_of("WEBVTT\r\n\r\nNOTE one\r\n\r\nid\r\n00:01.000 --> 00:02.000 "
                                  "line:0\r\n1 2\r\n\r\n00:02.000 --> 00:03.000\r\n1 2\r\n");
  fail_unless(document.cues().front() == cue(1000, 2000, { 1, 2 }, { "one" }));
  fail_unless(document
                  .apply({ { .at = 0,
                             .remove = 1,
                             .insert = { cue(1000, 1500, { 100, 0 }, { "two", "a\nb", "" }) } } })
                  .has_value());
  ASSERT_TEXT(document.text(),
              "WEBVTT\r\n\r\nNOTE two\r\n\r\nNOTE\r\na\r\nb\r\n\r\nNOTE\r\n\r\nid\r\n00:00:01.000 "
              "--> 00:00:01.500 line:0\r\n100   0\r\n\r\n00:02.000 --> 00:03.000\r\n1 2\r\n");
  fail_unless(document_of(document.text()).cues() == document.cues());
}

/// Blocks that the reader takes for comments, styles and regions, whatever they hold.
CHECK_TEST(test_frequency)
{
  const std::string text = "WEBVTT\n\n00:00.000 --> 00:00.100\n10 20\n120 Hz\n\n"
                           "00:00.200 --> 00:00.300\n30 40\n";
  Document document = document_of(text);
  Cue tuned = document.cues()[0];
  fail_unless_equals_int(tuned.frequency, 120);
  tuned.frequency = 130;
  fail_unless(document.apply({ { .at = 0, .remove = 1, .insert = { tuned } } }).has_value());
  const std::string changed = document.text();
  fail_unless(changed.find("130 Hz") != std::string::npos
                  && changed.ends_with("00:00.200 --> 00:00.300\n30 40\n"),
              "%s", changed.c_str());
  tuned.frequency = 1001;
  fail_if(document.apply({ { .at = 0, .remove = 1, .insert = { tuned } } }).has_value());
}

CHECK_TEST(test_arrow_in_a_comment)
{
  for (const char *first : { "NOTE slower --> faster", "NOTE\t-->", "STYLE -->", "REGION a-->b" }) {
    const std::string file = std::string("WEBVTT - a --> b\n\nNOTE tactile grid=1x2\n\n") + first
                             + "\nmore\n\n00:01.000 --> 00:02.000\n1 2\n";
    Document document = document_of(file);
    fail_unless(document.cues() == std::vector<Cue>{ cue(1000, 2000, { 1, 2 }) }, "%s", first);
    fail_unless(
        document.apply({ { .at = 0, .remove = 1, .insert = { cue(500, 600, { 3, 4 }) } } }));
    fail_unless(document.text().find(std::string(first) + "\nmore\n") != std::string::npos);
    fail_unless(document_of(document.text()).cues() == document.cues());
  }
}

/// Any track that can be read can be drawn into, emptied and drawn into again, and read as it is.
/// What is no note stays in the file.
CHECK_TEST(test_blocks_stay)
{
  const std::string longest(4097, 'x');
  const std::string grid = "WEBVTT\n\nNOTE tactile grid=1x2\n\n";
  const std::string one = "00:01.000 --> 00:02.000\n1 2\n";
  const std::string two = "00:02.000 --> 00:03.000\n3 4\n";
  std::string many;
  for (int i = 0; i < 20; i++)
    many += i == 17 ? "NOTE\n\n" : "NOTE n" + std::to_string(i) + "\n\n";
  struct Case
  {
    std::string file;
    std::vector<std::string> stays;
  };
  const Case cases[] = {
    { grid + "NOTE remark", { "NOTE remark" } },
    { grid + one + "\nNOTE remark\n", { "NOTE remark" } },
    { "WEBVTT\n\nNOTE tactile rate=5\n\n" + one, { "rate=5" } },
    { grid + one + "\nNOTE a\n\nSTYLE\n::cue {}\n\nNOTE b\n\n" + two, { "STYLE\n::cue {}\n" } },
    { grid + one + "\nNOTE " + longest + "\n\n" + two, { longest } },
    { grid + one + "\nREGION\nid:a\n\nNOTE a --> b\n\n" + two, { "id:a", "a --> b" } },
    { "WEBVTT\n\n" + one + "\nNOTE tactile grid=1x2 rate=7\n\n" + two, { "rate=7" } },
    { "WEBVTT\n\n" + one + "\n00:02.000 --> 00:03.000\n3\n4\n", {} },
    { "WEBVTT\n\n" + one + "\n00:02.000 --> 00:03.000\n3\n4\n\nNOTE tactile grid=1x2\n", {} },
    { grid + many + one, {} },
    { grid + one + "\n" + many + two, {} },
    { "WEBVTT\n\nNOTE tactile grid=1x2\r", {} },
    { "WEBVTT\n\n" + one + "\n\n00:02.000 --> 00:03.000\r1 2\r\r"
          + "00:03.000 --> 00:04.000\n1 2\n",
      {} },
    { "WEBVTT\n\n00:01.000 --> 00:02.000\r1 2\r\r00:02.000 --> 00:03.000\n1 2\n\n"
          + std::string("00:03.000 --> 00:04.000\n1 2\n"),
      {} },
  };
  for (const Case &one_case : cases) {
    const Document original = document_of(one_case.file);
    const std::size_t count = original.cues().size();
    std::vector<std::vector<Splice>> edits{
      { { .at = 0, .remove = 0, .insert = { cue(100, 200, { 5, 6 }) } } },
      { { .at = count, .remove = 0, .insert = { cue(9000, 9001, { 5, 6 }, { "n" }) } } },
      { { .at = 0, .remove = count, .insert = {} } },
      { { .at = 0, .remove = count, .insert = { cue(100, 200, { 5, 6 }, { "n" }) } } },
    };
    for (std::size_t i = 0; i < count; i++) {
      Cue changed = original.cues()[i];
      edits.push_back({ { .at = i, .remove = 1, .insert = {} } });
      changed.levels = { 7, 8 };
      edits.push_back({ { .at = i, .remove = 1, .insert = { changed } } });
      changed.notes.resize(std::min<std::size_t>(1, changed.notes.size()));
      edits.push_back({ { .at = i, .remove = 1, .insert = { changed } } });
      changed.start++; // it moves
      edits.push_back({ { .at = i, .remove = 1, .insert = { changed } } });
    }
    for (const auto &edit : edits) {
      Document document = original;
      fail_unless(document.apply(edit).has_value());
      const std::string text = document.text();
      Document saved = document_of(text);
      fail_unless(saved.cues() == document.cues(), "%s", text.c_str());
      fail_unless(saved.rate() == original.rate(), "%s", text.c_str());
      fail_unless(saved.grid() == original.grid(), "%s", text.c_str());
      ASSERT_TEXT(saved.text(), text.c_str());
      for (const std::string &block : one_case.stays)
        fail_unless(text.find(block) != std::string::npos, "no %s in:\n%s", block.c_str(),
                    text.c_str());
      // And on from what was saved.
      fail_unless(saved.apply({ { .at = 0, .remove = saved.cues().size(), .insert = {} } }));
      Document empty = document_of(saved.text());
      fail_unless(empty.cues().empty());
      fail_unless(empty.apply({ { .at = 0, .remove = 0, .insert = { cue(1, 2, { 1, 1 }) } } }));
      fail_unless(document_of(empty.text()).cues() == empty.cues(), "%s", empty.text().c_str());
      for (const std::string &block : one_case.stays)
        fail_unless(empty.text().find(block) != std::string::npos);
    }
  }
}

/// More notes than a page takes are lines of the last one.
CHECK_TEST(test_too_many_notes)
{
  std::string file = "WEBVTT\n\n";
  for (int i = 0; i < 18; i++)
    file += i == 16 ? "NOTE\n\n" : "NOTE n" + std::to_string(i) + "\n\n";
  const std::string timing = "00:01.000 --> 00:02.000\n1 2\n";
  const Document document = document_of(file + timing);
  fail_unless(document.cues()[0].notes.size() == 16);
  ASSERT_TEXT(document.cues()[0].notes[15], "n15\nn17");
  fail_unless(document.text() == file + timing);
  const auto full = Document::read(file + "NOTE " + std::string(4096, 'x') + "\n\n" + timing);
  fail_unless(!full && full.error().text().find("16 notes") != std::string::npos);
}

CHECK_TEST(test_refused)
{
  Document document
      = document_of("WEBVTT\n\nNOTE tactile grid=1x2\n\n00:01.000 --> 00:02.000\n1 2\n");
  const std::string before = document.text();
  const Cue wrong[] = {
    cue(-1, 10, { 1, 2 }),
    cue(10, 10, { 1, 2 }),
    cue(10, 9, { 1, 2 }),
    cue(5, 360'000'001, { 1, 2 }),
    cue(0, 10, { 1 }),
    cue(0, 10, { 1, 101 }),
    cue(500, 1001, { 1, 2 }),
    cue(1999, 3000, { 1, 2 }),
    cue(0, 10, { 1, 2 }, { "a\n\nb" }),
    cue(0, 10, { 1, 2 }, { "a --> b" }),
    cue(0, 10, { 1, 2 }, { "\na" }),
    cue(0, 10, { 1, 2 }, { "a\rb" }),
    cue(0, 10, { 1, 2 }, { " tactile grid=9x9" }),
    cue(0, 10, { 1, 2 }, std::vector<std::string>(17)),
    cue(0, 10, { 1, 2 }, { std::string(4097, 'x') }),
  };
  for (const Cue &one : wrong) {
    // After one that is right, which is taken back.
    const auto applied
        = document.apply({ { .at = 1, .remove = 0, .insert = { cue(9000, 9001, { 1, 1 }) } },
                           { .at = one.start >= 1999 ? 1U : 0U, .remove = 0, .insert = { one } } });
    fail_unless(!applied && !applied.error().empty(), "%d to %d", one.start, one.end);
    ASSERT_TEXT(document.text(), before.c_str());
  }
  fail_unless(!document.apply({ { .at = 2, .remove = 0, .insert = {} } }));
  fail_unless(!document.apply({ { .at = 0, .remove = 2, .insert = {} } }));
  fail_unless(!document.apply({ { .at = 1, .remove = SIZE_MAX, .insert = {} } }));
  fail_unless(!Document::read("WEBVTT\n\nNOTE \xff\n\n00:01.000 --> 00:02.000\n1 2\n"));
  fail_unless(!Document::read("00:01.000 --> 00:02.000\n1 2\n"));
}

/// A hundred thousand splices of a full track: in order, from its end, and back and forth.
CHECK_TEST(test_many_splices)
{
  std::string text = "WEBVTT\n\nNOTE tactile grid=1x1\n";
  for (int i = 0; i < static_cast<int>(desk::kMostCues); i++)
    text += "\n"
            + tactile::write_webvtt_timing(std::chrono::milliseconds(10 * i),
                                           std::chrono::milliseconds(10 * i + 10))
            + "\n" + std::to_string(1 + i % 2) + "\n";
  Document document = document_of(text);
  const std::vector<Cue> before = document.cues();
  std::vector<Splice> splices;
  for (std::size_t i = 0; i < desk::kMostCues / 2; i++) // each second one
    splices.push_back({ .at = i, .remove = 1, .insert = {} });
  const auto back = document.apply(splices);
  fail_unless(back && document.cues().size() == desk::kMostCues / 2);
  fail_unless(
      std::ranges::all_of(document.cues(), [](const Cue &cue) { return cue.levels[0] == 2; }));
  fail_unless(document.apply(*back) && document.cues() == before);
  splices.clear();
  for (std::size_t i = 0; i < desk::kMostCues; i++)
    splices.push_back({ .at = i % 2 ? desk::kMostCues - 1 : 0, .remove = 0, .insert = {} });
  const auto refused = document.apply(splices);
  fail_unless(!refused && refused.error().find("order") != std::string::npos);
  fail_unless(document.cues() == before);
}

CHECK_TEST(test_size)
{
  const std::string text = "WEBVTT\n\nNOTE tactile grid=1x1\n\n00:01.000 --> 00:02.000\n1\n";
  auto document = Document::read(text, text.size() + 1000);
  fail_unless(document.has_value());
  const Splice one{ .at = 1,
                    .remove = 0,
                    .insert = { cue(2000, 3000, { 1 }, { std::string(500, 'x') }) } };
  const auto back = document->apply({ one });
  fail_unless(back.has_value());
  const Splice two{ .at = 2,
                    .remove = 0,
                    .insert = { cue(3000, 4000, { 1 }, { std::string(500, 'x') }) } };
  const auto refused = document->apply({ two });
  fail_unless(!refused && refused.error().find("bytes") != std::string::npos);
  fail_unless(document->cues().size() == 2);
  // Again and again: what was taken back does not count.
  for (int i = 0; i < 10; i++)
    fail_unless(document->apply(*back) && document->apply({ one }));
}

CHECK_TEST(test_random_edits)
{
  for (unsigned seed = 0; seed < 60; seed++) {
    std::mt19937 random(seed);
    const tactile::Track track = random_track(seed, tactile::kTextTick, tactile::kTextSteps);
    Document document = document_of(tactile::write_webvtt(track));
    fail_unless(document.track() == track, "seed %u", seed);
    std::vector<std::vector<Splice>> undo;
    std::vector<std::string> texts;
    for (int turn = 0; turn < 10; turn++) {
      std::vector<Cue> expected = document.cues();
      const std::vector<Splice> splices = random_splices(random, expected, document.cells());
      for (const Splice &splice : splices) {
        const auto at = expected.begin() + static_cast<std::ptrdiff_t>(splice.at);
        const auto next = expected.erase(at, at + static_cast<std::ptrdiff_t>(splice.remove));
        expected.insert(next, splice.insert.begin(), splice.insert.end());
      }
      texts.push_back(document.text());
      auto back = document.apply(splices);
      fail_unless(back.has_value(), "seed %u: %s", seed, back ? "" : back.error().c_str());
      undo.push_back(*std::move(back));
      fail_unless(document.cues() == expected, "seed %u", seed);
      const Document again = document_of(document.text());
      fail_unless(again.cues() == expected, "seed %u:\n%s", seed, document.text().c_str());
      fail_unless(again.track() == *tactile::read_webvtt(document.text()));
      // As it comes from a page and as it is in the journal.
      const auto message = desk::read_edit(
          desk::write_edit({ .page = "p", .edit = "e", .revision = 7, .splices = splices }));
      fail_unless(message && message->splices == splices, "seed %u", seed);
    }
    while (!undo.empty()) {
      fail_unless(document.apply(undo.back()).has_value());
      ASSERT_TEXT(document.text(), texts.back().c_str());
      undo.pop_back();
      texts.pop_back();
    }
  }
}

CHECK_TEST(test_operations)
{
  for (unsigned seed = 0; seed < 60; seed++) {
    const tactile::Track track = random_track(seed, tactile::kTextTick, tactile::kTextSteps);
    const tactile::Track draft = random_track(seed + 1000, tactile::kTextTick, tactile::kTextSteps);
    struct Case
    {
      const char *name;
      double value;
      double second;
      tactile::Track expected;
    };
    const Case cases[] = {
      { "prune-shorter", 0.3, 0, prune_short(track, 300ms) },
      { "prune-weaker", 40, 0, prune_weak(track, 0.4F) },
      { "merge", 10, 0, merge_equal(track, 0.1F) },
      { "limit", 0.4, 0.2, *limit_events(track, { .max_duration = 400ms, .refractory = 200ms }) },
      { "scale", 0.5, 0, scale(track, 0.5F) },
      { "quantize", 4, 0, quantize(track, 4) },
      { "silence", 0, 0, *silence(track, 0ms, track.end()) },
      { "draft-max", 0, 0, *overlay(track, draft, tactile::Mix::max) },
      { "shift", 0.25, 0, *shift(track, 250ms) },
    };
    for (const Case &one : cases) {
      Document document = document_of(tactile::write_webvtt(track));
      const std::vector<Cue> before = document.cues();
      const auto splices = operate(
          document, &draft,
          { .name = one.name, .value = one.value, .second = one.second, .selection = {} });
      fail_unless(splices.has_value(), "%s: %s", one.name, splices ? "" : splices.error().c_str());
      fail_unless(document.apply(*splices).has_value());
      // Levels are the same at any time. Only the end of what is silent may differ.
      const tactile::Track expected
          = at_resolution(one.expected, tactile::kTextTick, tactile::kTextSteps);
      const auto found = diff(expected, document.track());
      fail_unless(found && found->empty(), "seed %u, %s", seed, one.name);
      // Those that were not affected are untouched.
      for (const Cue &cue : before) {
        const auto entry = [&](int time) {
          return expected.at(std::chrono::milliseconds(time));
        };
        bool is_same = true;
        for (int time = cue.start; time < cue.end; time++)
          is_same = is_same && entry(time) == track.at(std::chrono::milliseconds(time));
        fail_unless(!is_same || std::ranges::find(document.cues(), cue) != document.cues().end(),
                    "seed %u, %s at %d ms", seed, one.name, cue.start);
      }
    }
  }
}

CHECK_TEST(test_selection)
{
  Document document
      = document_of("WEBVTT\n\nNOTE tactile grid=1x2\n\n00:01.000 --> 00:03.000\n50 50\n");
  const auto selected = [&](const char *name, double value, desk::Selection selection) {
    const auto splices = operate(
        document, nullptr, { .name = name, .value = value, .selection = std::move(selection) });
    fail_unless(splices.has_value());
    return *splices;
  };
  const std::vector<Splice> middle{ { .at = 0,
                                      .remove = 1,
                                      .insert
                                      = { cue(1000, 1500, { 50, 50 }), cue(1500, 2000, { 50, 0 }),
                                          cue(2000, 3000, { 50, 50 }) } } };
  fail_unless(selected("silence", 0, { .from = 1500, .to = 2000, .cells = { 1 } }) == middle);
  fail_unless(selected("silence", 0, { .from = 4000 }).empty());
  // Nothing is longer than a second where nothing was.
  const auto shifted = selected("shift", 2, {});
  fail_unless(document.apply(shifted).has_value() && document.track().at(4500ms).levels[0] == 0.5F
              && document.track().at(2500ms).levels[0] == 0);
  const auto unknown = operate(document, nullptr, { .name = "fly" });
  fail_unless(!unknown && unknown.error().find("prune-shorter") != std::string::npos);
  fail_unless(!operate(document, nullptr, { .name = "draft" }));
  fail_unless(!operate(document, nullptr, { .name = "scale", .value = 101 }));
  fail_unless(!operate(document, nullptr, { .name = "quantize", .value = 0 }));
}

CHECK_MAIN(desk_document)
