// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <tl/expected.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace people {

/// Finds faces in a single picture. One thread at a time.
class Detector
{
public:
  virtual ~Detector() = default;
  Detector() = default;
  Detector(const Detector &) = delete;
  Detector &operator=(const Detector &) = delete;

  /// The boxes of faces, in samples of `gray`, which is CV_8UC1 and of any size. OpenCV's
  /// exceptions pass: they end the look for people.
  virtual std::vector<cv::Rect> find(const cv::Mat &gray) = 0;
};

/// Makes a detector, which may take a while. An error says what is missing, and what to do.
using MakeDetector = std::function<tl::expected<std::unique_ptr<Detector>, std::string>()>;

} // namespace people
