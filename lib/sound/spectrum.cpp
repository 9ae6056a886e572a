// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/spectrum.h"

#include <cmath>
#include <numbers>

namespace sound {

Spectrum::Spectrum() : fft_(gst_fft_f32_new(kSize, FALSE))
{
  constexpr int kFall = 64; // samples
  double power = 0;
  for (int i = 0; i < kSize; i++) {
    const double place
        = i < kSize - kFall ? (i + 0.5) / (kSize - kFall) : (kSize - i - 0.5) / kFall;
    window_[static_cast<std::size_t>(i)]
        = static_cast<float>(0.5 - 0.5 * std::cos(std::numbers::pi * place));
    power += std::pow(window_[static_cast<std::size_t>(i)], 2);
  }
  // By Parseval's theorem; each bin stands for its negative frequency, too.
  for (float &weight : window_)
    weight *= static_cast<float>(std::sqrt(2 / (power * kSize)));
}

void
Spectrum::transform(std::span<const float, kSize> samples, Bins &bins)
{
  for (std::size_t i = 0; i < kSize; i++)
    windowed_[i] = samples[i] * window_[i];
  // std::complex<float> and GstFFTF32Complex are both a real and an imaginary float.
  gst_fft_f32_fft(fft_.get(), windowed_.data(), reinterpret_cast<GstFFTF32Complex *>(bins.data()));
}

} // namespace sound
