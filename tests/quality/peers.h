// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <array>
#include <memory>

namespace quality {

/// Saliency models by others, for comparison.
enum class Peer
{
  spectral_residual, ///< Hou & Zhang 2007, OpenCV's
  fine_grained,      ///< Montabone & Soto 2010, OpenCV's
  bin_wang, ///< Wang & Dudek 2014, OpenCV's MotionSaliencyBinWangApr2014, a mask of what moves
  frame_difference, ///< absolute difference of gray, blurred
  haptic_lens,      ///< John & Seifi 2026, see haptic_lens.h
  rival,            ///< what 35 lines with OpenCV do: contrast that rises, as in the paper
};

inline constexpr std::array kPeers{ Peer::spectral_residual, Peer::fine_grained, Peer::bin_wang,
                                    Peer::frame_difference,  Peer::haptic_lens,  Peer::rival };

const char *name(Peer peer);

/// Whether this build has the peer. OpenCV's are in opencv_contrib's saliency module
/// (tools/setup.sh quality).
bool is_available(Peer peer);

/// Whether the peer detects only change, so that single pictures give nothing.
bool needs_motion(Peer peer);

/// The size to which larger frames are scaled down, with their aspect ratio: 320 wide for the
/// detectors of motion and the rival, 640 × 480 as in HapticLens's program. The others get the whole frame, as in
/// OpenCV's example (spectral residual scales it to 64 × 64 itself).
cv::Size scaled_for(Peer peer, cv::Size frame);

/// A peer that analyzes a film frame by frame.
class PeerSaliency
{
public:
  /// Throws std::runtime_error with a hint if the peer is not available.
  explicit PeerSaliency(Peer peer);
  ~PeerSaliency();
  PeerSaliency(PeerSaliency &&) noexcept;
  PeerSaliency &operator=(PeerSaliency &&) noexcept;

  /// `frame` is CV_8UC3 B'G'R', not empty; a new size resets. The map is CV_32FC1, finite, ≥ 0,
  /// with the size of scaled_for(). It is valid until the next call. BinWang is trained on the
  /// first frame, as if it had been shown for 2 s.
  const cv::Mat &compute(const cv::Mat &frame);

  /// The map of a single picture, likewise. HapticLens's is its spatial map.
  const cv::Mat &compute_still(const cv::Mat &picture);

  /// Forgets all frames.
  void reset();

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace quality
