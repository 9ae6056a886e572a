// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/detection_thread.h"

#include "people/skin.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <new>
#include <utility>

namespace people {

namespace {

/// Processor time of this thread.
std::chrono::nanoseconds
processor_time()
{
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

} // namespace

DetectionThread::DetectionThread(MakeDetector make, int width)
    : make_(std::move(make)), width_(width)
{
}

DetectionThread::~DetectionThread()
{
  if (!started_)
    return;
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  offered_.notify_one();
  pthread_join(thread_, nullptr);
}

int
DetectionThread::level(cv::Size frame) const
{
  const double side = std::max(frame.width, frame.height);
  return std::max(0, static_cast<int>(std::floor(std::log2(side / (0.8 * width_)))));
}

void
DetectionThread::offer(const saliency::FixedLabImage &picture, int level)
{
  {
    const std::lock_guard lock(mutex_);
    if (!failure_.empty())
      return;
    for (std::size_t c = 0; c < picture.planes.size(); ++c)
      picture.planes[c].copyTo(waiting_.lab.planes[c]);
    waiting_.level = level;
    is_waiting_ = true;
    hits_.reset();
  }
  offered_.notify_one();
  if (started_)
    return;
  // Not std::thread, which throws when the system has no more threads.
  const auto work = [](void *self) -> void * {
    static_cast<DetectionThread *>(self)->run();
    return nullptr;
  };
  started_ = pthread_create(&thread_, nullptr, work, this) == 0;
  if (!started_) {
    const std::lock_guard lock(mutex_);
    failure_ = "the system has no more threads";
  }
}

std::optional<std::vector<Hit>>
DetectionThread::take(bool wait)
{
  std::unique_lock lock(mutex_);
  if (wait)
    done_.wait(lock, [this] { return hits_ || !failure_.empty(); });
  return std::exchange(hits_, std::nullopt);
}

std::string
DetectionThread::failure()
{
  const std::lock_guard lock(mutex_);
  return failure_;
}

DetectionThread::Statistics
DetectionThread::statistics()
{
  const std::lock_guard lock(mutex_);
  return statistics_;
}

/// An exception of OpenCV or of an allocation ends the detection and not the process.
void
DetectionThread::run()
{
  std::string failure;
  try {
    failure = detect();
  } catch (const std::bad_alloc &) {
    failure = "out of memory"; // short enough to need none
  } catch (const std::exception &error) {
    failure = std::string("the face detector failed: ") + error.what();
  } catch (...) {
    failure = "the face detector failed";
  }
  const std::lock_guard lock(mutex_);
  failure_ = std::move(failure);
  done_.notify_one();
}

/// Returns at the end, or why nothing can be found.
std::string
DetectionThread::detect()
{
  const tl::expected<std::unique_ptr<Detector>, std::string> detector = make_();
  if (!detector)
    return detector.error();
  Picture picture;
  std::unique_lock lock(mutex_);
  for (;;) {
    offered_.wait(lock, [this] { return is_waiting_ || end_; });
    if (end_)
      return {};
    is_waiting_ = false;
    std::swap(picture, waiting_);
    lock.unlock();
    const std::chrono::nanoseconds begin = processor_time();
    std::vector<Hit> hits = find(**detector, picture);
    const std::chrono::nanoseconds spent = processor_time() - begin;
    lock.lock();
    statistics_.detections++;
    statistics_.busy += spent;
    if (!is_waiting_) // otherwise, these are of a dropped picture
      hits_ = std::move(hits);
    done_.notify_one();
  }
}

std::vector<Hit>
DetectionThread::find(Detector &detector, const Picture &picture) const
{
  using saliency::FixedLabImage;
  // Lightness, 0 to 100, as gray.
  const cv::Mat &lightness = picture.lab.planes[0];
  constexpr double kGray = 2.55;
  cv::Mat gray;
  lightness.convertTo(gray, CV_8UC1, kGray / FixedLabImage::kUnits,
                      -kGray * FixedLabImage::kOffset);
  const double scale = std::min(1.25, static_cast<double>(width_) / std::max(gray.cols, gray.rows));
  const cv::Size size(std::max(1, static_cast<int>(gray.cols * scale)),
                      std::max(1, static_cast<int>(gray.rows * scale)));
  cv::resize(gray, gray, size, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);

  std::vector<Hit> hits;
  const double step = std::ldexp(1.0, picture.level);
  const cv::Rect all({}, picture.lab.size());
  for (const cv::Rect &face : detector.find(gray)) {
    const cv::Rect2d box(face.x / scale, face.y / scale, face.width / scale, face.height / scale);
    // Sample i of level n is centered on pixel 2ⁿ·i.
    const double first = 0.5 - 0.5 / step;
    hits.push_back(
        { { (box.x - first) * step, (box.y - first) * step, box.width * step, box.height * step },
          mean_skin(picture.lab, cv::Rect(box) & all) });
  }
  return hits;
}

} // namespace people
