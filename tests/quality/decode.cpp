// SPDX-License-Identifier: LGPL-2.1-or-later
#include "decode.h"

#include <gst/app/gstappsink.h>

#include <algorithm>
#include <set>
#include <stdexcept>

namespace quality {

namespace {

constexpr GstClockTime kPatience = 20 * GST_SECOND;

} // namespace

void
Decoder::Unref::operator()(GstElement *element) const
{
  gst_element_set_state(element, GST_STATE_NULL);
  gst_object_unref(element);
}

void
Decoder::Unref::operator()(GstSample *sample) const
{
  gst_sample_unref(sample);
}

Decoder::Decoder(const std::filesystem::path &file, const char *decoder, const char *format)
    : name_(file.string())
{
  gst_video_info_init(&info_);
  const std::string launch = std::string("filesrc name=source ! ") + decoder
                             + " ! videoconvert ! video/x-raw,format=" + format
                             + " ! appsink name=sink sync=false max-buffers=4";
  g_autoptr(GError) error = nullptr;
  pipeline_.reset(gst_parse_launch(launch.c_str(), &error));
  if (!pipeline_ || error)
    throw std::runtime_error(name_ + ": cannot decode: " + (error ? error->message : "no pipeline")
                             + " (tools/setup.sh play)");
  g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline_.get()), "source");
  sink_ = gst_bin_get_by_name(GST_BIN(pipeline_.get()), "sink");
  gst_object_unref(sink_);
  g_object_set(source, "location", name_.c_str(), nullptr);
  gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING);
}

Decoder::~Decoder() = default;

bool
Decoder::next()
{
  mapping_.reset();
  sample_.reset(gst_app_sink_try_pull_sample(GST_APP_SINK(sink_), kPatience));
  if (!sample_) {
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_.get());
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    g_autoptr(GError) error = nullptr;
    if (message)
      gst_message_parse_error(message, &error, nullptr);
    if (error || !gst_app_sink_is_eos(GST_APP_SINK(sink_)))
      throw std::runtime_error(name_ + ": " + (error ? error->message : "no frame for too long"));
    return false;
  }
  if (!gst_video_info_from_caps(&info_, gst_sample_get_caps(sample_.get())))
    throw std::runtime_error(name_ + ": a frame without format");
  mapping_ = std::make_unique<FrameMapping>(info_, gst_sample_get_buffer(sample_.get()));
  if (!*mapping_)
    throw std::runtime_error(name_ + ": a frame cannot be read");
  return true;
}

std::chrono::nanoseconds
Decoder::time() const
{
  const GstBuffer *buffer = gst_sample_get_buffer(sample_.get());
  if (!GST_BUFFER_PTS_IS_VALID(buffer))
    throw std::runtime_error(name_ + ": a frame without time");
  return std::chrono::nanoseconds(GST_BUFFER_PTS(buffer));
}

std::chrono::nanoseconds
Decoder::duration() const
{
  const GstBuffer *buffer = gst_sample_get_buffer(sample_.get());
  return std::chrono::nanoseconds(
      GST_BUFFER_DURATION_IS_VALID(buffer) ? GST_BUFFER_DURATION(buffer)
      : info_.fps_n > 0 ? gst_util_uint64_scale_int(GST_SECOND, info_.fps_d, info_.fps_n)
                        : GST_SECOND / 30);
}

cv::Mat
as_mat(const saliency::FrameView &bgr)
{
  const auto &blue = bgr.components[2];
  return { bgr.height, bgr.width, CV_8UC3, const_cast<std::uint8_t *>(blue.data),
           static_cast<std::size_t>(blue.row_stride) };
}

std::vector<std::filesystem::path>
list_films(const std::filesystem::path &directory)
{
  static const std::set<std::filesystem::path> kFilms{ ".avi", ".m4v", ".mkv", ".mov", ".mp4",
                                                       ".mpg", ".ogv", ".ts",  ".webm" };
  std::vector<std::filesystem::path> films;
  std::error_code error;
  for (const auto &entry : std::filesystem::directory_iterator(directory, error))
    if (kFilms.contains(entry.path().extension()))
      films.push_back(entry.path());
  if (films.empty())
    throw std::runtime_error(directory.string() + ": no films there");
  std::ranges::sort(films);
  return films;
}

} // namespace quality
