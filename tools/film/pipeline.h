// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <memory>
#include <string>

struct GstUnref
{
  void operator()(gpointer object) const
  {
    gst_object_unref(object);
  }
};
template <typename T> using Owned = std::unique_ptr<T, GstUnref>;

/// Brings the pipeline to NULL, and so the motors to zero, whichever way it is left.
struct StopPipeline
{
  void operator()(GstElement *pipeline) const
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
  }
};
using Pipeline = std::unique_ptr<GstElement, StopPipeline>;

/// A pipeline of a launch line. Throws std::runtime_error.
Pipeline make_pipeline(const std::string &line);

/// An element of it by its name, or nullptr.
Owned<GstElement> element(const Pipeline &pipeline, const char *name);

/// The first error on the bus of a pipeline that did not start.
std::string start_error(GstBus *bus);

/// Whether the motors of a sink that was set to NULL may still be on, as its board did not confirm
/// that they are not. The sink has said so on standard error.
bool motors_may_run(GstElement *sink);

/// A value for a launch line of make_pipeline(), such as the name of a file, which may be any
/// bytes.
std::string launch_value(const std::string &value);
