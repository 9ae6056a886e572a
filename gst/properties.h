// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <locale>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>

/// An element's properties as a table: each entry names a field of the element's settings, whose
/// default is that of a default-constructed Settings. install() makes GObject properties of it.
namespace properties {

inline constexpr auto kReadable = static_cast<GParamFlags>(G_PARAM_READABLE);
inline constexpr auto kReady
    = static_cast<GParamFlags>(G_PARAM_READWRITE | GST_PARAM_MUTABLE_READY);
inline constexpr auto kPlaying
    = static_cast<GParamFlags>(G_PARAM_READWRITE | GST_PARAM_MUTABLE_PLAYING);
inline constexpr auto kControllable = static_cast<GParamFlags>(kPlaying | GST_PARAM_CONTROLLABLE);

/// The field of a settings struct that an entry is about, also of a struct in it.
#define PROPERTY_FIELD(path)                                                                       \
  [](auto &settings) -> auto &                                                                     \
  {                                                                                                \
    return settings.path;                                                                          \
  }

/// GLib's kinds of numbers.
template <typename T> struct Number;
#define PROPERTY_NUMBER(T, Kind, KIND, name)                                                       \
  template <> struct Number<T>                                                                     \
  {                                                                                                \
    using Spec = GParamSpec##Kind;                                                                 \
    static constexpr const char *kName = "VisuotactileParam" #Kind;                                \
    static GType parent()                                                                          \
    {                                                                                              \
      return G_TYPE_PARAM_##KIND;                                                                  \
    }                                                                                              \
    static constexpr auto get = g_value_get_##name;                                                \
    static constexpr auto set = g_value_set_##name;                                                \
  };
PROPERTY_NUMBER(gint, Int, INT, int)
PROPERTY_NUMBER(guint, UInt, UINT, uint)
PROPERTY_NUMBER(gint64, Int64, INT64, int64)
PROPERTY_NUMBER(guint64, UInt64, UINT64, uint64)
PROPERTY_NUMBER(gdouble, Double, DOUBLE, double)
#undef PROPERTY_NUMBER

/// A value_validate() that names the range; GLib's own warning does not.
template <typename T>
gboolean
validate(GParamSpec *pspec, GValue *value)
{
  const T set = Number<T>::get(value);
  auto *parent = static_cast<GParamSpecClass *>(g_type_class_peek_static(Number<T>::parent()));
  if (!parent->value_validate(pspec, value))
    return FALSE;
  const auto *spec = reinterpret_cast<typename Number<T>::Spec *>(pspec);
  std::ostringstream text; // as C writes numbers
  text.imbue(std::locale::classic());
  text << set << " is outside of its range, " << spec->minimum << " to " << spec->maximum;
  g_warning("%s of %s: %s", pspec->name, g_type_name(pspec->owner_type), text.str().c_str());
  return TRUE;
}

/// One type per process, registered by the first plugin that needs it: plugins stay loaded. For
/// class_init, which GLib runs on one thread at a time.
template <typename T>
GType
spec_type()
{
  const GType known = g_type_from_name(Number<T>::kName);
  if (known != 0)
    return known;
  g_type_class_ref(Number<T>::parent()); // stays, for validate()
  GTypeInfo info{};
  info.class_size = sizeof(GParamSpecClass);
  info.class_init = [](gpointer klass, gpointer) {
    static_cast<GParamSpecClass *>(klass)->value_validate = validate<T>;
  };
  info.instance_size = sizeof(typename Number<T>::Spec);
  return g_type_register_static(Number<T>::parent(), Number<T>::kName, &info,
                                static_cast<GTypeFlags>(0));
}

/// An enumeration of the plugin's own; `values` stay.
inline GType
register_enum(const char *name, const GEnumValue *values)
{
  const GType type = g_enum_register_static(name, values);
  gst_type_mark_as_plugin_api(type, static_cast<GstPluginAPIFlags>(0));
  return type;
}

/// Longer times are clamped to this, some thirty years: sums of them do not overflow.
inline constexpr guint64 kLongest = 1'000'000'000'000'000'000;

template <typename To, typename From>
To
convert(From from)
{
  if constexpr (std::is_same_v<From, std::chrono::nanoseconds>)
    return static_cast<To>(from.count());
  else if constexpr (std::is_same_v<To, std::chrono::nanoseconds>)
    return To(static_cast<gint64>(std::min<guint64>(from, kLongest)));
  else
    return static_cast<To>(from);
}

template <typename Settings> struct Property
{
  struct Range
  {
    double minimum = 0;
    double maximum = 0;
  };

  const char *name;
  const char *blurb;
  GParamFlags flags;
  GParamSpec *(*spec)(const Property &, GParamFlags, const Settings &defaults);
  void (*set)(Settings &, const GValue *); ///< null: read-only
  void (*get)(const Settings &, GValue *); ///< null: what Element::stats makes
  std::optional<Range> range{};            ///< none: that of the type
  GType (*type)() = nullptr;               ///< of an enumeration

  GParamSpec *make_spec(const Settings &defaults) const
  {
    return spec(*this, static_cast<GParamFlags>(flags | G_PARAM_STATIC_NAME | G_PARAM_STATIC_BLURB),
                defaults);
  }

  /// A field that is a number, or with guint64 a time, in nanoseconds.
  template <typename T, typename Field>
  static constexpr Property number(const char *name, const char *blurb, GParamFlags flags, Field,
                                   std::optional<Range> range = {})
  {
    return { name,
             blurb,
             flags,
             [](const Property &self, GParamFlags all, const Settings &defaults) {
               using Spec = typename Number<T>::Spec;
               using Limits = std::numeric_limits<T>;
               GParamSpec *made = static_cast<GParamSpec *>(
                   g_param_spec_internal(spec_type<T>(), self.name, nullptr, self.blurb, all));
               auto *spec = reinterpret_cast<Spec *>(made);
               spec->minimum = self.range ? static_cast<T>(self.range->minimum) : Limits::lowest();
               spec->maximum = self.range ? static_cast<T>(self.range->maximum) : Limits::max();
               spec->default_value = convert<T>(Field{}(defaults));
               return made;
             },
             [](Settings &settings, const GValue *value) {
               auto &field = Field{}(settings);
               field = convert<std::remove_reference_t<decltype(field)>>(Number<T>::get(value));
             },
             [](const Settings &settings, GValue *value) {
               Number<T>::set(value, convert<T>(Field{}(settings)));
             },
             range };
  }

  template <typename Field>
  static constexpr Property flag(const char *name, const char *blurb, GParamFlags flags, Field)
  {
    return { name,
             blurb,
             flags,
             [](const Property &self, GParamFlags all, const Settings &defaults) {
               return g_param_spec_boolean(self.name, nullptr, self.blurb, Field{}(defaults), all);
             },
             [](Settings &settings, const GValue *value) {
               Field{}(settings) = g_value_get_boolean(value);
             },
             [](const Settings &settings, GValue *value) {
               g_value_set_boolean(value, Field{}(settings));
             } };
  }

  template <typename Field>
  static constexpr Property choice(const char *name, const char *blurb, GParamFlags flags, Field,
                                   GType (*type)())
  {
    return { name,
             blurb,
             flags,
             [](const Property &self, GParamFlags all, const Settings &defaults) {
               return g_param_spec_enum(self.name, nullptr, self.blurb, self.type(),
                                        static_cast<gint>(Field{}(defaults)), all);
             },
             [](Settings &settings, const GValue *value) {
               auto &field = Field{}(settings);
               field = convert<std::remove_reference_t<decltype(field)>>(g_value_get_enum(value));
             },
             [](const Settings &settings, GValue *value) {
               g_value_set_enum(value, static_cast<gint>(Field{}(settings)));
             },
             {},
             type };
  }

  /// Text that the settings keep in another form. `write` gives a std::optional<std::string>, none
  /// for NULL; `read` takes a string or NULL.
  template <auto write, auto read>
  static constexpr Property parsed(const char *name, const char *blurb, GParamFlags flags)
  {
    return { name,
             blurb,
             flags,
             [](const Property &self, GParamFlags all, const Settings &defaults) {
               const std::optional<std::string> text = write(defaults);
               return g_param_spec_string(self.name, nullptr, self.blurb,
                                          text ? text->c_str() : nullptr, all);
             },
             [](Settings &settings, const GValue *value) {
               read(settings, g_value_get_string(value));
             },
             [](const Settings &settings, GValue *value) {
               const std::optional<std::string> text = write(settings);
               g_value_set_string(value, text ? text->c_str() : nullptr);
             } };
  }

  /// A std::string; an empty one is NULL.
  template <typename Field>
  static constexpr Property text(const char *name, const char *blurb, GParamFlags flags, Field)
  {
    return parsed<write_text<Field>, read_text<Field>>(name, blurb, flags);
  }

  /// Read-only; Element::stats makes its value.
  static constexpr Property stats(const char *name, const char *blurb)
  {
    return { name,
             blurb,
             kReadable,
             [](const Property &self, GParamFlags all, const Settings &) {
               return g_param_spec_boxed(self.name, nullptr, self.blurb, GST_TYPE_STRUCTURE, all);
             },
             nullptr,
             nullptr };
  }

private:
  template <typename Field> static std::optional<std::string> write_text(const Settings &settings)
  {
    const std::string &field = Field{}(settings);
    return field.empty() ? std::nullopt : std::optional(field);
  }

  template <typename Field> static void read_text(Settings &settings, const gchar *text)
  {
    Field{}(settings) = text ? text : "";
  }
};

/// The functions of an element that its properties call.
template <typename Settings> struct Element
{
  Settings &(*settings)(GObject *); ///< guarded by the object lock
  /// After a property was set, without the lock; may be null.
  void (*changed)(GObject *, std::string_view name) = nullptr;
  GstStructure *(*stats)(GObject *) = nullptr; ///< transfer full
};

/// For class_init. A Settings type belongs to one class; `table` and what it names stay.
template <typename Settings>
void
install(GObjectClass *klass, std::span<const Property<Settings>> table,
        const Element<Settings> &element)
{
  static const std::span<const Property<Settings>> entries = table; // entry i is property i + 1
  static const Element<Settings> owner = element;
  klass->set_property = [](GObject *object, guint id, const GValue *value, GParamSpec *pspec) {
    GST_OBJECT_LOCK(object);
    entries[id - 1].set(owner.settings(object), value);
    GST_OBJECT_UNLOCK(object);
    if (owner.changed)
      owner.changed(object, pspec->name);
  };
  klass->get_property = [](GObject *object, guint id, GValue *value, GParamSpec *) {
    const Property<Settings> &entry = entries[id - 1];
    if (!entry.get) {
      g_value_take_boxed(value, owner.stats(object));
      return;
    }
    GST_OBJECT_LOCK(object);
    entry.get(owner.settings(object), value);
    GST_OBJECT_UNLOCK(object);
  };
  const Settings defaults;
  guint id = 0;
  for (const Property<Settings> &entry : table)
    g_object_class_install_property(klass, ++id, entry.make_spec(defaults));
}

/// Sets controlled properties for what has a timestamp. Streaming thread.
inline void
sync_values(gpointer object, const GstSegment &segment, GstClockTime pts)
{
  if (segment.format != GST_FORMAT_TIME)
    return;
  const GstClockTime time = gst_segment_to_stream_time(&segment, GST_FORMAT_TIME, pts);
  if (GST_CLOCK_TIME_IS_VALID(time))
    gst_object_sync_values(GST_OBJECT(object), time);
}

} // namespace properties
