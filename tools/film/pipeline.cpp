// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pipeline.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

Pipeline
make_pipeline(const std::string &line)
{
  g_autoptr(GError) error = nullptr;
  Pipeline pipeline(
      gst_parse_launch_full(line.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error));
  if (!pipeline)
    throw std::runtime_error(std::string("cannot build the pipeline: ") + error->message);
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
