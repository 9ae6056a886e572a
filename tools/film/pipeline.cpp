// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pipeline.h"
#include "translation.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace {

/// Launch lines are UTF-8, names of files are bytes: those that are no UTF-8 have this before them,
/// are escaped as in URIs, and are set once the elements are there.
constexpr const char *kBytes = "bytes-of-a-name:";

void
set_bytes(const GValue *item, gpointer)
{
  auto *element = G_OBJECT(g_value_get_object(item));
  guint count = 0;
  g_autofree GParamSpec **properties
      = g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
  for (guint i = 0; i < count; i++) {
    const GParamSpec *property = properties[i];
    constexpr int kBoth = G_PARAM_READABLE | G_PARAM_WRITABLE;
    if (!G_IS_PARAM_SPEC_STRING(property) || (property->flags & kBoth) != kBoth)
      continue;
    g_autofree gchar *value = nullptr;
    g_object_get(element, property->name, &value, nullptr);
    if (value == nullptr || !g_str_has_prefix(value, kBytes))
      continue;
    g_autofree gchar *bytes = g_uri_unescape_string(value + std::strlen(kBytes), nullptr);
    g_object_set(element, property->name, bytes, nullptr);
  }
}

} // namespace

Pipeline
make_pipeline(const std::string &line)
{
  g_autoptr(GError) error = nullptr;
  Pipeline pipeline(
      gst_parse_launch_full(line.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error));
  if (!pipeline)
    throw std::runtime_error(in_text("cannot build the pipeline: {}", error->message));
  if (line.find(kBytes) != std::string::npos) {
    GstIterator *elements = gst_bin_iterate_recurse(GST_BIN(pipeline.get()));
    gst_iterator_foreach(elements, set_bytes, nullptr); // resyncs do not happen: nobody adds any
    gst_iterator_free(elements);
  }
  return pipeline;
}

Owned<GstElement>
element(const Pipeline &pipeline, const char *name)
{
  return Owned<GstElement>(gst_bin_get_by_name(GST_BIN(pipeline.get()), name));
}

std::string
start_error(GstBus *bus)
{
  g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  if (!message)
    return "the pipeline could not be started";
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  return error->message;
}

bool
motors_may_run(GstElement *sink)
{
  g_autoptr(GstStructure) stats = nullptr;
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(sink), "actuation-stats"))
    g_object_get(sink, "actuation-stats", &stats, nullptr);
  gboolean may_run = FALSE;
  return stats && gst_structure_get_boolean(stats, "may-run", &may_run) && may_run;
}

std::string
launch_value(const std::string &value)
{
  if (!g_utf8_validate(value.c_str(), -1, nullptr)) {
    g_autofree gchar *escaped = g_uri_escape_string(value.c_str(), "/", FALSE);
    return std::string(kBytes) + escaped;
  }
  const auto is_plain = [](char c) {
    return g_ascii_isalnum(c) || std::strchr("_-./:%", c);
  };
  if (!value.empty() && std::ranges::all_of(value, is_plain))
    return value;
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\')
      text += '\\';
    text += c;
  }
  return text + "\"";
}
