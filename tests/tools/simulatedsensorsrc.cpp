// SPDX-License-Identifier: LGPL-2.1-or-later
//
// simulatedsensorsrc: a live source that records simulated motors while they play. It reads the
// commands from the trace of the tactorsink in its pipeline.
#include "calibration/calibration.h"
#include "calibration/simulated_sensor.h"
#include "tools/film/or_throw.h"

#include <gst/base/base.h>
#include <gst/gst.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <vector>

using namespace std::chrono_literals;
using tactor::Time;

namespace {

constexpr Time kChunk = 500ms;
/// All commands that affect a chunk are in the trace this long after its end, also on a busy
/// machine.
constexpr Time kMargin = 500ms;
constexpr int kRate = 8000;

struct Sensor
{
  std::vector<tactor::MotorParameters> motors{};
  std::atomic<GstClockTime> latency = 0; ///< the pipeline's, which delays tactorsink
  Time done{ 0 };
};

} // namespace

struct SimulatedSensorSrc
{
  GstPushSrc parent;
  gchar *motors;
  Sensor *sensor;
};

struct SimulatedSensorSrcClass
{
  GstPushSrcClass parent_class;
};

G_DEFINE_TYPE(SimulatedSensorSrc, simulated_sensor_src, GST_TYPE_PUSH_SRC)

static GstStaticPadTemplate pad_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS("audio/x-raw, format=F64LE, layout=interleaved, rate=8000, channels=1"));

static std::vector<tactor::IssuedCommand>
commands_so_far(GstElement *self)
{
  GstElement *pipeline = GST_ELEMENT(gst_object_get_parent(GST_OBJECT(self)));
  GstElement *tactors = gst_bin_get_by_name(GST_BIN(pipeline), "tactors");
  g_autofree gchar *path = nullptr;
  g_object_get(tactors, "trace-location", &path, nullptr);
  gst_object_unref(tactors);
  gst_object_unref(pipeline);
  std::fflush(nullptr); // flushes the trace, a stream of this process
  return or_throw(tactor::read_command_trace(path));
}

static GstFlowReturn
simulated_sensor_src_create(GstPushSrc *push, GstBuffer **buffer)
{
  auto *self = reinterpret_cast<SimulatedSensorSrc *>(push);
  Sensor &sensor = *self->sensor;
  try {
    std::vector<tactor::IssuedCommand> trace;
    if (sensor.done > Time(0)) // before that the pipeline is still starting
      trace = commands_so_far(GST_ELEMENT(self));
    for (tactor::IssuedCommand &issued : trace)
      issued.issued += Time(static_cast<gint64>(sensor.latency.load()));
    const tactor::Recording heard = tactor::hear(
        trace, sensor.motors, { .rate = kRate, .noise = 0.001 }, sensor.done + kChunk);
    const std::vector<double> &all = heard.channels.front();
    const auto size = static_cast<std::size_t>(kRate * kChunk / 1s);
    *buffer = gst_buffer_new_memdup(all.data() + (all.size() - size), size * sizeof all.front());
    GST_BUFFER_PTS(*buffer) = static_cast<GstClockTime>(sensor.done.count());
    GST_BUFFER_DURATION(*buffer) = static_cast<GstClockTime>(Time(kChunk).count());
    sensor.done += kChunk;
    return GST_FLOW_OK;
  } catch (const std::exception &e) {
    GST_ELEMENT_ERROR(self, RESOURCE, READ, ("%s", e.what()), (nullptr));
    return GST_FLOW_ERROR;
  }
}

/// A chunk is pushed once the commands of the next one are known.
static void
simulated_sensor_src_get_times(GstBaseSrc *, GstBuffer *buffer, GstClockTime *start,
                               GstClockTime *end)
{
  *start = GST_BUFFER_PTS(buffer) + static_cast<GstClockTime>(Time(2 * kChunk + kMargin).count());
  *end = GST_CLOCK_TIME_NONE;
}

