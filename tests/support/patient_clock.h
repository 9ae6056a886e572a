// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <chrono>
#include <mutex>
#include <new>
#include <thread>

#include <gst/gst.h>

/// A clock for a pipeline in real time that stands still while the machine holds the whole process
/// up: then nothing is late. The clock's time goes on by 6 ms at most from one look at it to the
/// next, and a thread looks about every 2 ms.
class PatientClock
{
public:
  explicit PatientClock(GstElement *pipeline)
      : clock_(GST_CLOCK(gst_object_ref_sink(
          g_object_new(type(), "clock-type", GST_CLOCK_TYPE_MONOTONIC, nullptr)))),
        thread_([this](const std::stop_token &stop) {
          while (!stop.stop_requested()) {
            gst_clock_get_time(clock_);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
          }
        })
  {
    gst_pipeline_use_clock(GST_PIPELINE(pipeline), clock_);
  }
  ~PatientClock()
  {
    thread_.request_stop();
    thread_.join();
    gst_object_unref(clock_);
  }
  PatientClock(const PatientClock &) = delete;
  PatientClock &operator=(const PatientClock &) = delete;

private:
  struct Clock
  {
    GstSystemClock parent;
    std::mutex mutex;
    GstClockTime real; ///< at the last look
    GstClockTime time;
  };

  static GstClockTime look(GstClock *clock)
  {
    const auto *parent = static_cast<GstClockClass *>(g_type_class_peek(GST_TYPE_SYSTEM_CLOCK));
    auto *self = reinterpret_cast<Clock *>(clock);
    std::lock_guard lock(self->mutex);
    const GstClockTime real = parent->get_internal_time(clock);
    self->time += std::min<GstClockTime>(real - std::min(real, self->real), 6 * GST_MSECOND);
    self->real = real;
    return self->time;
  }
  static void init_class(gpointer klass, gpointer)
  {
    static_cast<GstClockClass *>(klass)->get_internal_time = look;
    G_OBJECT_CLASS(klass)->finalize = finalize;
  }
  static void init(GTypeInstance *instance, gpointer)
  {
    new (&reinterpret_cast<Clock *>(instance)->mutex) std::mutex;
  }
  static void finalize(GObject *object)
  {
    reinterpret_cast<Clock *>(object)->mutex.~mutex();
    G_OBJECT_CLASS(g_type_class_peek(GST_TYPE_SYSTEM_CLOCK))->finalize(object);
  }
  static GType type()
  {
    static const GType type = g_type_register_static_simple(
        GST_TYPE_SYSTEM_CLOCK, "PatientClock", sizeof(GstSystemClockClass), init_class,
        sizeof(Clock), init, static_cast<GTypeFlags>(0));
    return type;
  }

  GstClock *clock_;
  std::jthread thread_;
};
