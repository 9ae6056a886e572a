// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/film_file.h"

#include "support/check_tests.h"

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

CHECK_TEST(test_mp4)
{
  const std::string others = trak(7, false, "zxx", "vide") + trak(7, false, "eng", "sbtl");
  std::string file = mp4(others + trak(7, false, "zxx", "sbtl") + trak(15, true, "zxx", "text"));
  fail_unless_equals_uint64(mark(file), 2);
  fail_unless(file == mp4(others + trak(6, false, "zxx", "sbtl") + trak(14, true, "zxx", "text")));
}

// Truncated files and files with random bytes changed. AddressSanitizer and valgrind see accesses
// beyond them.
CHECK_TEST(test_damaged)
{
  std::mt19937 random(1);
  const std::string whole = mp4(trak(7, false, "zxx", "sbtl"));
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

CHECK_MAIN(film_file)
