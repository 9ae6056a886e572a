// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/fft/gstfftf32.h>

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace listen {

/// Rate of the analyzed sound in Hz. The band of a telephone is enough.
inline constexpr int kRate = 8000;

/// A moment and a frequency at which the sound is louder than just before, and than its
/// surroundings.
struct Peak
{
  std::int64_t frame = 0; ///< times kHop / kRate: seconds
  float bin = 0;          ///< times PeakFinder::kBinHz: Hz
  float strength = 0;     ///< dB above the average of its frequency
};

/// Finds the peaks of a sound at kRate, as it comes.
class PeakFinder
{
public:
  static constexpr int kSize = 512;                          ///< samples of a spectrum
  static constexpr int kHop = 128;                           ///< samples from one to the next
  static constexpr double kFrameRate = double(kRate) / kHop; ///< Hz
  static constexpr double kBinHz = double(kRate) / kSize;

  /// `most`: peaks in half a second. The weaker ones are left out.
  explicit PeakFinder(int most);

  void add(std::span<const float> samples);

  /// The peaks that were found since the last call, in order of their frames.
  std::vector<Peak> take();

private:
  static constexpr int kFirst = 10; ///< bin: 156 Hz
  static constexpr int kBins = 208; ///< up to 3.4 kHz
  static constexpr int kReach = 4;  ///< a peak exceeds so many frames and bins on each side
  static constexpr int kFrames = 2 * kReach + 1;
  static constexpr int kBlock = 32; ///< frames: half a second

  using Row = std::array<float, kBins>;
  struct Free
  {
    void operator()(GstFFTF32 *fft) const
    {
      gst_fft_f32_free(fft);
    }
  };

  void add_frame();
  void look_at(std::int64_t frame);
  void end_block();

  const std::size_t most_;
  std::unique_ptr<GstFFTF32, Free> fft_;
  std::array<float, kSize> window_{};
  std::array<float, kSize> held_{};      ///< the newest samples
  int fresh_ = 0;                        ///< samples since the last spectrum
  std::array<Row, kFrames> rows_{};      ///< dB above the average, of the last frames
  std::array<Row, kFrames> most_near_{}; ///< maximum of rows_ within kReach bins
  Row average_{};
  float loudest_ = -200; ///< dB, fades
  std::int64_t frames_ = 0;
  std::vector<Peak> block_;
  std::vector<Peak> found_;
};

} // namespace listen
