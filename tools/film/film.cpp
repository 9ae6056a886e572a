// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film.h"

#include "pipeline.h"
#include "translation.h"

#include <gst/pbutils/pbutils.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <unistd.h>

namespace {

constexpr int kSyntheticSide = 640;
constexpr int kSyntheticFps = 30;
constexpr int kStaticSeconds = 15;
constexpr int kDynamicSeconds = 10;

std::string
to_uri(const std::string &path)
{
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    // After the path: "Part 2: the return.mkv" is a valid URI, too.
    if (gst_uri_is_valid(path.c_str()))
      return path;
    throw std::runtime_error(in_text(
        "there is no film '{}'; give the path of a film, or none for the built-in one", path));
  }
  if (std::filesystem::is_directory(path, error))
    throw std::runtime_error(in_text("'{}' is a folder; give the path of a film", path));
  if (std::filesystem::is_other(path, error) && !std::filesystem::is_block_file(path, error))
    throw std::runtime_error(in_text(
        "'{}' is a pipe or a device, which cannot be played; give the path of a film", path));
  if (access(path.c_str(), R_OK) != 0)
    throw std::runtime_error(
        in_text("cannot read '{}': {}", path, std::generic_category().message(errno)));
  g_autofree gchar *uri = gst_filename_to_uri(path.c_str(), nullptr);
  if (!uri)
    throw std::runtime_error(in_text("cannot make a URI of '{}'", path));
  return uri;
}

std::string
missing_plugins(GstDiscovererInfo *info)
{
  std::string names;
  for (const gchar **detail = gst_discoverer_info_get_missing_elements_installer_details(info);
       detail && *detail; detail++) {
    // gstreamer|1.0|program|description|what
    g_auto(GStrv) fields = g_strsplit(*detail, "|", 5);
    if (g_strv_length(fields) >= 4)
      names += (names.empty() ? "" : ", ") + std::string(fields[3]);
  }
  return names;
}

/// What browsers call the film's container and codecs. Empty if they have no name for it.
std::string
type_of(GstDiscovererInfo *info)
{
  g_autoptr(GstDiscovererStreamInfo) top = gst_discoverer_info_get_stream_info(info);
  if (!top || !GST_IS_DISCOVERER_CONTAINER_INFO(top))
    return "";
  g_autoptr(GstCaps) container = gst_discoverer_stream_info_get_caps(top);
  std::string type = gst_structure_get_name(gst_caps_get_structure(container, 0));
  if (type == "video/quicktime")
    type = "video/mp4";
  else if (type == "application/ogg")
    type = "video/ogg";
  std::string codecs;
  GList *streams = gst_discoverer_info_get_stream_list(info);
  for (GList *item = streams; item; item = item->next) {
    auto *stream = GST_DISCOVERER_STREAM_INFO(item->data);
    if (!GST_IS_DISCOVERER_VIDEO_INFO(stream) && !GST_IS_DISCOVERER_AUDIO_INFO(stream))
      continue;
    g_autoptr(GstCaps) caps = gst_discoverer_stream_info_get_caps(stream);
    g_autofree gchar *codec
        = gst_caps_is_fixed(caps) ? gst_codec_utils_caps_get_mime_codec(caps) : nullptr;
    // "vp08" without profile and level is no name that browsers know.
    const std::string name = codec == nullptr             ? ""
                             : g_str_equal(codec, "vp08") ? "vp8"
                             : g_str_equal(codec, "vp09") ? "vp9"
                                                          : codec;
    if (!name.empty())
      codecs += (codecs.empty() ? "" : ", ") + name;
  }
  gst_discoverer_stream_info_list_free(streams);
  return codecs.empty() ? type : type + "; codecs=\"" + codecs + "\"";
}

} // namespace

Film
synthetic_film()
{
  return { .uri = "",
           .title = "synthetic film (static motion, then dynamic motion)",
           .width = kSyntheticSide,
           .height = kSyntheticSide,
           .fps = kSyntheticFps,
           .has_sound = false,
           .duration = (kStaticSeconds + kDynamicSeconds) * GST_SECOND };
}

Film
discover_film(const std::string &path_or_uri)
{
  Film film;
  film.uri = to_uri(path_or_uri);
  film.title = path_or_uri;

  g_autoptr(GError) error = nullptr;
  const std::unique_ptr<GstDiscoverer, GstUnref> discoverer(
      gst_discoverer_new(20 * GST_SECOND, &error));
  if (!discoverer)
    throw std::runtime_error(error->message);
  const StartWatch start(discoverer.get());
  const std::unique_ptr<GstDiscovererInfo, GstUnref> info(
      gst_discoverer_discover_uri(discoverer.get(), film.uri.c_str(), &error));
  if (!info)
    throw std::runtime_error(
        in_text("cannot open '{}': {}", path_or_uri, (error ? error->message : "no reason given")));

  const std::string missing = missing_plugins(info.get());
  GList *videos = gst_discoverer_info_get_video_streams(info.get());
  GstDiscovererVideoInfo *video = nullptr;
  for (GList *item = videos; item && !video; item = item->next)
    if (!gst_discoverer_video_info_is_image(GST_DISCOVERER_VIDEO_INFO(item->data)))
      video = GST_DISCOVERER_VIDEO_INFO(item->data);
  if (video) {
    film.width = static_cast<int>(gst_discoverer_video_info_get_width(video));
    film.height = static_cast<int>(gst_discoverer_video_info_get_height(video));
    film.pixel_aspect = static_cast<double>(gst_discoverer_video_info_get_par_num(video))
                        / std::max(1U, gst_discoverer_video_info_get_par_denom(video));
    const guint denominator = gst_discoverer_video_info_get_framerate_denom(video);
    film.fps = denominator ? static_cast<double>(gst_discoverer_video_info_get_framerate_num(video))
                                 / denominator
                           : 0;
  }
  gst_discoverer_stream_info_list_free(videos);
  GList *sounds = gst_discoverer_info_get_audio_streams(info.get());
  film.has_sound = sounds != nullptr;
  gst_discoverer_stream_info_list_free(sounds);
  film.start = start.times();
  film.type = type_of(info.get());
  const GstClockTime duration = gst_discoverer_info_get_duration(info.get());
  if (duration > 0)
    film.duration = duration;

  if (!missing.empty() && film.width == 0)
    throw std::runtime_error(in_text(
        "'{}' needs plugins that are not installed: {}; gstreamer1.0-plugins-bad may have it",
        path_or_uri, missing));
  if (gst_discoverer_info_get_result(info.get()) != GST_DISCOVERER_OK && film.width == 0)
    throw std::runtime_error(in_text("'{}' is not a film that GStreamer can decode: {}",
                                     path_or_uri,
                                     (error ? error->message : "unknown kind of file")));
  if (!video)
    throw std::runtime_error(in_text("'{}' has no moving picture; expected a film", path_or_uri));
  return film;
}

std::string
film_source(const Film &film)
{
  if (!film.uri.empty())
    return "uridecodebin name=film uri=" + launch_value(film.uri);
  const std::string caps = "video/x-raw,width=" + std::to_string(kSyntheticSide)
                           + ",height=" + std::to_string(kSyntheticSide)
                           + ",framerate=" + std::to_string(kSyntheticFps) + "/1";
  return "tactiletestsrc pattern=static-motion num-buffers="
         + std::to_string(kStaticSeconds * kSyntheticFps) + " ! " + caps
         + " ! concat name=film  tactiletestsrc pattern=dynamic-motion num-buffers="
         + std::to_string(kDynamicSeconds * kSyntheticFps) + " ! " + caps + " ! film. ";
}
