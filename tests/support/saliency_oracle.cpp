// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/saliency_oracle.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <thread>
#include <utility>

namespace oracle {

Image
random_image(int width, int height, double low, double high, unsigned seed)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> value(low, high);
  Image image(width, height);
  for (auto &v : image.values)
    v = static_cast<double>(static_cast<float>(value(generator)));
  return image;
}

LabImage
picture_of_many_scales(int width, int height, unsigned seed)
{
  LabImage lab;
  for (std::size_t c = 0; c < 3; ++c) {
    lab[c] = random_image(width, height, c == 0 ? 20 : -30, c == 0 ? 60 : 30,
                          seed + static_cast<unsigned>(c));
    const auto coarse = random_image((width + 7) / 8, (height + 7) / 8, -20, 30,
                                     seed + 10 + static_cast<unsigned>(c));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        lab[c](x, y) += coarse(x / 8, y / 8);
  }
  return lab;
}

cv::Mat
to_mat(const Image &image)
{
  cv::Mat mat(image.height, image.width, CV_32FC1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      mat.at<float>(y, x) = static_cast<float>(image(x, y));
  return mat;
}

saliency::LabImage
to_planes(const LabImage &image)
{
  return { { to_mat(image[0]), to_mat(image[1]), to_mat(image[2]) } };
}

double
difference(const cv::Mat &mat, const Image &image)
{
  if (mat.type() != CV_32FC1 || mat.cols != image.width || mat.rows != image.height)
    return INFINITY;
  double largest = 0;
  for (int y = 0; y < mat.rows; ++y)
    for (int x = 0; x < mat.cols; ++x) {
      const double d = std::abs(static_cast<double>(mat.at<float>(y, x)) - image(x, y));
      if (!std::isfinite(d))
        return INFINITY;
      largest = std::max(largest, d);
    }
  return largest;
}

double
difference(const saliency::LabImage &found, const LabImage &image)
{
  for (const auto &plane : found.planes)
    if (plane.type() != CV_32FC1 || plane.cols != image[0].width || plane.rows != image[0].height)
      return INFINITY;
  double largest = 0;
  for (int y = 0; y < image[0].height; ++y)
    for (int x = 0; x < image[0].width; ++x) {
      double squared = 0;
      for (std::size_t c = 0; c < 3; ++c)
        squared
            += std::pow(static_cast<double>(found.planes[c].at<float>(y, x)) - image[c](x, y), 2);
      if (!std::isfinite(squared))
        return INFINITY;
      largest = std::max(largest, std::sqrt(squared));
    }
  return largest;
}

double
difference(const saliency::FixedLabImage &found, const LabImage &image)
{
  return difference(saliency::to_float(found), image);
}

// ---- color

Lab
rgb_to_lab(std::array<double, 3> rgb)
{
  for (double &v : rgb) {
    v = std::clamp(v, 0.0, 1.0);
    v = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  const double x = 0.4124564 * rgb[0] + 0.3575761 * rgb[1] + 0.1804375 * rgb[2];
  const double y = 0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2];
  const double z = 0.0193339 * rgb[0] + 0.1191920 * rgb[1] + 0.9503041 * rgb[2];
  const auto f = [](double t) {
    return t > 216.0 / 24389 ? std::pow(t, 1.0 / 3) : (24389.0 / 27 * t + 16) / 116;
  };
  const double fx = f(x / 0.95047);
  const double fy = f(y / 1.0);
  const double fz = f(z / 1.08883);
  return { 116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz) };
}

Lab
samples_to_lab(std::array<double, 3> code, saliency::ColorModel model, int depth, bool full_range,
               saliency::YuvMatrix matrix)
{
  const double all = std::pow(2.0, depth) - 1;
  const double step = std::pow(2.0, depth - 8);
  if (model == saliency::ColorModel::rgb)
    return rgb_to_lab({ code[0] / all, code[1] / all, code[2] / all });
  const double y = full_range ? code[0] / all : (code[0] / step - 16) / 219;
  if (model == saliency::ColorModel::gray)
    return rgb_to_lab({ y, y, y });
  const double cb = full_range ? (code[1] - 128 * step) / all : (code[1] / step - 128) / 224;
  const double cr = full_range ? (code[2] - 128 * step) / all : (code[2] / step - 128) / 224;
  // Cb = (B' - Y') / (2 (1 - kb)), Cr = (R' - Y') / (2 (1 - kr)), Y' = kr R' + kg G' + kb B'
  const double r = y + 2 * (1 - matrix.kr) * cr;
  const double b = y + 2 * (1 - matrix.kb) * cb;
  const double g = (y - matrix.kr * r - matrix.kb * b) / (1 - matrix.kr - matrix.kb);
  return rgb_to_lab({ r, g, b });
}

// ---- pyramid

namespace {

int
mirror(int i, int length)
{
  if (length == 1)
    return 0;
  while (i < 0 || i >= length)
    i = i < 0 ? -i : 2 * (length - 1) - i;
  return i;
}

} // namespace

