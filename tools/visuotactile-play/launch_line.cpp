// SPDX-License-Identifier: LGPL-2.1-or-later
#include "launch_line.h"

#include "film/pipeline.h"
#include "translation.h"

#include <gst/gst.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace {

/// Twice the 190 ms by which tactorsink needs its data early.
constexpr const char *kLookahead
    = "queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000";

/// The smallest width and height that the encoders accept.
constexpr int kSmallestSide = 16;

bool
have_element(const char *name)
{
  GstElementFactory *factory = gst_element_factory_find(name);
  if (factory)
    gst_object_unref(factory);
  return factory != nullptr;
}

/// Scales to an even size, which encoders need, and to one size for the whole file.
std::string
recorded_size(const Film &film)
{
  const auto even = [](int side) {
    return std::to_string(std::max(side + side % 2, kSmallestSide));
  };
  return "videoscale ! video/x-raw,width=" + even(film.width) + ",height=" + even(film.height)
         + " ! ";
}

/// The pipeline, with or without the names of the files that it writes.
std::string
pipeline_line(const Film &film, const PlaySettings &settings, bool with_files)
{
  const std::string look = kLookahead;
  const auto file = [with_files](const char *property, const std::string &name) {
    return with_files ? std::string(" ") + property + "=" + launch_value(name) : "";
  };
  const fusion::Profile *sound = film.has_sound ? settings.sound : nullptr;
  // videoconvert passes the formats of most films, which saliencytactile takes.
  std::string line
      = film_source(film) + " film. ! " + look + " ! videoconvert ! saliencytactile name=analysis "
        + settings.analysis_options + (settings.meter ? " attach-saliency=true" : "")
        + joined_sound(look, sound)
        + (settings.track.empty() ? "" : " ! tactilecombiner name=track mix=replace")
        + " ! tactileextractor name=split split.tactile ! " + look + " ! " + settings.chair
        + " name=chair"
        + (settings.commands.empty() ? "" : file("trace-location", settings.commands))
        + " split.src ! " + look + " ! " + (settings.overlay ? "tactileoverlay" : "identity")
        + " name=overlay" + (settings.meter ? " meter=true" : "") + " ! videoconvert ! ";
  if (!settings.picture.empty())
    line += settings.picture;
  else if (settings.window)
    line += (have_element("textoverlay")
                 ? "textoverlay name=words silent=true valignment=top halignment=left ! "
                 : "")
            + std::string("autovideosink");
  else if (settings.recording.empty())
    line += "fakesink sync=true";
  else
    line += recorded_size(film) + video_encoder() + " ! " + look
            + " ! matroskamux name=mux ! filesink name=recorder async=false"
            + file("location", settings.recording);
  if (!settings.track.empty())
    line += " filesrc location=" + launch_value(settings.track)
            + " ! subparse ! tactileconverter ! queue ! track.tactile";
  if (film.has_sound)
    line += heard_sound(look, sound) + "audioresample ! "
            + (settings.window              ? "autoaudiosink"
               : settings.recording.empty() ? "fakesink sync=true"
                                            : "vorbisenc ! " + look + " ! mux.");
  return line;
}

} // namespace

std::string
video_encoder()
{
  // Encoders without lookahead: the film is recorded in real time, on the chair's clock.
  if (have_element("x264enc"))
    return "x264enc speed-preset=ultrafast tune=zerolatency pass=quant quantizer=23 key-int-max=60";
  if (have_element("vp9enc"))
    return "vp9enc deadline=1 cpu-used=8 target-bitrate=4000000 keyframe-max-dist=60";
  throw std::runtime_error(_("cannot record: neither x264enc (gstreamer1.0-plugins-ugly) nor "
                             "vp9enc (gstreamer1.0-plugins-good) is installed"));
}

std::string
launch_line(const Film &film, const PlaySettings &settings)
{
  return pipeline_line(film, settings, false);
}

std::string
shell_command(const Film &film, const PlaySettings &settings)
{
  const std::string line = pipeline_line(film, settings, true);
  std::string command = "gst-launch-1.0 -e";
  // Words end at spaces outside of double quotes. Those with special characters are quoted for the
  // shell, too.
  bool in_quotes = false;
  std::string word;
  const auto add_word = [&] {
    const auto is_plain = [](char c) {
      return g_ascii_isalnum(c) || std::strchr("_-./:%=,", c);
    };
    if (word == "!" || std::ranges::all_of(word, is_plain)) {
      command += (word.empty() ? "" : " ") + word;
    } else {
      g_autofree gchar *in_shell_quotes = g_shell_quote(word.c_str());
      command += std::string(" ") + in_shell_quotes;
    }
    word.clear();
  };
  for (std::size_t i = 0; i < line.size(); i++) {
    if (line[i] == ' ' && !in_quotes) {
      add_word();
      continue;
    }
    if (line[i] == '"')
      in_quotes = !in_quotes;
    else if (line[i] == '\\')
      word += line[i++];
    word += line[i];
  }
  add_word();
  return command;
}
