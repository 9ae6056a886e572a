// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include <gst/fft/gstfftf64.h>

/// The spectrum of a sound: amplitude of full scale in each bin of rate / sound.size() Hz, where a
/// sine of full scale has 1. The window is Blackman and Harris's of four terms: what is more than
/// four bins from a partial is 92 dB below it.
inline std::vector<double>
spectrum_of(std::span<const float> sound)
{
  const std::size_t size = sound.size();
  std::vector<double> windowed(size);
  double sum = 0;
  for (std::size_t i = 0; i < size; i++) {
    const double x = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(size);
    const double window
        = 0.35875 - 0.48829 * std::cos(x) + 0.14128 * std::cos(2 * x) - 0.01168 * std::cos(3 * x);
    windowed[i] = window * static_cast<double>(sound[i]);
    sum += window;
  }
  std::vector<GstFFTF64Complex> bins(size / 2 + 1);
  GstFFTF64 *fft = gst_fft_f64_new(static_cast<gint>(size), FALSE);
  gst_fft_f64_fft(fft, windowed.data(), bins.data());
  gst_fft_f64_free(fft);
  std::vector<double> amplitudes(bins.size());
  for (std::size_t i = 0; i < bins.size(); i++)
    amplitudes[i] = (i > 0 ? 2 : 1) * std::hypot(bins[i].r, bins[i].i) / sum;
  return amplitudes;
}

inline double
decibels(double amplitude)
{
  return 20 * std::log10(amplitude);
}

/// The strongest bin outside of (low, high) Hz, in dB of full scale.
inline double
strongest_outside(std::span<const float> sound, int rate, double low, double high)
{
  const std::vector<double> spectrum = spectrum_of(sound);
  double strongest = 1e-12;
  for (std::size_t i = 0; i < spectrum.size(); i++) {
    const double hertz = static_cast<double>(i) * rate / static_cast<double>(sound.size());
    if (hertz <= low || hertz >= high)
      strongest = std::max(strongest, spectrum[i]);
  }
  return decibels(strongest);
}

/// One channel of interleaved samples.
inline std::vector<float>
channel_of(std::span<const float> samples, std::size_t channels, std::size_t channel)
{
  std::vector<float> own;
  for (std::size_t i = channel; i < samples.size(); i += channels)
    own.push_back(samples[i]);
  return own;
}