Image
pyr_down(const Image &image, bool along_x, bool along_y)
{
  static constexpr double tap[] = { 1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16 };
  const int step_x = along_x ? 2 : 1;
  const int step_y = along_y ? 2 : 1;
  Image half((image.width + step_x - 1) / step_x, (image.height + step_y - 1) / step_y);
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x) {
      double sum = 0;
      for (int j = along_y ? -2 : 0; j <= (along_y ? 2 : 0); ++j)
        for (int i = along_x ? -2 : 0; i <= (along_x ? 2 : 0); ++i)
          sum += (along_x ? tap[i + 2] : 1) * (along_y ? tap[j + 2] : 1)
                 * image(mirror(step_x * x + i, image.width), mirror(step_y * y + j, image.height));
      half(x, y) = sum;
    }
  return half;
}

LabImage
pyr_down(const LabImage &image)
{
  return { pyr_down(image[0]), pyr_down(image[1]), pyr_down(image[2]) };
}

double
bilinear(const Image &image, double x, double y)
{
  x = std::clamp(x, 0.0, image.width - 1.0);
  y = std::clamp(y, 0.0, image.height - 1.0);
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const int right = std::min(left + 1, image.width - 1);
  const int bottom = std::min(top + 1, image.height - 1);
  const double fx = x - left;
  const double fy = y - top;
  return (1 - fy) * ((1 - fx) * image(left, top) + fx * image(right, top))
         + fy * ((1 - fx) * image(left, bottom) + fx * image(right, bottom));
}

Image
up(const Image &image, int octaves_x, int octaves_y, int width, int height)
{
  Image fine(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      fine(x, y) = bilinear(image, x / std::pow(2.0, octaves_x), y / std::pow(2.0, octaves_y));
  return fine;
}

// ---- frames

namespace {

/// A component, brought to the size of the frame.
Image
component_of(const saliency::FrameView &frame, std::size_t c)
{
  const saliency::Component &component = frame.components[c];
  Image image(component.width, component.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image(x, y) = component.data[y * component.row_stride + x * component.pixel_stride];
  const auto octaves = [](int fine, int coarse) {
    if (coarse != fine && coarse != (fine + 1) / 2)
      throw std::invalid_argument("expected all samples or half of them");
    return coarse == fine ? 0 : 1;
  };
  const int across = octaves(frame.width, image.width);
  const int down = octaves(frame.height, image.height);
  return across + down == 0 ? image : up(image, across, down, frame.width, frame.height);
}

} // namespace

LabImage
lab_image(const saliency::FrameView &frame, int threads)
{
  if (frame.depth != 8 || frame.model == saliency::ColorModel::gray)
    throw std::invalid_argument("expected three components of 8 bits");
  LabImage image{ component_of(frame, 0), component_of(frame, 1), component_of(frame, 2) };
  const std::size_t count = image[0].values.size();
  const auto convert = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Lab lab = samples_to_lab({ image[0].values[i], image[1].values[i], image[2].values[i] },
                                     frame.model, frame.depth, frame.full_range, frame.matrix);
      for (std::size_t c = 0; c < 3; ++c)
        image[c].values[i] = lab[c];
    }
  };
  const auto parts = static_cast<std::size_t>(threads);
  std::vector<std::jthread> helpers;
  for (std::size_t i = 1; i < parts; ++i)
    helpers.emplace_back(convert, count * i / parts, count * (i + 1) / parts);
  convert(0, count / parts);
  helpers.clear();
  return image;
}

std::vector<LabImage>
pyramid_of(LabImage image, int base, int coarsest)
{
  std::vector<LabImage> pyramid(static_cast<std::size_t>(base));
  pyramid.push_back(std::move(image));
  for (int n = base; n < coarsest; ++n)
    pyramid.push_back(pyr_down(pyramid.back()));
  return pyramid;
}

// ---- saliency

Image
contrast(const std::vector<LabImage> &pyramid, saliency::LevelPair lightness,
         saliency::LevelPair chroma, double chroma_weight)
{
  const auto squared = [&](saliency::LevelPair pair, std::size_t channel) {
    Image map = pyramid[static_cast<std::size_t>(pair.center)][channel];
    const int octaves = pair.surround - pair.center;
    const Image surround = up(pyramid[static_cast<std::size_t>(pair.surround)][channel], octaves,
                              octaves, map.width, map.height);
    for (std::size_t i = 0; i < map.values.size(); ++i)
      map.values[i] = std::pow(map.values[i] - surround.values[i], 2);
    return map;
  };
  Image map = squared(lightness, 0);
  const int octaves = chroma.center - lightness.center;
  for (const std::size_t channel : { 1, 2 }) {
    const Image differences = up(squared(chroma, channel), octaves, octaves, map.width, map.height);
    for (std::size_t i = 0; i < map.values.size(); ++i)
      map.values[i] += chroma_weight * chroma_weight * differences.values[i];
  }
  for (double &v : map.values)
    v = std::sqrt(v);
  return map;
}

