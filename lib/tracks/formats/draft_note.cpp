// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/draft_note.h"

#include <array>
#include <charconv>
#include <cstdint>

namespace tactile {

namespace {

/// The note is near the beginning of each format.
constexpr std::size_t kHead = 4096;
constexpr std::string_view kFirst = "grid=";
constexpr std::string_view kSum = " sum=";

/// Where the words are: from "grid=" to before what ends the line, string or comment.
struct Place
{
  std::size_t begin = 0;
  std::size_t size = 0;
};

std::optional<Place>
find_words(std::string_view text)
{
  const std::size_t begin = text.substr(0, kHead).find(kFirst);
  if (begin == std::string_view::npos)
    return std::nullopt;
  std::string_view words = text.substr(begin);
  words = words.substr(0, words.find_first_of("\r\n\"<>,"));
  while (words.ends_with(' ') || words.ends_with('-')) // of "-->"
    words.remove_suffix(1);
  return Place{ .begin = begin, .size = words.size() };
}

/// FNV-1a of 64 bits, in hexadecimal.
std::string
sum_of(std::string_view before, std::string_view after)
{
  std::uint64_t sum = 0xcbf29ce484222325;
  for (const std::string_view part : { before, after })
    for (const char byte : part)
      sum = (sum ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3;
  std::array<char, 16> digits{};
  const char *end = std::to_chars(digits.data(), digits.data() + digits.size(), sum, 16).ptr;
  return { digits.data(), static_cast<std::size_t>(end - digits.data()) };
}

} // namespace

std::optional<DraftNote>
draft_note(std::string_view text)
{
  const std::optional<Place> place = find_words(text);
  if (!place)
    return std::nullopt;
  const std::string_view words = text.substr(place->begin, place->size);
  const std::size_t made_with = words.find(kSum);
  if (made_with == std::string_view::npos)
    return DraftNote{ .made_with = std::string(words) };
  return DraftNote{ .made_with = std::string(words.substr(0, made_with)),
                    .is_unchanged = words.substr(made_with + kSum.size())
                                    == sum_of(text.substr(0, place->begin + made_with),
                                              text.substr(place->begin + place->size)) };
}

std::string
with_draft_note(std::string text, std::string_view made_with)
{
  const std::optional<Place> place = find_words(text);
  if (!place)
    return text;
  text.replace(place->begin, place->size, made_with);
  const std::size_t end = place->begin + made_with.size();
  const std::string_view whole = text;
  const std::string sum = std::string(kSum) + sum_of(whole.substr(0, end), whole.substr(end));
  return text.insert(end, sum);
}

} // namespace tactile
