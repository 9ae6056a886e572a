// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace saliency {

/// The strength of events relative to the film's last minutes: a quiet film is felt, and a loud one
/// keeps its differences.
///
/// An upper quantile of the energies is followed by small steps. Events as strong as the geometric
/// mean of this quantile and kUsual have strength 1.
class Strength
{
public:
  /// ΔE: the quantile in usual films.
  static constexpr double kUsual = 30;

  /// The strength, ≥ 0, of events of `energy` in ΔE (EventMap::energy), `elapsed` frames at 30 fps
  /// after the last ones.
  double follow(double energy, double elapsed);

  /// A new film.
  void reset()
  {
    *this = {};
  }

private:
  double quantile_ = kUsual;
};

} // namespace saliency
