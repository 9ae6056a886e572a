// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/film_file.h"

#include <gst/check/gstcheck.h>

#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <vector>

using namespace std::string_literals;
using tactile::disable_by_default;

namespace {

/// Marks the tracks in place.
std::size_t
mark(std::string &file)
{
  return disable_by_default({ reinterpret_cast<std::uint8_t *>(file.data()), file.size() });
}

/// An EBML element whose size takes eight bytes, as GStreamer writes it.
std::string
element(const std::string &id, const std::string &body)
{
  std::string size = "\x01"s;
  for (int i = 6; i >= 0; i--)
    size += static_cast<char>(body.size() >> 8 * i);
  return id + size + body;
}

/// The same with a size of one byte.
std::string
small(const std::string &id, const std::string &body)
{
  return id + static_cast<char>(0x80 + body.size()) + body;
}

const std::string kEntry = "\xae"s;

/// The content of a TrackEntry.
std::string
track(char type, const std::string &language)
{
  return small("\xd7"s, "\x02"s) + small("\x83"s, std::string(1, type))
         + small("\x22\xb5\x9c"s, language);
}

const std::string kFelt = track(0x11, "zxx\0"s);

std::string
matroska(const std::string &entries)
{
  return element("\x1a\x45\xdf\xa3"s, small("\x42\x82"s, "matroska"))
         + element("\x18\x53\x80\x67"s, small("\xec"s, "void")
                                            + element("\x16\x54\xae\x6b"s, entries)
                                            + element("\x1f\x43\xb6\x75"s, "cluster"));
}

std::string
box(const std::string &name, const std::string &body)
{
  std::string size;
  for (int i = 3; i >= 0; i--)
    size += static_cast<char>((body.size() + 8) >> 8 * i);
  return size + name + body;
}

/// A trak with flags, version 0 or 1 of mdhd, language (three letters, ISO/IEC 14496-12, 8.4.2) and
/// handler.
std::string
trak(char flags, bool is_long, std::string_view language, const std::string &handler)
{
  const unsigned packed
      = std::accumulate(language.begin(), language.end(), 0U, [](unsigned sum, char letter) {
          return sum << 5 | static_cast<unsigned>(letter - 0x60);
        });
  const std::string times(is_long ? 28 : 16, 'T');
  return box("trak", box("tkhd", std::string(3, '\0') + flags + std::string(80, 'k'))
                         + box("mdia", box("mdhd", std::string(1, is_long ? '\1' : '\0') + "\0\0\0"s
                                                       + times + static_cast<char>(packed >> 8)
                                                       + static_cast<char>(packed) + "\0\0"s)
                                           + box("hdlr", std::string(8, '\0') + handler + "name")));
}

std::string
mp4(const std::string &traks)
{
  return box("ftyp", "isom") + "\0\0\0\1mdat\0\0\0\0\0\0\0\x14wide"s
         + box("moov", box("mvhd", "head") + traks);
}

} // namespace

GST_START_TEST(test_matroska)
{
  const std::string others = element(kEntry, track(0x01, "und"))
                             + element(kEntry, track(0x11, "eng"))
                             + element(kEntry, track(0x02, "zxx"));
  std::string file = matroska(others + element(kEntry, kFelt) + element(kEntry, kFelt));
  // By hand: 14 bytes and 3 more, in a size of five bytes, then FlagDefault = 0. Everything else
  // stays in place.
  const std::string marked = "\xae\x08\0\0\0\x11"s + kFelt + "\x88\x81\0"s;
  fail_unless(kFelt.size() == 14);
  const std::string expected = matroska(others + marked + marked);
  fail_unless_equals_uint64(mark(file), 2);
  fail_unless(file == expected);
  // The second time, the flag is found.
  fail_unless_equals_uint64(mark(file), 2);
  fail_unless(file == expected);
}
GST_END_TEST;

GST_START_TEST(test_matroska_variants)
{
  // An existing flag of two bytes, a size without room to grow, a segment of unknown size.
  std::string file
      = matroska(element(kEntry, small("\x88"s, "\0\1"s) + kFelt) + small(kEntry, kFelt));
  const std::string expected
      = matroska(element(kEntry, small("\x88"s, "\0\0"s) + kFelt) + small(kEntry, kFelt));
  fail_unless_equals_uint64(mark(file), 1);
  fail_unless(file == expected);
  file = matroska(element(kEntry, kFelt));
  const std::size_t segment = file.find("\x18\x53\x80\x67") + 4;
  file.replace(segment, 8, "\x01\xff\xff\xff\xff\xff\xff\xff");
  fail_unless_equals_uint64(mark(file), 1);
}
GST_END_TEST;

// Damaged entries are left unchanged: a reader cannot parse them to their end, so it would not find
// the flag.
GST_START_TEST(test_matroska_of_nobody)
{
  const std::string open = "\x01\xff\xff\xff\xff\xff\xff\xff"s; // of unknown size
  for (const std::string &entry :
       { element(kEntry, kFelt + "\0"s), element(kEntry, kFelt + "\xd7\x85"s),
         element(kEntry, kFelt + "\xd7"s + open), kEntry + open + kFelt }) {
    const std::string given = matroska(entry);
    std::string file = given;
    fail_unless_equals_uint64(mark(file), 0);
    fail_unless(file == given);
  }
}
GST_END_TEST;

GST_START_TEST(test_mp4)
{
  const std::string others = trak(7, false, "zxx", "vide") + trak(7, false, "eng", "sbtl");
  std::string file = mp4(others + trak(7, false, "zxx", "sbtl") + trak(15, true, "zxx", "text"));
  fail_unless_equals_uint64(mark(file), 2);
  fail_unless(file == mp4(others + trak(6, false, "zxx", "sbtl") + trak(14, true, "zxx", "text")));
}
GST_END_TEST;

// Truncated files and files with random bytes changed. AddressSanitizer and valgrind see accesses
// beyond them.
GST_START_TEST(test_damaged)
{
  std::mt19937 random(1);
  for (const std::string &whole :
       { matroska(element(kEntry, kFelt)), mp4(trak(7, false, "zxx", "sbtl")) }) {
    for (std::size_t size = 0; size < whole.size(); size++) {
      std::vector<std::uint8_t> part(whole.begin(),
                                     whole.begin() + static_cast<std::ptrdiff_t>(size));
      disable_by_default(part);
    }
    for (int i = 0; i < 5000; i++) {
      std::vector<std::uint8_t> bytes(whole.begin(), whole.end());
      for (int n = 0; n < 3; n++)
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      disable_by_default(bytes);
    }
  }
}
GST_END_TEST;

static Suite *
film_file_suite(void)
{
  Suite *suite = suite_create("film_file");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_matroska);
  tcase_add_test(tests, test_matroska_variants);
  tcase_add_test(tests, test_matroska_of_nobody);
  tcase_add_test(tests, test_mp4);
  tcase_add_test(tests, test_damaged);
  return suite;
}

GST_CHECK_MAIN(film_file)
