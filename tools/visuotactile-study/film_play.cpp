// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_play.h"

#include "../visuotactile-play/display.h"
#include "../visuotactile-play/launch_line.h"

#include "chair/settings.h"
#include "film/command_line.h"
#include "film/device_list.h"
#include "film/frame_times.h"
#include "film/known_driver.h"
#include "translation.h"

#include <gst/video/videooverlay.h>

#include <algorithm>
#include <initializer_list>
#include <stdexcept>

namespace {

using Outcome = study::Play::Outcome;

constexpr const char *kNoNoise = "no-noise";   ///< the masking noise was not heard
constexpr const char *kNotShown = "not-shown"; ///< nobody has seen the film

std::string
setting(const study::Settings &settings, const char *name, const char *otherwise = "")
{
  const auto found = settings.find(name);
  return found == settings.end() ? otherwise : found->second;
}

/// " name=value" for each that is set.
std::string
properties(const study::Settings &settings, std::initializer_list<const char *> names)
{
  std::string line;
  for (const char *name : names)
    if (const auto found = settings.find(name); found != settings.end())
      line += std::string(" ") + name + "=" + launch_value(found->second);
  return line;
}

/// The sink of the maps, as on a launch line.
std::string
chair_line(const study::Settings &settings)
{
  const std::string driver = setting(settings, "driver", "auto");
  const std::string device = setting(settings, "device");
  const std::string shared
      = properties(settings, { "intensity", "rate", "mapping", "calibration" });
  if (driver == kAudio)
    return "tactoraudiosink" + shared
           + (device.empty() ? "" : " audio-sink=" + launch_value(audio_sink(device)));
  return "tactorsink" + shared + properties(settings, { "driver", "device", "compensation" });
}

PlaySettings
play_settings(const FilmPlay::Order &order, const FilmWindow *window)
{
  PlaySettings settings;
  settings.window = order.window;
  settings.picture
      = order.window ? "autovideosink name=picture" : "fakesink sync=true name=picture";
  if (window)
    settings.picture = "videoscale ! video/x-raw,width=" + std::to_string(window->width())
                       + ",height=" + std::to_string(window->height())
                       + ",pixel-aspect-ratio=1/1 ! " + settings.picture;
  settings.overlay = false;
  settings.quiet = true;
  settings.has_trace = true;
  settings.commands = order.trace;
  settings.analysis_options
      = properties(order.settings, { "profile", "rows", "columns", "sensitivity", "density" });
  // Not `auto`: all participants are to feel the same.
  settings.analysis_options += " people=" + setting(order.settings, "people", "off");
  settings.chair = chair_line(order.settings);
  settings.sound = sound_profile(setting(order.settings, "sound", "off"));
  return settings;
}

} // namespace

FilmPlay::FilmPlay(const Order &order, std::function<void(const study::Play &)> ended)
    : ended_(std::move(ended)), trace_(order.trace),
      is_audio_(setting(order.settings, "driver") == kAudio),
      intensity_(static_cast<float>(
          g_ascii_strtod(setting(order.settings, "intensity", "1").c_str(), nullptr)))
{
  const Film film = discover_film(order.film);
  if (order.window && order.screen)
    window_ = std::make_unique<FilmWindow>(
        monitor(order.screen->name), static_cast<int>(film.width * film.pixel_aspect), film.height,
        [this] { stop("Escape was pressed, or the film's window was closed"); });
  pipeline_ = make_pipeline(launch_line(film, play_settings(order, window_.get())));
  let_times_advance(
      Owned<GstPad>(gst_element_get_static_pad(element(pipeline_, "analysis").get(), "sink"))
          .get());
  chair_ = element(pipeline_, "chair");
  g_object_set(chair_.get(), "trace-location", trace_.c_str(), nullptr);
  if (film.has_sound)
    g_signal_connect(element(pipeline_, "film").get(), "no-more-pads",
                     G_CALLBACK(+[](GstElement *, gpointer pipeline) {
                       end_missing_sound(static_cast<GstElement *>(pipeline));
                     }),
                     pipeline_.get());
  gst_pad_add_probe(
      Owned<GstPad>(gst_element_get_static_pad(chair_.get(), "sink")).get(),
      GST_PAD_PROBE_TYPE_BUFFER,
      +[](GstPad *pad, GstPadProbeInfo *info, gpointer self) {
        static_cast<FilmPlay *>(self)->on_map(pad, GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_OK;
      },
      this, nullptr);
  const double noise = g_ascii_strtod(setting(order.settings, "noise", "0").c_str(), nullptr);
  if (!order.window)
    result_.doubts.emplace_back(kNotShown);
  if (noise > 0 && !order.window)
    result_.doubts.emplace_back(kNoNoise);
  if (noise > 0 && order.window) {
    noise_ = make_pipeline("audiotestsrc wave=pink-noise volume=" + study::write_number(noise)
                           + " ! audioconvert ! audioresample ! autoaudiosink");
    gst_element_set_state(noise_.get(), GST_STATE_PLAYING);
  }
  const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
  if (window_)
    gst_bus_set_sync_handler(
        bus.get(),
        +[](GstBus *, GstMessage *message, gpointer window) { // in a streaming thread
          if (!gst_is_video_overlay_prepare_window_handle_message(message))
            return GST_BUS_PASS;
          // Keys are the window's, which they end.
          gst_video_overlay_handle_events(GST_VIDEO_OVERLAY(GST_MESSAGE_SRC(message)), FALSE);
          gst_video_overlay_set_window_handle(GST_VIDEO_OVERLAY(GST_MESSAGE_SRC(message)),
                                              static_cast<FilmWindow *>(window)->handle());
          gst_message_unref(message);
          return GST_BUS_DROP;
        },
        window_.get(), nullptr);
  if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE)
    throw std::runtime_error(start_error(bus.get()));
  watch_ = gst_bus_add_watch(
      bus.get(),
      +[](GstBus *, GstMessage *message, gpointer self) {
        return static_cast<FilmPlay *>(self)->on_message(message);
      },
      this);
}

