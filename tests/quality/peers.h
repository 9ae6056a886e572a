// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <array>
#include <memory>

namespace quality {

/// Saliency models by others, to compare with.
enum class Peer
{
  spectral_residual, ///< Hou & Zhang 2007, OpenCV's
  fine_grained,      ///< Montabone & Soto 2010, OpenCV's
  bin_wang, ///< Wang & Dudek 2014, OpenCV's MotionSaliencyBinWangApr2014, a mask of what moves
  frame_difference, ///< of gray to the frame before, blurred
};

inline constexpr std::array kPeers{ Peer::spectral_residual, Peer::fine_grained, Peer::bin_wang,
                                    Peer::frame_difference };

const char *name(Peer peer);

/// Whether this build has it: OpenCV's come with opencv_contrib's saliency module
/// (tools/setup.sh quality).
bool is_available(Peer peer);

/// Whether it only sees change: on a single picture it has nothing to say.
bool needs_motion(Peer peer);

/// A peer that is shown a film, frame by frame.
class PeerSaliency
{
public:
  /// Throws std::runtime_error with a hint if the peer is not available.
  explicit PeerSaliency(Peer peer);
  ~PeerSaliency();
  PeerSaliency(PeerSaliency &&) noexcept;
  PeerSaliency &operator=(PeerSaliency &&) noexcept;

  /// `frame`: CV_8UC3, B'G'R', not empty; another size than the frame's before starts anew. The map
  /// is CV_32FC1, finite, ≥ 0, of the frame's aspect and no larger than it, valid until the next
  /// call. Frames wider than 320 are reduced to that by area for the peers that need motion; the
  /// still ones see the whole frame, as in OpenCV's example (spectral residual reduces it to 64 ×
  /// 64 itself). BinWang learns from the first frame, as if that had been on show for 2 s before.
  const cv::Mat &compute(const cv::Mat &frame);

  /// Forgets the frames before.
  void reset();

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace quality
