// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/levels.h"

namespace saliency {

namespace {

int
halved(int length, int octaves)
{
  return octaves < 31
             ? static_cast<int>((static_cast<long long>(length) + (1LL << octaves) - 1) >> octaves)
             : 1;
}

} // namespace

cv::Size
level_size(cv::Size size, int level)
{
  return { halved(size.width, level), halved(size.height, level) };
}

int
coarsest_level(cv::Size size)
{
  int level = 0;
  while (level_size(size, level) != cv::Size(1, 1))
    ++level;
  return level;
}

} // namespace saliency
