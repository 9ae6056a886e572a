// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Helpers for pipelines, elements and their buses.
#pragma once

#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include <gst/check/gstcheck.h>

inline GstElement *
make_pipeline(const std::string &line)
{
  g_autoptr(GError) error = nullptr;
  GstElement *pipeline = gst_parse_launch(line.c_str(), &error);
  fail_unless(error == nullptr, "%s", error ? error->message : "");
  return pipeline;
}

/// Changes the state and waits until it is reached.
inline void
change_state(GstElement *pipeline, GstState state)
{
  fail_if(gst_element_set_state(pipeline, state) == GST_STATE_CHANGE_FAILURE);
  fail_if(gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE)
          == GST_STATE_CHANGE_FAILURE);
}

/// Waits for EOS. An error message fails the test.
inline void
wait_for_eos(GstElement *pipeline)
{
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  ck_assert_int_eq(GST_MESSAGE_TYPE(message), GST_MESSAGE_EOS);
}

/// Plays from beginning to end. Takes ownership of the pipeline.
inline void
play_to_the_end(GstElement *pipeline)
{
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  wait_for_eos(pipeline);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

/// An accurate seek, by default a flushing one.
inline void
seek_exactly(GstElement *pipeline, double rate, GstClockTime start, GstClockTime stop,
             GstSeekFlags flags = GST_SEEK_FLAG_FLUSH)
{
  fail_unless(gst_element_seek(
      pipeline, rate, GST_FORMAT_TIME, static_cast<GstSeekFlags>(flags | GST_SEEK_FLAG_ACCURATE),
      GST_SEEK_TYPE_SET, static_cast<gint64>(start), GST_SEEK_TYPE_SET, static_cast<gint64>(stop)));
}

/// A counter of an element's `stats`.
inline guint64
stat_of(GstElement *element, const char *field, const char *property = "stats")
{
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(element, property, &stats, nullptr);
  guint64 value = 0;
  fail_unless(gst_structure_get_uint64(stats, field, &value));
  return value;
}

/// A counter of `actuation-stats`, of a tactorsink or a visuotactilesink.
inline guint64
actuation_stat_of(GstElement *element, const char *field)
{
  return stat_of(element, field, "actuation-stats");
}

/// The content of an error, warning or information message.
struct Said
{
  explicit Said(GstMessage *message)
  {
    g_autoptr(GError) error = nullptr;
    g_autofree gchar *debug = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
      gst_message_parse_error(message, &error, &debug);
    else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING)
      gst_message_parse_warning(message, &error, &debug);
    else
      gst_message_parse_info(message, &error, &debug);
    text = error->message;
    details = debug ? debug : "";
    domain = error->domain;
    code = error->code;
  }

  std::string text;
  std::string details;
  GQuark domain;
  int code;
};

/// A bus of its own for an element, for the lifetime of this object.
class ElementBus
{
public:
  explicit ElementBus(GstElement *element)
      : bus(gst_bus_new()), element_(GST_ELEMENT(gst_object_ref(element)))
  {
    gst_element_set_bus(element, bus);
  }
  ~ElementBus()
  {
    gst_element_set_bus(element_, nullptr);
    gst_object_unref(element_);
    gst_object_unref(bus);
  }
  ElementBus(const ElementBus &) = delete;
  ElementBus &operator=(const ElementBus &) = delete;

  /// Takes the next message of this type. Returns whether there was one.
  bool has(GstMessageType type) const
  {
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, type);
    return message != nullptr;
  }
  /// Takes the next message of this type, which must exist.
  Said said(GstMessageType type) const
  {
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, type);
    fail_unless(message != nullptr);
    return Said(message);
  }

  GstBus *bus;

private:
  GstElement *element_;
};
