// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

namespace tactor {

/// Frequencies that are let through, with raised-cosine edges a fifth as wide as the edge's
/// frequency.
struct Band
{
  double low_hz = 20;
  double high_hz = 300;
};

/// The part of a signal that lies in a band, of zero phase. The signal is taken to be zero beyond
/// its ends. `rate` in samples per second, > 0.
std::vector<double> band_pass(std::span<const double> signal, double rate, Band band);

/// Amplitude of a signal over time: the magnitude of its analytic signal (Hilbert transform), of
/// what lies in the band.
std::vector<double> envelope(std::span<const double> signal, double rate, Band band);

/// The same of all of it.
std::vector<double> envelope(std::span<const double> signal);

/// Frequency of the strongest line between 10 Hz and half the rate, in Hz; 0 if the signal is
/// silent.
double strongest_frequency(std::span<const double> signal, double rate);

} // namespace tactor
