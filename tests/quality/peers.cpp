// SPDX-License-Identifier: LGPL-2.1-or-later
#include "peers.h"

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
  }
  return "";
}

bool
is_available([[maybe_unused]] Peer peer)
{
#ifdef HAVE_CONTRIB_SALIENCY
  return true;
#else
  return peer == Peer::frame_difference;
#endif
}

bool
needs_motion(Peer peer)
{
  return peer == Peer::bin_wang || peer == Peer::frame_difference;
}

struct PeerSaliency::State
{
  Peer peer;
  cv::Size size; ///< of the last frame
  cv::Mat reduced;
  cv::Mat gray;
  cv::Mat previous;
  cv::Mat map;
#ifdef HAVE_CONTRIB_SALIENCY
  cv::Ptr<cv::saliency::Saliency> model;
  cv::Mat raw_map;
#endif

  void difference();
  void ask_model(const cv::Mat &picture);
};

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

  if (!needs_motion(s.peer)) {
    s.ask_model(frame);
    return s.map;
  }
  cv::Mat picture = frame;
  if (frame.cols > kMotionWidth) {
    const double height = static_cast<double>(frame.rows) * kMotionWidth / frame.cols;
    cv::resize(frame, s.reduced, { kMotionWidth, std::max(1, cvRound(height)) }, 0, 0,
               cv::INTER_AREA);
    picture = s.reduced;
  }
  cv::cvtColor(picture, s.gray, cv::COLOR_BGR2GRAY);
  if (s.peer == Peer::frame_difference)
    s.difference();
  else
    s.ask_model(s.gray);
  return s.map;
}

} // namespace quality
