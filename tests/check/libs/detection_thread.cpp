// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/detection_thread.h"

#include "fake_faces.h"
#include "people/cascade_module.h"
#include "support/no_threads.h"
#include "support/temporary_file.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

#include <opencv2/core.hpp>

#include <functional>
#include <iterator>
#include <new>
#include <thread>

using people::DetectionThread;
using people::Hit;
using saliency::FixedLabImage;

namespace {

constexpr int kWidth = 320;

/// A picture of one color.
FixedLabImage
plain(cv::Size size, std::array<double, 3> lab)
{
  FixedLabImage image;
  for (std::size_t c = 0; c < 3; ++c)
    image.planes[c] = cv::Mat(size, CV_16UC1,
                              cv::Scalar((lab[c] + static_cast<double>(FixedLabImage::kOffset))
                                         * static_cast<double>(FixedLabImage::kUnits)));
  return image;
}

FixedLabImage
gray(double lightness)
{
  return plain({ kWidth, 180 }, { lightness, 0, 0 });
}

} // namespace

/// A picture that waits is replaced; results are those of the latest.
CHECK_TEST(test_latest_wins)
{
  FakeFaces fake;
  fake.hold();
  DetectionThread thread(fake.make(), kWidth);
  thread.offer(gray(20), 0);
  fake.wait_until_begun(1);
  thread.offer(gray(40), 0);
  thread.offer(gray(60), 0);
  fail_if(thread.take(false).has_value());
  fake.set({ cv::Rect(10, 20, 30, 30) });
  fake.hold(1);
  fake.wait_until_begun(2);
  fail_if(thread.take(false).has_value(), "of an earlier picture");
  fake.release();
  const auto hits = thread.take(true);
  fail_unless(hits.has_value() && hits->size() == 1);
  fail_unless(fake.seen() == (std::vector<int>{ 51, 153 })); // 2.55 L*
  fail_if(thread.take(false).has_value(), "the same result twice");
  ck_assert_int_eq(thread.statistics().detections, 2);
  ck_assert_int_eq(fake.made(), 1);
}

/// It ends while a detection runs, and before any.
CHECK_TEST(test_ends)
{
  FakeFaces fake;
  {
    const DetectionThread unused(fake.make(), kWidth);
  }
  ck_assert_int_eq(fake.made(), 0);
  fake.hold();
  std::thread other;
  {
    DetectionThread thread(fake.make(), kWidth);
    thread.offer(gray(20), 0);
    fake.wait_until_begun(1);
    thread.offer(gray(40), 0);
    other = std::thread([&fake] { fake.release(); });
  }
  other.join();
  fail_unless(fake.seen().size() <= 2);
}

/// Pictures are of about the wanted size, and boxes are in pixels of the frame.
CHECK_TEST(test_sizes)
{
  FakeFaces fake;
  DetectionThread thread(fake.make(), kWidth);
  struct Case
  {
    cv::Size frame;
    int level;
  };
  for (const auto &[frame, level] : { Case{ { 1920, 1080 }, 2 },
                                      { { 1280, 720 }, 2 },
                                      { { 640, 480 }, 1 },
                                      { { 3840, 2160 }, 3 },
                                      { { 800, 600 }, 1 },
                                      { { 320, 240 }, 0 },
                                      { { 16, 9 }, 0 },
                                      { { 1, 1 }, 0 } })
    ck_assert_int_eq(thread.level(frame), level);

  fake.set({ cv::Rect(16, 24, 40, 40) });
  thread.offer(plain({ kWidth, 180 }, { 50, 0, 0 }), 2);
  const Hit same = thread.take(true)->at(0);
  // Sample i is centered on pixel 4 i, so its left edge is at 4 i - 1.5.
  fail_unless(same.box == cv::Rect2d(62.5, 94.5, 160, 160));
  thread.offer(plain({ 2 * kWidth, 360 }, { 50, 0, 0 }), 0);
  fail_unless(thread.take(true)->at(0).box == cv::Rect2d(32, 48, 80, 80));
  for (const cv::Size size : { cv::Size(1, 1), cv::Size(1, 500), cv::Size(500, 1) }) {
    thread.offer(plain(size, { 50, 0, 0 }), 0);
    fail_unless_near(thread.take(true)->at(0).skin, 0, 1e-9);
  }
}

