// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/hasp.h"

#include "tracks/formats/haptic.h"
#include "tracks/formats/json_document.h"

#include <optional>
#include <utility>

namespace tactile {

namespace {

constexpr std::size_t kMostNames = 10; ///< in one message

/// 'kick', 'snare' and 3 more
std::string
list(const std::vector<std::string> &names)
{
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMostNames; i++)
    text += (i == 0 ? "'" : ", '") + names[i] + "'";
  if (names.size() > kMostNames)
    text += " and " + std::to_string(names.size() - kMostNames) + " more";
  return text;
}

} // namespace

tl::expected<Track, FormatError>
read_hasp(std::string_view text, const std::string &name, std::vector<std::string> &ignored)
{
  const auto document = JsonDocument::parse(text);
  if (!document)
    return tl::unexpected(document.error());
  FirstError error;
  const JsonMembers root = document->root(error);
  const std::size_t count = root.size("clips");
  std::string open_clip;
  FirstError without_state; // the first clip is read then
  if (const char *id = document->root(without_state).object("state").find_text("clipId"))
    open_clip = id;
  std::vector<std::string> names;
  std::optional<std::size_t> chosen;
  for (std::size_t i = 0; i < count && !error; i++) {
    const JsonMembers clip = root.element("clips", i);
    names.push_back(clip.text("name"));
    const char *id = clip.find_text("clipId");
    if (!chosen && (name.empty() ? id && open_clip == id : names.back() == name))
      chosen = i;
  }
  if (!error && count == 0)
    root.fail("expected a clip");
  else if (!error && !chosen && !name.empty())
    root.fail("expected a clip '" + name + "', got " + list(names));
  if (error)
    return std::move(error).unless_set(Track());
  const std::size_t index = chosen.value_or(0);
  const std::string place = "clip '" + names[index] + "'";
  names.erase(names.begin() + static_cast<std::ptrdiff_t>(index));
  if (!names.empty())
    ignored.push_back(std::string(names.size() == 1 ? "the clip " : "the clips ") + list(names));
  const std::string haptic = root.element("clips", index).json("haptic");
  return read_haptic(haptic).map_error(
      [&](FormatError wrong) { return std::move(wrong).within(place); });
}

} // namespace tactile
