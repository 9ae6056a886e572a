// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "people/detector.h"

#include <opencv2/core.hpp>

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

/// A detector that finds what a test has said before the detection begins, when it is to end.
class FakeFaces
{
public:
  people::MakeDetector make()
  {
    return [this]() -> tl::expected<std::unique_ptr<people::Detector>, std::string> {
      const std::lock_guard lock(mutex_);
      made_++;
      return std::make_unique<Fake>(*this);
    };
  }

  void set(std::vector<cv::Rect> faces)
  {
    const std::lock_guard lock(mutex_);
    faces_ = std::move(faces);
  }
  /// From now on there is one face, about the brightest place.
  void find_brightest(cv::Size size)
  {
    const std::lock_guard lock(mutex_);
    brightest_ = size;
  }
  /// From now on each detection throws what this does.
  void throw_from(std::function<void()> throws)
  {
    const std::lock_guard lock(mutex_);
    throws_ = std::move(throws);
  }
  /// Detections after the first `ends` do not end.
  void hold(std::size_t ends = 0)
  {
    const std::lock_guard lock(mutex_);
    ends_ = ends;
    changed_.notify_all();
  }
  void release()
  {
    hold(SIZE_MAX);
  }
  void wait_until_begun(std::size_t detections)
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return seen_.size() >= detections; });
  }
  /// Mean gray of the pictures that were looked at.
  std::vector<int> seen()
  {
    const std::lock_guard lock(mutex_);
    return seen_;
  }
  int made()
  {
    const std::lock_guard lock(mutex_);
    return made_;
  }

private:
  struct Fake : people::Detector
  {
    explicit Fake(FakeFaces &owner_) : owner(owner_)
    {
    }
    std::vector<cv::Rect> find(const cv::Mat &gray) override
    {
      std::unique_lock lock(owner.mutex_);
      owner.seen_.push_back(cvRound(cv::mean(gray)[0]));
      owner.changed_.notify_all();
      const std::vector<cv::Rect> faces = owner.faces_;
      const std::size_t number = owner.seen_.size();
      owner.changed_.wait(lock, [this, number] { return number <= owner.ends_; });
      if (owner.throws_)
        owner.throws_();
      if (owner.brightest_.empty())
        return faces;
      cv::Point at;
      cv::minMaxLoc(gray, nullptr, nullptr, nullptr, &at);
      return { cv::Rect(at - cv::Point(owner.brightest_ / 2), owner.brightest_) };
    }
    FakeFaces &owner;
  };

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<cv::Rect> faces_;
  cv::Size brightest_;
  std::function<void()> throws_;
  std::vector<int> seen_;
  std::size_t ends_ = SIZE_MAX;
  int made_ = 0;
};
