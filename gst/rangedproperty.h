// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib-object.h>

#include <locale>
#include <sstream>
#include <string>

/// Properties that are numbers, like GLib's own (g_param_spec_uint() and so on), but that name
/// their range when a value outside of it is set, which GLib refuses with a warning that does not.
namespace ranged {

template <typename Spec> struct Numbers;

template <> struct Numbers<GParamSpecUInt>
{
  static constexpr const char *kName = "VisuotactileParamUInt";
  static GType parent()
  {
    return G_TYPE_PARAM_UINT;
  }
  static guint get(const GValue *value)
  {
    return g_value_get_uint(value);
  }
};

template <> struct Numbers<GParamSpecInt>
{
  static constexpr const char *kName = "VisuotactileParamInt";
  static GType parent()
  {
    return G_TYPE_PARAM_INT;
  }
  static gint get(const GValue *value)
  {
    return g_value_get_int(value);
  }
};

template <> struct Numbers<GParamSpecDouble>
{
  static constexpr const char *kName = "VisuotactileParamDouble";
  static GType parent()
  {
    return G_TYPE_PARAM_DOUBLE;
  }
  static gdouble get(const GValue *value)
  {
    return g_value_get_double(value);
  }
};

template <typename Spec>
gboolean
validate(GParamSpec *pspec, GValue *value)
{
  const auto set = Numbers<Spec>::get(value);
  auto *parent = static_cast<GParamSpecClass *>(g_type_class_peek_static(Numbers<Spec>::parent()));
  if (!parent->value_validate(pspec, value))
    return FALSE;
  const auto *spec = reinterpret_cast<Spec *>(pspec);
  std::ostringstream text; // as C writes numbers
  text.imbue(std::locale::classic());
  text << set << " is outside of its range, " << spec->minimum << " to " << spec->maximum;
  g_warning("%s of %s: %s", pspec->name, g_type_name(pspec->owner_type), text.str().c_str());
  return TRUE;
}

/// One type for the process, whichever plugin comes first: plugins stay loaded. Called where a
/// class is made, which GLib does on one thread at a time.
template <typename Spec>
GType
type()
{
  const GType known = g_type_from_name(Numbers<Spec>::kName);
  if (known != 0)
    return known;
  g_type_class_ref(Numbers<Spec>::parent()); // stays, for validate()
  GTypeInfo info{};
  info.class_size = sizeof(GParamSpecClass);
  info.class_init = [](gpointer klass, gpointer) {
    static_cast<GParamSpecClass *>(klass)->value_validate = validate<Spec>;
  };
  info.instance_size = sizeof(Spec);
  return g_type_register_static(Numbers<Spec>::parent(), Numbers<Spec>::kName, &info,
                                static_cast<GTypeFlags>(0));
}

template <typename Spec, typename Number>
GParamSpec *
make(const char *name, const char *nick, const char *blurb, Number minimum, Number maximum,
     Number standard, GParamFlags flags)
{
  auto *spec = static_cast<Spec *>(g_param_spec_internal(type<Spec>(), name, nick, blurb, flags));
  spec->minimum = minimum;
  spec->maximum = maximum;
  spec->default_value = standard;
  return reinterpret_cast<GParamSpec *>(spec);
}

inline GParamSpec *
uint(const char *name, const char *nick, const char *blurb, guint minimum, guint maximum,
     guint standard, GParamFlags flags)
{
  return make<GParamSpecUInt>(name, nick, blurb, minimum, maximum, standard, flags);
}

inline GParamSpec *
integer(const char *name, const char *nick, const char *blurb, gint minimum, gint maximum,
        gint standard, GParamFlags flags)
{
  return make<GParamSpecInt>(name, nick, blurb, minimum, maximum, standard, flags);
}

inline GParamSpec *
real(const char *name, const char *nick, const char *blurb, gdouble minimum, gdouble maximum,
     gdouble standard, GParamFlags flags)
{
  return make<GParamSpecDouble>(name, nick, blurb, minimum, maximum, standard, flags);
}

} // namespace ranged
