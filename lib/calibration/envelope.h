// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

namespace tactor {

/// Pass band, with raised-cosine edges; the width of an edge is a fifth of its frequency.
struct Band
{
  double low_hz = 20;
  double high_hz = 300;
};

/// Zero-phase band-pass filter. The signal is taken as zero beyond its ends. `rate` in samples per
/// second, > 0.
std::vector<double> band_pass(std::span<const double> signal, double rate, Band band);

/// Envelope of the band-passed signal: the magnitude of its analytic signal (Hilbert transform).
std::vector<double> envelope(std::span<const double> signal, double rate, Band band);

/// The same without a band-pass filter.
std::vector<double> envelope(std::span<const double> signal);

/// Frequency of the strongest spectral line between 10 Hz and half the rate, in Hz; 0 for a silent
/// signal.
double strongest_frequency(std::span<const double> signal, double rate);

} // namespace tactor
