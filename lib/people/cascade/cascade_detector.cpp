// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The module that people::cascade_detector() loads.
#include "people/detector.h"

#include <opencv2/core/utility.hpp>
#include <opencv2/objdetect.hpp>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace {

class CascadeDetector final : public people::Detector
{
public:
  bool load(const char *file)
  {
    std::error_code none;
    if (!std::filesystem::is_regular_file(file, none))
      return false; // OpenCV prints an error
    try {
      return cascade_.load(file) && !cascade_.empty();
    } catch (const cv::Exception &) { // invalid XML
      return false;
    }
  }

  std::vector<cv::Rect> find(const cv::Mat &gray) override
  {
    // A face is found at neighboring places and scales; noise is found once.
    constexpr double kScales = 1.2;
    constexpr int kNeighbors = 2;
    constexpr int kSmallest = 20; ///< samples; the cascade's own window
    std::vector<cv::Rect> faces;
    if (std::min(gray.cols, gray.rows) <= kSmallest)
      return faces;
    // Within a parallel_for_() another one stays on its thread. Detection is to leave the other
    // processors to the film, and faces are in the same order each time.
    cv::parallel_for_(cv::Range(0, 1), [&](const cv::Range &) {
      cascade_.detectMultiScale(gray, faces, kScales, kNeighbors, 0, { kSmallest, kSmallest });
    });
    return faces;
  }

private:
  cv::CascadeClassifier cascade_;
};

} // namespace

/// Null if the file is missing or no cascade.
extern "C" __attribute__((visibility("default"))) people::Detector *
visuotactile_make_face_detector(const char *file)
{
  auto detector = std::make_unique<CascadeDetector>();
  return detector->load(file) ? detector.release() : nullptr;
}
