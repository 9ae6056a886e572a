// SPDX-License-Identifier: LGPL-2.1-or-later
#include "peers.h"

#include "haptic_lens.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#ifdef HAVE_CONTRIB_SALIENCY
#include <opencv2/saliency.hpp>
#endif

#include <algorithm>
#include <deque>
#include <stdexcept>
#include <string>

namespace quality {

namespace {

constexpr int kMotionWidth = 320;
const cv::Size kHapticLensLargest(640, 480);

/// For BinWang all is foreground until half of the picture was constant for 50 frames.
constexpr int kLearning = 60;

/// 1 degree of visual angle where 800 pixels are 33.
constexpr double kBlurShare = 24.0 / 800;

#ifdef HAVE_CONTRIB_SALIENCY
cv::Ptr<cv::saliency::Saliency>
make_model(Peer peer, cv::Size size)
{
  switch (peer) {
  case Peer::spectral_residual:
    return cv::saliency::StaticSaliencySpectralResidual::create();
  case Peer::fine_grained:
    return cv::saliency::StaticSaliencyFineGrained::create();
  case Peer::bin_wang: {
    const auto model = cv::saliency::MotionSaliencyBinWangApr2014::create();
    model->setImagesize(size.width, size.height);
    model->init();
    return model;
  }
  case Peer::frame_difference:
  case Peer::haptic_lens:
  case Peer::rival:
    break;
  }
  return {};
}
#endif

} // namespace

const char *
name(Peer peer)
{
  switch (peer) {
  case Peer::spectral_residual:
    return "spectral residual";
  case Peer::fine_grained:
    return "fine-grained";
  case Peer::bin_wang:
    return "BinWang";
  case Peer::frame_difference:
    return "frame difference";
  case Peer::haptic_lens:
    return "HapticLens";
  case Peer::rival:
    return "rival of 35 lines";
  }
  return "";
}

bool
is_available([[maybe_unused]] Peer peer)
{
#ifdef HAVE_CONTRIB_SALIENCY
  return true;
#else
  return peer == Peer::frame_difference || peer == Peer::haptic_lens || peer == Peer::rival;
#endif
}

bool
needs_motion(Peer peer)
{
  return peer == Peer::bin_wang || peer == Peer::frame_difference || peer == Peer::rival;
}

cv::Size
scaled_for(Peer peer, cv::Size frame)
{
  double scale = 1;
  if (needs_motion(peer))
    scale = static_cast<double>(kMotionWidth) / frame.width;
  else if (peer == Peer::haptic_lens)
    scale = std::min(static_cast<double>(kHapticLensLargest.width) / frame.width,
                     static_cast<double>(kHapticLensLargest.height) / frame.height);
  if (scale >= 1)
    return frame;
  return { std::max(1, cvRound(frame.width * scale)), std::max(1, cvRound(frame.height * scale)) };
}

struct PeerSaliency::State
{
  Peer peer;
  cv::Size size; ///< of the last frame
  cv::Mat reduced;
  cv::Mat gray;
  cv::Mat previous;
  cv::Mat map;
  HapticLens haptic_lens;
  std::deque<cv::Mat> contrasts; ///< of the rival, latest first
#ifdef HAVE_CONTRIB_SALIENCY
  cv::Ptr<cv::saliency::Saliency> model;
  cv::Mat raw_map;
#endif

