// SPDX-License-Identifier: LGPL-2.1-or-later
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <stdexcept>
#include <string>

#include "quality/peers.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using quality::Peer;
using quality::PeerSaliency;

namespace {

/// A texture with a ball on it.
cv::Mat
frame(int width, int height, int ball_x)
{
  cv::Mat picture(height, width, CV_8UC3);
  cv::RNG random(3);
  random.fill(picture, cv::RNG::UNIFORM, 90, 110);
  cv::circle(picture, { ball_x, height / 2 }, height / 8, { 40, 60, 220 }, cv::FILLED);
  return picture;
}

} // namespace

CHECK_TEST(test_frame_difference)
{
  // A step of 50 in one gray pixel becomes a Gaussian of volume 50 with a σ of 3 % of the width.
  // The first frame and unchanged frames have no difference.
  PeerSaliency difference(Peer::frame_difference);
  cv::Mat picture(75, 100, CV_8UC3, cv::Scalar(100, 100, 100));
  ck_assert_int_eq(cv::countNonZero(difference.compute(picture)), 0);
  picture.at<cv::Vec3b>(40, 50) = { 150, 150, 150 };
  const cv::Mat map = difference.compute(picture).clone();
  fail_unless(map.size() == picture.size() && map.type() == CV_32FC1);
  fail_unless_near(cv::sum(map)[0], 50, 0.01);
  const double peak = 50 / (2 * std::acos(-1.0) * 9);
  fail_unless_near(map.at<float>(40, 50), peak, 0.01 * peak);
  fail_unless_near(map.at<float>(40, 53), peak * std::exp(-0.5), 0.01 * peak);
  ck_assert_int_eq(cv::countNonZero(difference.compute(picture)), 0);

  // After a reset or a change of size there is no previous frame.
  picture.setTo(cv::Scalar(0, 0, 0));
  difference.reset();
  ck_assert_int_eq(cv::countNonZero(difference.compute(picture)), 0);
  ck_assert_int_eq(cv::countNonZero(difference.compute(frame(64, 48, 20))), 0);
}

CHECK_TEST(test_maps)
{
  // Every available peer, on films of changing size: maps have the frame's aspect ratio and finite
  // values ≥ 0.
  for (const Peer peer : quality::kPeers) {
    if (!quality::is_available(peer))
      continue;
    PeerSaliency saliency(peer);
    for (const cv::Size size : { cv::Size(160, 120), cv::Size(800, 450), cv::Size(97, 61) })
      for (int i = 0; i < 3; ++i) {
        const cv::Mat &map
            = saliency.compute(frame(size.width, size.height, size.width / 4 + 9 * i));
        ck_assert_int_eq(map.type(), CV_32FC1);
        fail_unless(map.cols <= size.width && map.rows <= size.height, "%s", quality::name(peer));
        fail_unless_near(map.cols * size.height, map.rows * size.width, size.width);
        fail_unless(cv::checkRange(map, true, nullptr, 0, 1e9), "%s", quality::name(peer));
      }
    const cv::Mat flat(60, 80, CV_8UC3, cv::Scalar(9, 9, 9));
    fail_unless(cv::checkRange(saliency.compute(flat), true, nullptr, 0, 1e9), "%s",
                quality::name(peer));
  }
}

CHECK_TEST(test_bin_wang_finds_what_moves)
{
  if (!quality::is_available(Peer::bin_wang))
    return;
  // Nothing on the first frame, then only the ball.
  PeerSaliency bin_wang(Peer::bin_wang);
  cv::Mat picture(120, 160, CV_8UC3, cv::Scalar(90, 90, 90));
  ck_assert_int_eq(cv::countNonZero(bin_wang.compute(picture)), 0);
  cv::circle(picture, { 50, 60 }, 15, { 220, 220, 220 }, cv::FILLED);
  const cv::Mat &map = bin_wang.compute(picture);
  fail_unless(map.at<float>(60, 50) > 0);
  fail_unless(map.at<float>(60, 120) == 0);
}

CHECK_TEST(test_haptic_lens)
{
  // Two discs mirror one another; one is five frames old, the other new. A step k frames ago has
  // left min(k, 2ⁿ) / 2ⁿ in the average of 2ⁿ frames, so the temporal maps are 4.359375 and
  // 3.171875 steps; the spatial maps are equal.
  PeerSaliency haptic_lens(Peer::haptic_lens);
  cv::Mat picture(65, 257, CV_8UC3, cv::Scalar(60, 60, 60));
  const cv::Point older(64, 32);
  const cv::Point newer(192, 32);
  for (int i = 0; i < 70; ++i)
    ck_assert_int_eq(cv::countNonZero(haptic_lens.compute(picture)), 0);
  cv::circle(picture, older, 12, { 160, 160, 160 }, cv::FILLED);
  for (int i = 0; i < 4; ++i)
    haptic_lens.compute(picture);
  cv::circle(picture, newer, 12, { 160, 160, 160 }, cv::FILLED);
  const cv::Mat map = haptic_lens.compute(picture).clone();
  double peak = 0;
  cv::minMaxLoc(map, nullptr, &peak);
  fail_unless_near(peak, 1, 1e-6);
  fail_unless_near(map.at<float>(newer) / map.at<float>(older), 3.171875 / 4.359375, 1e-3);
  fail_unless_near(map.at<float>(32, 128), 0, 0);

  // After a reset there is nothing to compare with for seven frames. A single picture has contrast.
  haptic_lens.reset();
  for (int i = 0; i < 7; ++i) {
    cv::circle(picture, older, i, { 0, 0, 0 }, cv::FILLED);
    ck_assert_int_eq(cv::countNonZero(haptic_lens.compute(picture)), 0);
  }
  cv::circle(picture, older, 12, { 0, 0, 0 }, cv::FILLED);
  fail_unless(cv::countNonZero(haptic_lens.compute(picture)) > 0);
  fail_unless(cv::countNonZero(haptic_lens.compute_still(picture)) > 0);
}

CHECK_TEST(test_unavailable)
{
  for (const Peer peer : quality::kPeers) {
    std::string said;
    try {
      PeerSaliency saliency(peer);
    } catch (const std::runtime_error &error) {
      said = error.what();
    }
    fail_unless(quality::is_available(peer) == said.empty());
    fail_unless(said.empty() || said.find("tools/setup.sh quality") != std::string::npos);
  }
  fail_unless(quality::is_available(Peer::frame_difference));
}

CHECK_MAIN(peers)