/// Skin of light and of dark people, and what is none.
CHECK_TEST(test_skin)
{
  FakeFaces fake;
  fake.set({ cv::Rect(10, 10, 40, 40) });
  DetectionThread thread(fake.make(), kWidth);
  const auto skin = [&](std::array<double, 3> lab) {
    thread.offer(plain({ kWidth, 180 }, lab), 0);
    return thread.take(true)->at(0).skin;
  };
  fail_unless(skin({ 75, 14, 18 }) > 0.8);
  fail_unless(skin({ 35, 14, 22 }) > 0.8);
  fail_unless(skin({ 60, 0, 0 }) < 0.1);    // gray
  fail_unless(skin({ 50, -40, 30 }) < 0.1); // grass
  fail_unless(skin({ 60, -5, -30 }) < 0.1); // sky
  fail_unless(skin({ 5, 14, 20 }) < 0.1);   // too dark to tell
}

/// What is missing is told, once nobody waits for results in vain.
CHECK_TEST(test_failures)
{
  DetectionThread broken(
      []() -> tl::expected<std::unique_ptr<people::Detector>, std::string> {
        return tl::unexpected(std::string("no detector"));
      },
      kWidth);
  fail_unless(broken.failure().empty());
  broken.offer(gray(20), 0);
  fail_if(broken.take(true).has_value());
  fail_unless(broken.failure() == "no detector");
  broken.offer(gray(20), 0);
  fail_if(broken.take(true).has_value());

  FakeFaces fake;
  DetectionThread alone(fake.make(), kWidth);
  {
    const NoThreads none;
    alone.offer(gray(20), 0);
  }
  fail_if(alone.take(true).has_value());
  fail_if(alone.failure().empty());

  g_setenv("VISUOTACTILE_CASCADES", "/nowhere", TRUE);
  DetectionThread no_cascade(people::cascade_detector(), kWidth);
  no_cascade.offer(gray(20), 0);
  fail_if(no_cascade.take(true).has_value());
  fail_unless(no_cascade.failure().find("/nowhere/") != std::string::npos, "%s",
              no_cascade.failure().c_str());
  const TemporaryFolder folder;
  g_setenv("VISUOTACTILE_CASCADES", folder.path.c_str(), TRUE);
  for (const char *text : { "", "no XML", "<?xml version=\"1.0\"?><opencv_storage><cascade>",
                            "<?xml version=\"1.0\"?><opencv_storage></opencv_storage>" }) {
    folder.file("haarcascade_frontalface_alt2.xml", text);
    DetectionThread no_xml(people::cascade_detector(), kWidth);
    no_xml.offer(gray(20), 0);
    fail_if(no_xml.take(true).has_value());
    fail_if(no_xml.failure().empty());
  }
  g_setenv("VISUOTACTILE_MODULES", "/nothing", TRUE);
  DetectionThread no_module(people::cascade_detector(), kWidth);
  no_module.offer(gray(20), 0);
  fail_if(no_module.take(true).has_value());
  fail_unless(no_module.failure().find("/nothing/") != std::string::npos, "%s",
              no_module.failure().c_str());
}

/// What a detector throws, or what makes it, ends the look for people and not the process.
CHECK_TEST(test_exceptions)
{
  const std::function<void()> throwing[] = {
    [] { throw std::bad_alloc(); },
    [] { cv::error(cv::Error::StsNoMem, "no 64 GB", "here", "there", 1); },
    [] { throw 1; },
  };
  const char *told[] = { "out of memory", "no 64 GB", "failed" };
  for (std::size_t i = 0; i < std::size(throwing); i++) {
    FakeFaces fake;
    DetectionThread thread(fake.make(), kWidth);
    thread.offer(gray(20), 0);
    fail_unless(thread.take(true).has_value() && thread.failure().empty());
    fake.throw_from(throwing[i]);
    thread.offer(gray(40), 0);
    fail_if(thread.take(true).has_value());
    fail_unless(thread.failure().find(told[i]) != std::string::npos, "%s",
                thread.failure().c_str());
    thread.offer(gray(60), 0);
    fail_if(thread.take(true).has_value());
    ck_assert_uint_eq(fake.seen().size(), 2);

    DetectionThread unmade(
        [&throwing, i]() -> tl::expected<std::unique_ptr<people::Detector>, std::string> {
          throwing[i]();
          return nullptr;
        },
        kWidth);
    unmade.offer(gray(20), 0);
    fail_if(unmade.take(true).has_value());
    fail_unless(unmade.failure().find(told[i]) != std::string::npos);
  }
}

CHECK_MAIN(detection_thread)
