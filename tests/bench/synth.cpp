// SPDX-License-Identifier: LGPL-2.1-or-later
//
// CPU time of tactilesynth, all threads of a pipeline that plays a minute of maps as fast as it
// can: appsrc, tactilesynth, fakesink. Medians of runs, as Markdown.
#include <gst/gst.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace {

constexpr int kFramesPerSecond = 30;
constexpr int kSeconds = 60;
constexpr int kRuns = 5;

double
cpu_seconds()
{
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) / 1e9;
}

/// Maps in which each cell changes with each frame.
std::vector<GstBuffer *>
make_maps(int cells)
{
  std::vector<GstBuffer *> maps;
  std::vector<gfloat> levels(static_cast<std::size_t>(cells));
  for (int i = 0; i < kSeconds * kFramesPerSecond; i++) {
    for (std::size_t cell = 0; cell < levels.size(); cell++)
      levels[cell] = static_cast<float>((static_cast<std::size_t>(i) * 7 + cell * 3) % 11 + 1) / 11;
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = gst_util_uint64_scale_int(GST_SECOND, i, kFramesPerSecond);
    GST_BUFFER_DURATION(map) = GST_SECOND / kFramesPerSecond;
    maps.push_back(map);
  }
  return maps;
}

/// Seconds of CPU for the minute. Ends the program if the pipeline fails.
double
play(int cells, const std::string &properties)
{
  const std::string line = "appsrc name=source format=time caps=application/x-tactile-map,rows=1,"
                           "columns="
                           + std::to_string(cells)
                           + ",framerate=30/1 ! tactilesynth max-on-time=0 max-duty=0 max-active=0 "
                           + properties + " ! audio/x-raw,rate=48000 ! fakesink sync=false";
  GstElement *pipeline = gst_parse_launch(line.c_str(), nullptr);
  g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline), "source");
  const std::vector<GstBuffer *> maps = make_maps(cells);
  const double before = cpu_seconds();
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstFlowReturn flow = GST_FLOW_OK;
  for (GstBuffer *map : maps)
    g_signal_emit_by_name(source, "push-buffer", map, &flow);
  g_signal_emit_by_name(source, "end-of-stream", &flow);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  const double seconds = cpu_seconds() - before;
  const bool ended = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  std::ranges::for_each(maps, gst_buffer_unref);
  if (!ended) {
    std::fprintf(stderr, "synth: '%s' fails; is it on GST_PLUGIN_PATH?\n", line.c_str());
    std::exit(1);
  }
  return seconds;
}

} // namespace

int
main(int argc, char **argv)
{
  gst_init(&argc, &argv);
  std::printf(
      "| channels at 48 kHz | carrier | ms of CPU a second | of a core |\n|---|---|---|---|\n");
  for (const int channels : { 2, 9, 64 })
    for (const char *carrier : { "sine", "noise" }) {
      std::vector<double> runs;
      for (int run = 0; run < kRuns; run++)
        runs.push_back(play(channels, std::string("waveform=") + carrier) / kSeconds);
      std::ranges::sort(runs);
      const double median = runs[kRuns / 2];
      std::printf("| %d | %s | %.2f | %.2f %% |\n", channels, carrier, median * 1e3, median * 100);
    }
}