  /// The frame in the size of scaled_for().
  const cv::Mat &scaled(const cv::Mat &frame);
  void difference();
  void rising_contrast(const cv::Mat &picture);
  void ask_model(const cv::Mat &picture);
};

const cv::Mat &
PeerSaliency::State::scaled(const cv::Mat &frame)
{
  const cv::Size wanted = scaled_for(peer, frame.size());
  if (wanted == frame.size())
    return frame;
  cv::resize(frame, reduced, wanted, 0, 0, cv::INTER_AREA);
  return reduced;
}

void
PeerSaliency::State::difference()
{
  if (previous.empty()) {
    map = cv::Mat::zeros(gray.size(), CV_32FC1);
  } else {
    cv::absdiff(gray, previous, map);
    map.convertTo(map, CV_32F);
    cv::GaussianBlur(map, map, {}, std::max(0.5, kBlurShare * gray.cols));
  }
  gray.copyTo(previous);
}

/// Center-surround contrast of L*a*b* between two levels; means over 1, 2, 4 and 8 frames above those
/// over eight times as many.
void
PeerSaliency::State::rising_contrast(const cv::Mat &picture)
{
  cv::Mat lab;
  cv::resize(picture, lab, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::cvtColor(lab, lab, cv::COLOR_BGR2Lab);
  lab.convertTo(lab, CV_32FC3);
  cv::Mat surround;
  cv::pyrDown(lab, surround);
  cv::pyrUp(surround, surround, lab.size());
  cv::Mat change = lab - surround;
  change = change.mul(change);
  cv::transform(change, change, cv::Matx13f(1, 4, 4));
  cv::sqrt(change, change);
  cv::resize(change, change, { std::max(1, lab.cols / 4), std::max(1, lab.rows / 4) }, 0, 0,
             cv::INTER_AREA);
  contrasts.push_front(change);
  if (contrasts.size() > 64)
    contrasts.pop_back();
  map = cv::Mat::zeros(change.size(), CV_32FC1);
  cv::Mat sum = map.clone();
  cv::Mat short_means[4];
  for (std::size_t i = 0; i < 64; ++i) {
    sum += contrasts[std::min(i, contrasts.size() - 1)];
    for (int k = 0; k < 4; ++k) {
      if (i + 1 == std::size_t{ 1 } << k)
        short_means[k] = sum / (1 << k);
      if (i + 1 == std::size_t{ 8 } << k)
        map += cv::max(0, short_means[k] - sum / (8 << k)) / 4;
    }
  }
  cv::resize(map.clone(), map, picture.size(), 0, 0, cv::INTER_LINEAR);
}

void
PeerSaliency::State::ask_model([[maybe_unused]] const cv::Mat &picture)
{
#ifdef HAVE_CONTRIB_SALIENCY
  if (!model) {
    model = make_model(peer, picture.size());
    for (int i = 0; peer == Peer::bin_wang && i < kLearning; ++i)
      model->computeSaliency(picture, raw_map);
  }
  if (!model->computeSaliency(picture, raw_map) || raw_map.channels() != 1)
    throw std::runtime_error(std::string(name(peer)) + " gave no map");
  raw_map.convertTo(map, CV_32F);
  // The spectral residual of a flat picture divides by zero.
  cv::patchNaNs(map, 0);
  map = cv::max(map, 0);
#endif
}

PeerSaliency::PeerSaliency(Peer peer) : state_(std::make_unique<State>())
{
  if (!is_available(peer))
    throw std::runtime_error(std::string(name(peer))
                             + " is not available: install OpenCV's saliency module"
                               " (tools/setup.sh quality) and configure again");
  state_->peer = peer;
}

PeerSaliency::~PeerSaliency() = default;
PeerSaliency::PeerSaliency(PeerSaliency &&) noexcept = default;
PeerSaliency &PeerSaliency::operator=(PeerSaliency &&) noexcept = default;

void
PeerSaliency::reset()
{
  state_->previous.release();
  state_->haptic_lens.reset();
  state_->contrasts.clear();
#ifdef HAVE_CONTRIB_SALIENCY
  state_->model.release();
#endif
}

const cv::Mat &
PeerSaliency::compute(const cv::Mat &frame)
{
  CV_Assert(frame.type() == CV_8UC3 && !frame.empty());
  auto &s = *state_;
  if (frame.size() != s.size)
    reset();
  s.size = frame.size();

  const cv::Mat &picture = s.scaled(frame);
  if (s.peer == Peer::haptic_lens) {
    s.map = s.haptic_lens.film_map(picture);
  } else if (s.peer == Peer::rival) {
    s.rising_contrast(picture);
  } else if (!needs_motion(s.peer)) {
    s.ask_model(picture);
  } else {
    cv::cvtColor(picture, s.gray, cv::COLOR_BGR2GRAY);
    if (s.peer == Peer::frame_difference)
      s.difference();
    else
      s.ask_model(s.gray);
  }
  return s.map;
}

const cv::Mat &
PeerSaliency::compute_still(const cv::Mat &picture)
{
  auto &s = *state_;
  if (s.peer != Peer::haptic_lens)
    return compute(picture);
  s.map = s.haptic_lens.picture_map(s.scaled(picture));
  return s.map;
}

} // namespace quality
