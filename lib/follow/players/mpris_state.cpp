// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpris_state.h"

#include <string_view>

namespace follow {

namespace {

constexpr std::size_t kLongestName = 4096;

std::string
text(GVariant *dictionary, const char *key)
{
  const gchar *value = nullptr;
  if (!g_variant_lookup(dictionary, key, "&s", &value))
    return {};
  const std::string_view whole(value);
  return whole.size() <= kLongestName ? std::string(whole) : std::string();
}

} // namespace

void
MprisState::take(GVariant *properties)
{
  if (!g_variant_is_of_type(properties, G_VARIANT_TYPE_VARDICT))
    return;
  if (const std::string status = text(properties, "PlaybackStatus"); !status.empty())
    doing_ = status == "Playing"  ? Doing::playing
             : status == "Paused" ? Doing::paused
                                  : Doing::stopped;
  g_variant_lookup(properties, "Rate", "d", &rate_);
  g_autoptr(GVariant) metadata
      = g_variant_lookup_value(properties, "Metadata", G_VARIANT_TYPE_VARDICT);
  if (metadata != nullptr)
    take_metadata(metadata);
}

void
MprisState::take_metadata(GVariant *metadata)
{
  film_ = text(metadata, "xesam:url");
  if (film_.empty())
    film_ = text(metadata, "xesam:title");
  constexpr gint64 kLongest = 100 * 3600 * gint64{ G_USEC_PER_SEC };
  gint64 length = 0; // µs
  const bool is_told = g_variant_lookup(metadata, "mpris:length", "x", &length) && length > 0;
  length_ = is_told && length <= kLongest ? std::optional<Time>(std::chrono::microseconds(length))
                                          : std::nullopt;
}

Report
MprisState::report(Time now) const
{
  return { .received = now, .doing = doing_, .rate = rate_, .film = film_, .length = length_ };
}

} // namespace follow
