// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Starts a playbin or a playbin3 such that every element is there before the film is read.
#pragma once

#include <future>
#include <memory>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include <gst/check/gstcheck.h>

/// Tells a player in NULL or READY to go to a state and returns without waiting for it.
/* playbin3 of GStreamer 1.22 lets its source read before decodebin3 has been told to take what is
 * read. When the machine is busy, the first frame is refused (FLUSHING) and the film never starts:
 * about one start in fifty with two processes a core and no element of this project. So the source
 * is held until all have been told. */
inline void
start_player(GstElement *playbin, GstState state)
{
  struct Gate
  {
    std::promise<void> open;
    std::shared_future<void> opened = open.get_future().share();
  };
  using Held = std::shared_ptr<Gate>;
  const Held gate = std::make_shared<Gate>();

  const auto read = +[](GstPad *, GstPadProbeInfo *, gpointer held) {
    (*static_cast<Held *>(held))->opened.wait();
    return GST_PAD_PROBE_REMOVE;
  };
  struct Source
  {
    Held gate;
    GstPadProbeCallback read;
  } source{ gate, read };
  const auto made = +[](GstElement *, GstElement *element, gpointer user) {
    const auto *held = static_cast<Source *>(user);
    g_autoptr(GstPad) pad = gst_element_get_static_pad(element, "src");
    gst_pad_add_probe(
        pad,
        static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_PUSH
                                     | GST_PAD_PROBE_TYPE_PULL),
        held->read, new Held(held->gate),
        +[](gpointer probe) { delete static_cast<Held *>(probe); });
  };
  const gulong id = g_signal_connect(playbin, "source-setup", G_CALLBACK(made), &source);
  const GstStateChangeReturn told = gst_element_set_state(playbin, state);
  g_signal_handler_disconnect(playbin, id);
  gate->open.set_value();
  fail_if(told == GST_STATE_CHANGE_FAILURE);
}
