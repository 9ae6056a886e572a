// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chairproperties.h"

#include <cstring>
#include <utility>

namespace {

std::string
text(GObject *object, GParamSpec *spec)
{
  g_auto(GValue) value = G_VALUE_INIT;
  g_value_init(&value, spec->value_type);
  g_object_get_property(object, spec->name, &value);
  g_autofree gchar *contents = g_strdup_value_contents(&value);
  return contents;
}

bool
is_default(GObject *object, GParamSpec *spec)
{
  g_auto(GValue) value = G_VALUE_INIT;
  g_value_init(&value, spec->value_type);
  g_object_get_property(object, spec->name, &value);
  return g_param_value_defaults(spec, &value);
}

/// Sets a property; without a `wanted` text to the default. Notifies only of a change.
void
set(GObject *object, GParamSpec *spec, const std::optional<std::string> &wanted)
{
  g_auto(GValue) value = G_VALUE_INIT;
  g_value_init(&value, spec->value_type);
  if (!wanted)
    g_param_value_set_default(spec, &value);
  else if (G_VALUE_HOLDS_STRING(&value))
    g_value_set_string(&value, wanted->c_str()); // as it is: a device's name may begin with a quote
  else if (!gst_value_deserialize(&value, wanted->c_str()))
    return;
  g_auto(GValue) now = G_VALUE_INIT;
  g_value_init(&now, spec->value_type);
  g_object_get_property(object, spec->name, &now);
  if (g_param_values_cmp(spec, &now, &value) != 0)
    g_object_set_property(object, spec->name, &value);
}

} // namespace

ChairProperties::ChairProperties(GstElement *owner, std::vector<GstElement *> elements)
    : owner_(owner), elements_(std::move(elements))
{
}

chair::Settings
ChairProperties::open()
{
  // Before the first reading, so that no change is missed.
  watch_ = std::make_unique<chair::SettingsWatch>([this] {
    const chair::Settings settings = chair::read_settings();
    complain(settings);
    apply(settings, false);
  });
  if (!watch_->watches())
    GST_ELEMENT_WARNING(owner_, RESOURCE, FAILED,
                        ("Changes of the settings apply at the next start only."),
                        ("the system has no more threads"));
  chair::Settings settings = chair::read_settings();
  settings.leave_out_shakers();
  complain(settings);
  apply(settings, true);
  return settings;
}

/// Why a property has its value.
const char *
ChairProperties::reason(GstElement *element, GParamSpec *spec)
{
  const std::lock_guard lock(mutex_);
  const auto given = given_.find(spec->name);
  if (given != given_.end() && given->second == text(G_OBJECT(element), spec))
    return "settings";
  return is_default(G_OBJECT(element), spec) ? "default" : "property";
}

void
ChairProperties::post_driver()
{
  for (GstElement *element : elements_) {
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), "driver");
    if (spec == nullptr)
      continue;
    g_autofree gchar *driver = nullptr;
    g_object_get(element, "driver", &driver, nullptr);
    const char *why = reason(element, spec);
    // The text is also debug text, which gst-launch-1.0 prints.
    GST_ELEMENT_INFO(owner_, LIBRARY, SETTINGS, ("plays on driver=%s (%s)", driver, why),
                     ("plays on driver=%s (%s)", driver, why));
  }
}

void
ChairProperties::close()
{
  watch_.reset();
}

void
ChairProperties::complain(const chair::Settings &settings)
{
  for (const std::string &complaint : settings.complaints)
    GST_ELEMENT_WARNING(owner_, LIBRARY, SETTINGS, ("%s", complaint.c_str()), (nullptr));
}

void
ChairProperties::apply(const chair::Settings &settings, bool all)
{
  const std::lock_guard lock(mutex_);
  for (const chair::Key &key : chair::keys()) {
    if ((!all && !key.live) || std::strcmp(key.name, chair::kEnabled) == 0)
      continue;
    const auto found = settings.values.find(key.name);
    const auto value = found == settings.values.end() ? std::optional<std::string>()
                                                      : std::optional(found->second);
    if (!all && !value && !settings.complaints.empty())
      continue; // it may be what was refused
    if (key.kind != chair::Kind::grid) {
      give(key.name, value);
      continue;
    }
    const chair::Grid grid = chair::parse_grid(value.value_or(""));
    give("rows", value ? std::optional(std::to_string(grid.rows)) : std::nullopt);
    give("columns", value ? std::optional(std::to_string(grid.columns)) : std::nullopt);
  }
}

void
ChairProperties::give(const char *property, const std::optional<std::string> &value)
{
  for (GstElement *element : elements_) {
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), property);
    if (spec == nullptr)
      continue;
    GObject *object = G_OBJECT(element);
    const auto given = given_.find(property);
    const bool ours = given != given_.end() && given->second == text(object, spec);
    if (!ours && !is_default(object, spec))
      continue; // the player's
    if (ours || value)
      set(object, spec, value);
    if (value)
      given_[property] = text(object, spec);
    else
      given_.erase(property);
  }
}