FilmPlay::~FilmPlay()
{
  if (watch_ != 0)
    g_source_remove(watch_);
  if (pipeline_) // before the object that the probe uses is deleted
    gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
}

void
FilmPlay::stop(const std::string &why)
{
  if (watch_ != 0)
    g_source_remove(watch_);
  end(Outcome::stopped, why);
}

ChairLevels
FilmPlay::levels() const
{
  const std::lock_guard lock(mutex_);
  return levels_;
}

/// In a streaming thread.
void
FilmPlay::on_map(GstPad *pad, GstBuffer *map)
{
  GstCaps *current = gst_pad_get_current_caps(pad);
  gint rows = 0;
  gint columns = 0;
  const GstStructure *structure = current ? gst_caps_get_structure(current, 0) : nullptr;
  const bool is_map = structure && gst_structure_get_int(structure, "rows", &rows)
                      && gst_structure_get_int(structure, "columns", &columns);
  if (current)
    gst_caps_unref(current);
  if (!is_map)
    return;
  std::vector<float> levels(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
  const gsize size = levels.size() * sizeof(float);
  if (gst_buffer_extract(map, 0, levels.data(), size) != size)
    return; // a gap
  for (float &level : levels)
    level *= intensity_;
  const std::lock_guard lock(mutex_);
  levels_ = { .rows = static_cast<unsigned>(rows),
              .columns = static_cast<unsigned>(columns),
              .levels = std::move(levels),
              .position = static_cast<double>(GST_BUFFER_PTS(map)) / GST_SECOND };
}

bool
FilmPlay::is_picture(GstObject *object) const
{
  return object == GST_OBJECT(element(pipeline_, "picture").get());
}

gboolean
FilmPlay::on_message(GstMessage *message)
{
  const bool of_chair
      = GST_MESSAGE_SRC(message) == GST_OBJECT(chair_.get())
        || gst_object_has_as_ancestor(GST_MESSAGE_SRC(message), GST_OBJECT(chair_.get()));
  g_autoptr(GError) error = nullptr;
  switch (GST_MESSAGE_TYPE(message)) {
  case GST_MESSAGE_EOS:
    watch_ = 0;
    end(Outcome::ended, "");
    return G_SOURCE_REMOVE;
  case GST_MESSAGE_ERROR:
    gst_message_parse_error(message, &error, nullptr);
    watch_ = 0;
    if (of_chair)
      result_.chair = error->message;
    end(Outcome::failed, error->message);
    return G_SOURCE_REMOVE;
  case GST_MESSAGE_WARNING:
    gst_message_parse_warning(message, &error, nullptr);
    if (of_chair)
      result_.chair = error->message;
    else if (is_picture(GST_MESSAGE_SRC(message))
             && std::ranges::find(result_.doubts, kNotShown) == result_.doubts.end())
      result_.doubts.emplace_back(kNotShown); // autovideosink has found no sink
    break;
  case GST_MESSAGE_INFO:
    gst_message_parse_info(message, &error, nullptr);
    if (of_chair)
      told_ = error->message;
    break;
  case GST_MESSAGE_LATENCY:
    gst_bin_recalculate_latency(GST_BIN(pipeline_.get()));
    break;
  default:
    break;
  }
  return G_SOURCE_CONTINUE;
}

/// Reads the statistics of the picture's sink.
void
FilmPlay::count_frames()
{
  const Owned<GstElement> picture = element(pipeline_, "picture");
  GstElement *sink = picture.get();
  while (GST_IS_BIN(sink) && GST_BIN_CHILDREN(sink))
    sink = GST_ELEMENT(GST_BIN_CHILDREN(sink)->data);
  g_autoptr(GstStructure) stats = nullptr;
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(sink), "stats"))
    g_object_get(sink, "stats", &stats, nullptr);
  guint64 rendered = 0;
  guint64 dropped = 0;
  if (stats && gst_structure_get_uint64(stats, "rendered", &rendered)
      && gst_structure_get_uint64(stats, "dropped", &dropped)) {
    result_.frames = static_cast<std::int64_t>(rendered);
    result_.frames_dropped = static_cast<std::int64_t>(dropped);
  }
}

