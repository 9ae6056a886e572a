// SPDX-License-Identifier: LGPL-2.1-or-later
#include "live_settings.h"

#include <array>
#include <cstring>

namespace {

struct LiveKey
{
  const char *name;
  const char *usual;
};

constexpr std::array kKeys
    = { LiveKey{ "intensity", "1" }, LiveKey{ "mute", "false" }, LiveKey{ chair::kDelay, "0" } };

/// Reads the settings. Values that are refused, or all of a file that is, stay as they are.
void
read(chair::Values &values)
{
  const chair::Settings settings = chair::read_settings();
  for (const LiveKey &key : kKeys) {
    const auto found = settings.values.find(key.name);
    if (found != settings.values.end())
      values[key.name] = found->second;
    else if (settings.complaints.empty())
      values[key.name] = key.usual;
    else
      values.try_emplace(key.name, key.usual);
  }
}

} // namespace

const chair::Values &
LiveSettings::at_start()
{
  static const chair::Values values = [] {
    chair::Values values;
    read(values);
    return values;
  }();
  return values;
}

LiveSettings::LiveSettings()
    : now_(at_start()), delay_(chair::parse_delay(now_.at(chair::kDelay))),
      watch_([this] { apply(); })
{
}

void
LiveSettings::attach(GstElement *sink)
{
  {
    const std::lock_guard lock(mutex_);
    sink_ = Owned<GstElement>(sink ? GST_ELEMENT(gst_object_ref(sink)) : nullptr);
    applied_ = at_start();
  }
  apply();
}

void
LiveSettings::apply()
{
  const std::lock_guard lock(mutex_);
  read(now_);
  delay_ = chair::parse_delay(now_.at(chair::kDelay));
  if (sink_ == nullptr)
    return;
  for (const LiveKey &key : kKeys) {
    if (now_.at(key.name) == applied_.at(key.name))
      continue;
    if (std::strcmp(key.name, chair::kDelay) != 0) {
      gst_util_set_object_arg(G_OBJECT(sink_.get()), key.name, now_.at(key.name).c_str());
      continue;
    }
    if (g_object_class_find_property(G_OBJECT_GET_CLASS(sink_.get()), "ts-offset") == nullptr)
      continue; // shakers
    // The offset of a followed player's sink is more than the delay.
    gint64 offset = 0;
    g_object_get(sink_.get(), "ts-offset", &offset, nullptr);
    offset += delay_ - chair::parse_delay(applied_.at(key.name));
    g_object_set(sink_.get(), "ts-offset", offset, nullptr);
  }
  applied_ = now_;
}
