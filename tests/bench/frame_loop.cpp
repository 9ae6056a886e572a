// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_loop.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <random>

namespace bench {

namespace {

/// I420 frames.
std::vector<cv::Mat>
draw_disc(cv::Size size, Scene scene)
{
  std::mt19937 random(1);
  cv::Mat noise(size.height * 3 / 2, size.width, CV_8UC1);
  for (int y = 0; y < noise.rows; y++)
    for (int x = 0; x < noise.cols; x++)
      noise.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(120 + random() % 8);
  const auto with_disc = [&](int x, int radius) {
    cv::Mat disc = noise.clone();
    cv::circle(disc.rowRange(0, size.height), { x, size.height * 5 / 12 }, radius, 200, cv::FILLED);
    return disc;
  };
  if (scene == Scene::still)
    return { noise };
  const int x = size.width * 3 / 8;
  if (scene == Scene::head)
    return { with_disc(x, size.width / 8), with_disc(x + 1, size.width / 8) };
  return { noise, with_disc(x, size.width / 24) };
}

std::vector<cv::Mat>
draw_pan(cv::Size size)
{
  constexpr int kSteps = 8;
  constexpr int kStep = 4;
  const int side = std::max(1, size.width / 24);
  std::mt19937 random(1);
  std::array<std::uint8_t, 4096> squares{};
  for (std::uint8_t &square : squares)
    square = static_cast<std::uint8_t>(40 + random() % 160);
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 2 * kSteps; i++) {
    const int shift = kStep * (i < kSteps ? i : 2 * kSteps - i);
    cv::Mat frame(size.height * 3 / 2, size.width, CV_8UC1, 128);
    for (int y = 0; y < size.height; y++)
      for (int x = 0; x < size.width; x++)
        frame.at<std::uint8_t>(y, x)
            = squares[static_cast<std::size_t>((x + shift) / side * 61 + y / side * 7)
                      % squares.size()];
    frames.push_back(frame);
  }
  return frames;
}

std::uint8_t
chroma(const cv::Mat &i420, cv::Size size, int component, int x, int y)
{
  const int cw = size.width / 2;
  const int at = size.width * size.height + (component - 1) * cw * (size.height / 2) + y * cw + x;
  return i420.data[at];
}

cv::Mat
packed_422(const cv::Mat &i420, cv::Size size, bool luma_first)
{
  cv::Mat out(size.height, 2 * size.width, CV_8UC1);
  for (int y = 0; y < size.height; y++)
    for (int x = 0; x < size.width; x++) {
      const std::uint8_t color = chroma(i420, size, 1 + x % 2, x / 2, y / 2);
      const std::uint8_t luma = i420.at<std::uint8_t>(y, x);
      out.at<std::uint8_t>(y, 2 * x) = luma_first ? luma : color;
      out.at<std::uint8_t>(y, 2 * x + 1) = luma_first ? color : luma;
    }
  return out;
}

cv::Mat
semi_planar(const cv::Mat &i420, cv::Size size)
{
  cv::Mat out = i420.clone();
  for (int y = 0; y < size.height / 2; y++)
    for (int x = 0; x < size.width; x++)
      out.at<std::uint8_t>(size.height + y, x) = chroma(i420, size, 1 + x % 2, x / 2, y);
  return out;
}

cv::Mat
converted(const cv::Mat &i420, cv::Size size, Format format)
{
  cv::Mat out;
  switch (format) {
  case Format::i420:
    return i420.clone();
  case Format::nv12:
    return semi_planar(i420, size);
  case Format::yuy2:
    return packed_422(i420, size, true);
  case Format::uyvy:
    return packed_422(i420, size, false);
  case Format::rgb:
    cv::cvtColor(i420, out, cv::COLOR_YUV2RGB_I420);
    return out;
  case Format::rgbx:
    cv::cvtColor(i420, out, cv::COLOR_YUV2RGBA_I420);
    return out;
  case Format::i420_10le:
    i420.convertTo(out, CV_16U, 4);
    return out;
  case Format::p010_10le:
    semi_planar(i420, size).convertTo(out, CV_16U, 256);
    return out;
  }
  return out;
}

} // namespace

const char *
name(Format format)
{
  switch (format) {
  case Format::i420:
    return "I420";
  case Format::nv12:
    return "NV12";
  case Format::yuy2:
    return "YUY2";
  case Format::uyvy:
    return "UYVY";
  case Format::rgb:
    return "RGB";
  case Format::rgbx:
    return "RGBx";
  case Format::i420_10le:
    return "I420_10LE";
  case Format::p010_10le:
    return "P010_10LE";
  }
  return "";
}

FrameLoop::FrameLoop(cv::Size size, Scene scene, Format format, std::size_t buffers)
    : size_(size), format_(format)
{
  CV_Assert(size.width % 2 == 0 && size.height % 2 == 0 && !size.empty());
  const auto scenes = scene == Scene::pan ? draw_pan(size) : draw_disc(size, scene);
  for (std::size_t i = 0; i < std::max(scenes.size(), buffers); i++)
    frames_.push_back(converted(scenes[i % scenes.size()], size, format));
}

saliency::FrameView
FrameLoop::view(std::size_t i) const
{
  const int width = size_.width;
  const int height = size_.height;
  const int cw = width / 2;
  const int ch = height / 2;
  const std::uint8_t *data = bytes(i).data;
  const std::ptrdiff_t luma = static_cast<std::ptrdiff_t>(width) * height;

  saliency::FrameView view;
  view.width = width;
  view.height = height;
  switch (format_) {
  case Format::i420:
    view.components = { { { data, width, 1, width, height },
                          { data + luma, cw, 1, cw, ch },
                          { data + luma + luma / 4, cw, 1, cw, ch } } };
    break;
  case Format::nv12:
    view.components = { { { data, width, 1, width, height },
                          { data + luma, width, 2, cw, ch },
                          { data + luma + 1, width, 2, cw, ch } } };
    break;
  case Format::yuy2:
  case Format::uyvy: {
    const std::uint8_t *y = format_ == Format::yuy2 ? data : data + 1;
    const std::uint8_t *uv = format_ == Format::yuy2 ? data + 1 : data;
    view.components = { { { y, 2 * width, 2, width, height },
                          { uv, 2 * width, 4, cw, height },
                          { uv + 2, 2 * width, 4, cw, height } } };
    break;
  }
  case Format::rgb:
  case Format::rgbx: {
    const int step = format_ == Format::rgb ? 3 : 4;
    view.model = saliency::ColorModel::rgb;
    for (std::size_t c = 0; c < 3; c++)
      view.components[c] = { data + c, step * width, step, width, height };
    break;
  }
  case Format::i420_10le:
    view.depth = 10;
    view.components = { { { data, 2 * width, 2, width, height },
                          { data + 2 * luma, width, 2, cw, ch },
                          { data + 2 * luma + luma / 2, width, 2, cw, ch } } };
    break;
  case Format::p010_10le:
    view.depth = 10;
    view.shift = 6;
    view.components = { { { data, 2 * width, 2, width, height },
                          { data + 2 * luma, 2 * width, 4, cw, ch },
                          { data + 2 * luma + 2, 2 * width, 4, cw, ch } } };
    break;
  }
  return view;
}

} // namespace bench