static gboolean
simulated_sensor_src_query(GstBaseSrc *src, GstQuery *query)
{
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY)
    return GST_BASE_SRC_CLASS(simulated_sensor_src_parent_class)->query(src, query);
  gst_query_set_latency(query, TRUE, static_cast<GstClockTime>(Time(2 * kChunk + kMargin).count()),
                        GST_CLOCK_TIME_NONE);
  return TRUE;
}

static gboolean
simulated_sensor_src_event(GstBaseSrc *src, GstEvent *event)
{
  if (GST_EVENT_TYPE(event) == GST_EVENT_LATENCY) {
    GstClockTime latency = 0;
    gst_event_parse_latency(event, &latency);
    reinterpret_cast<SimulatedSensorSrc *>(src)->sensor->latency = latency;
  }
  return GST_BASE_SRC_CLASS(simulated_sensor_src_parent_class)->event(src, event);
}

static gboolean
simulated_sensor_src_start(GstBaseSrc *src)
{
  auto *self = reinterpret_cast<SimulatedSensorSrc *>(src);
  self->sensor->done = Time(0);
  const auto calibration = tactor::read_calibration(self->motors ? self->motors : "");
  if (!calibration) {
    GST_ELEMENT_ERROR(self, RESOURCE, SETTINGS, ("%s", calibration.error().c_str()), (nullptr));
    return FALSE;
  }
  self->sensor->motors = calibration->motors(3);
  return TRUE;
}

static void
simulated_sensor_src_set_property(GObject *object, guint, const GValue *value, GParamSpec *)
{
  auto *self = reinterpret_cast<SimulatedSensorSrc *>(object);
  g_free(self->motors);
  self->motors = g_value_dup_string(value);
}

static void
simulated_sensor_src_finalize(GObject *object)
{
  auto *self = reinterpret_cast<SimulatedSensorSrc *>(object);
  g_free(self->motors);
  delete self->sensor;
  G_OBJECT_CLASS(simulated_sensor_src_parent_class)->finalize(object);
}

static void
simulated_sensor_src_init(SimulatedSensorSrc *self)
{
  self->sensor = new Sensor;
  gst_base_src_set_live(GST_BASE_SRC(self), TRUE);
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

static void
simulated_sensor_src_class_init(SimulatedSensorSrcClass *klass)
{
  GObjectClass *object = G_OBJECT_CLASS(klass);
  GstElementClass *element = GST_ELEMENT_CLASS(klass);
  GstBaseSrcClass *base = GST_BASE_SRC_CLASS(klass);
  object->set_property = simulated_sensor_src_set_property;
  object->finalize = simulated_sensor_src_finalize;
  g_object_class_install_property(
      object, 1,
      g_param_spec_string("motors", "Motors", "Calibration that the motors are as", nullptr,
                          static_cast<GParamFlags>(G_PARAM_WRITABLE | G_PARAM_STATIC_STRINGS)));
  gst_element_class_set_static_metadata(element, "Simulated sensor", "Source/Audio",
                                        "Hears simulated motors while they are played",
                                        "visuotactile");
  gst_element_class_add_static_pad_template(element, &pad_template);
  base->start = simulated_sensor_src_start;
  base->get_times = simulated_sensor_src_get_times;
  base->query = simulated_sensor_src_query;
  base->event = simulated_sensor_src_event;
  GST_PUSH_SRC_CLASS(klass)->create = simulated_sensor_src_create;
}

static gboolean
plugin_init(GstPlugin *plugin)
{
  return gst_element_register(plugin, "simulatedsensorsrc", GST_RANK_NONE,
                              simulated_sensor_src_get_type());
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, simulatedsensor,
                  "Hears simulated motors; for tests", plugin_init, PACKAGE_VERSION, "LGPL",
                  PACKAGE_NAME, PACKAGE_ORIGIN)