void
FilmPlay::end(Outcome outcome, const std::string &text)
{
  watch_ = 0;
  // Motors to zero before all that may take its time: an audio server may hang. The other sinks go
  // on, as the picture's loses its counts when it pauses. Locked, as a bin that plays sets a child
  // that has paused to PLAYING again.
  gst_element_set_locked_state(chair_.get(), TRUE);
  gst_element_set_state(chair_.get(), GST_STATE_PAUSED);
  if (noise_) {
    const Owned<GstBus> bus(gst_element_get_bus(noise_.get()));
    // Without a sound card, autoaudiosink posts a warning and plays to nobody.
    if (GstMessage *fault = gst_bus_pop_filtered(
            bus.get(), static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_WARNING))) {
      result_.doubts.emplace_back(kNoNoise);
      gst_message_unref(fault);
    }
  }
  noise_.reset();
  count_frames();
  result_.outcome = outcome;
  result_.text = text;
  if (!is_audio_ && result_.chair.empty())
    try {
      if (is_simulated(chair_.get(), told_))
        result_.doubts.emplace_back("simulated");
    } catch (const std::runtime_error &error) {
      result_.chair = error.what();
    }
  gst_element_set_state(chair_.get(), GST_STATE_NULL); // before the film's sound, which may hang
  gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
  window_.reset();
  if (motors_may_run(chair_.get()))
    result_.chair = "the motors may still be on";
  if (const auto timing = study::read_timing(trace_))
    result_.timing = *timing;
  else if (result_.chair.empty())
    result_.chair = timing.error();
  ended_(result_); // may delete this
}

void
expect_playable(const std::string &film, const study::Settings &settings)
{
  try {
    expect_driver(setting(settings, "driver", "auto"), kAudio);
  } catch (const UsageError &error) {
    throw std::runtime_error(
        in_text("the settings of a session: {}", std::string(error.what()).substr(2))); // no --
  }
  sound_profile(setting(settings, "sound", "off"));
  discover_film(film);
}

study::Settings
user_defaults(const char *program)
{
  chair::Settings user = chair::read_settings();
  for (const std::string &complaint : user.complaints)
    print_error(program, complaint);
  if (const auto grid = user.values.find(chair::kGrid); grid != user.values.end()) {
    const chair::Grid size = chair::parse_grid(grid->second);
    user.values["rows"] = std::to_string(size.rows);
    user.values["columns"] = std::to_string(size.columns);
  }
  for (const char *name : { chair::kGrid, chair::kEnabled, "mute" }) // of no session
    user.values.erase(name);
  return user.values;
}

void
add_defaults(study::Settings &settings, const study::Settings &defaults)
{
  const bool has_driver = setting(settings, "driver", setting(defaults, "driver", "auto").c_str())
                          == setting(defaults, "driver", "auto");
  const bool has_grid = settings.contains("rows") || settings.contains("columns");
  for (const auto &[name, value] : defaults) {
    const bool of_grid = name == "rows" || name == "columns" || name == "mapping";
    const bool of_driver = of_grid || name == "device" || name == "calibration";
    if ((has_driver || !of_driver) && !(has_grid && of_grid))
      settings.emplace(name, value);
  }
}

bool
can_show_films()
{
  return !video_sink().empty();
}
