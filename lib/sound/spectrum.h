// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/resampler.h"

#include <gst/fft/gstfftf32.h>

#include <array>
#include <complex>
#include <memory>
#include <span>

namespace sound {

/// Short-time spectrum of one channel at kRate. The window rises for 12 ms and falls within 4 ms,
/// so that what has just begun counts.
class Spectrum
{
public:
  static constexpr int kSize = 256; ///< samples: 16 ms
  static constexpr int kBins = kSize / 2 + 1;
  static constexpr double kBinHz = static_cast<double>(kRate) / kSize;
  using Bins = std::array<std::complex<float>, kBins>;

  Spectrum();

  /// `samples`: kSize, the newest last. A full-scale sine has the power 1/2, summed over its bins.
  void transform(std::span<const float, kSize> samples, Bins &bins);

private:
  struct Free
  {
    void operator()(GstFFTF32 *fft) const
    {
      gst_fft_f32_free(fft);
    }
  };

  std::unique_ptr<GstFFTF32, Free> fft_;
  std::array<float, kSize> window_{};
  std::array<float, kSize> windowed_{};
};

} // namespace sound
