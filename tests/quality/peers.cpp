// SPDX-License-Identifier: LGPL-2.1-or-later
#include "peers.h"

#include "haptic_lens.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#ifdef HAVE_CONTRIB_SALIENCY
#include <opencv2/saliency.hpp>
#endif

#include <algorithm>
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
  }
  return "";
}

bool
is_available([[maybe_unused]] Peer peer)
{
#ifdef HAVE_CONTRIB_SALIENCY
  return true;
#else
  return peer == Peer::frame_difference || peer == Peer::haptic_lens;
#endif
}

bool
needs_motion(Peer peer)
{
  return peer == Peer::bin_wang || peer == Peer::frame_difference;
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
#ifdef HAVE_CONTRIB_SALIENCY
  cv::Ptr<cv::saliency::Saliency> model;
  cv::Mat raw_map;
#endif

  /// The frame in the size of scaled_for().
  const cv::Mat &scaled(const cv::Mat &frame);
  void difference();
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
