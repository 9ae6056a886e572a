// SPDX-License-Identifier: LGPL-2.1-or-later
#include "live_settings.h"

#include <array>

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

LiveSettings::LiveSettings() : now_(at_start()), watch_([this] { apply(); })
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
  if (sink_ == nullptr)
    return;
  for (const LiveKey &key : kKeys) {
    if (now_.at(key.name) == applied_.at(key.name))
      continue;
    // Shakers have no delay.
    if (g_object_class_find_property(G_OBJECT_GET_CLASS(sink_.get()), key.name) != nullptr)
      gst_util_set_object_arg(G_OBJECT(sink_.get()), key.name, now_.at(key.name).c_str());
  }
  applied_ = now_;
}