Image
surroundedness(const LabImage &lab, double step, double exponent)
{
  const int w = lab[0].width;
  const int h = lab[0].height;
  Image map(w, h);
  for (const Image &channel : lab)
    for (double t = -199.5 * step; t < 200 * step; t += step) {
      Image seen(w, h);
      for (int start = 0; start < w * h; ++start) {
        if (seen.values[static_cast<std::size_t>(start)] > 0)
          continue;
        const bool above = channel.values[static_cast<std::size_t>(start)] > t;
        bool border = false;
        bool beyond = false;
        std::vector<int> region{ start };
        seen.values[static_cast<std::size_t>(start)] = 1;
        for (std::size_t i = 0; i < region.size(); ++i) {
          const int x = region[i] % w;
          const int y = region[i] / w;
          border = border || x == 0 || y == 0 || x == w - 1 || y == h - 1;
          beyond = beyond || (above ? channel(x, y) > t + step : channel(x, y) <= t - step);
          for (const auto &[nx, ny] :
               { std::pair{ x - 1, y }, { x + 1, y }, { x, y - 1 }, { x, y + 1 } })
            if (nx >= 0 && ny >= 0 && nx < w && ny < h && seen(nx, ny) == 0
                && (channel(nx, ny) > t) == above) {
              seen(nx, ny) = 1;
              region.push_back(ny * w + nx);
            }
        }
        if (!border && beyond)
          for (const int i : region)
            map.values[static_cast<std::size_t>(i)]
                += step * std::pow(0.01 * w * h / static_cast<double>(region.size()), exponent);
      }
    }
  return map;
}

Image
rarity(const LabImage &lab, double border)
{
  const int w = lab[0].width;
  const int h = lab[0].height;
  const auto bin = [](double position) {
    return std::clamp(static_cast<int>(std::floor(16 * position)), 0, 15);
  };
  const auto chroma = [](double a) {
    return (1 + a / (std::abs(a) + 24) * (112.0 + 24) / 112) / 2;
  };
  const auto cell = [&](int x, int y) {
    return std::array{ bin(lab[0](x, y) / 100), bin(chroma(lab[1](x, y))),
                       bin(chroma(lab[2](x, y))) };
  };
  const auto margin = [border](int length) {
    return std::max(1, static_cast<int>(std::lround(border * length)));
  };
  const auto counts = [&](int x, int y) {
    return border == 0 || x < margin(w) || x >= w - margin(w) || y < margin(h)
           || y >= h - margin(h);
  };

  std::vector<int> pixels(16 * 16 * 16);
  double total = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (counts(x, y)) {
        const auto c = cell(x, y);
        ++pixels[static_cast<std::size_t>((c[0] * 16 + c[1]) * 16 + c[2])];
        ++total;
      }
  Image map(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const auto own = cell(x, y);
      double near = 0;
      for (int l = 0; l < 16; ++l)
        for (int a = 0; a < 16; ++a)
          for (int b = 0; b < 16; ++b) {
            const int dl = std::abs(l - own[0]);
            const int da = std::abs(a - own[1]);
            const int db = std::abs(b - own[2]);
            if (std::max({ dl, da, db }) <= 1)
              near += std::pow(0.5, dl + da + db)
                      * pixels[static_cast<std::size_t>((l * 16 + a) * 16 + b)];
          }
      map(x, y) = std::max(0.0, -std::log(near / total + 1e-4) / 5);
    }
  return map;
}

Image
itti(const Image &map)
{
  const auto [low, high] = std::minmax_element(map.values.begin(), map.values.end());
  const double floor = *low;
  const double span = *high - floor;
  Image result(map.width, map.height);
  if (span <= 1e-4)
    return result;
  for (std::size_t i = 0; i < map.values.size(); ++i)
    result.values[i] = (map.values[i] - floor) / span;

  std::vector<double> maxima;
  for (int y = 1; y < map.height - 1; ++y)
    for (int x = 1; x < map.width - 1; ++x) {
      int lower = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          lower += map(x + i, y + j) < map(x, y) - 1e-4 ? 1 : 0;
      if (lower == 8)
        maxima.push_back(result(x, y));
    }
  if (const auto global = std::find(maxima.begin(), maxima.end(), 1.0); global != maxima.end())
    maxima.erase(global);
  double mean = 0;
  for (const double v : maxima)
    mean += v / static_cast<double>(maxima.size());
  for (double &v : result.values)
    v *= (1 - mean) * (1 - mean);
  return result;
}

Image
spatial_saliency(const std::vector<LabImage> &pyramid,
                 const std::vector<saliency::LevelPair> &lightness,
                 const std::vector<saliency::LevelPair> &chroma, int level, double chroma_weight,
                 bool normalize)
{
  const Image &target = pyramid[static_cast<std::size_t>(level)][0];
  Image sum(target.width, target.height);
  for (std::size_t p = 0; p < lightness.size(); ++p) {
    const int center = lightness[p].center;
    Image map = contrast(pyramid, lightness[p], chroma[p], chroma_weight);
    if (normalize)
      map = itti(map);
    for (int n = center; n < level; ++n)
      map = pyr_down(map);
    if (center > level)
      map = up(map, center - level, center - level, target.width, target.height);
    for (std::size_t i = 0; i < sum.values.size(); ++i)
      sum.values[i] += map.values[i];
  }
  return sum;
}

} // namespace oracle
