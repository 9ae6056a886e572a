// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/catalogue.h"
#include "listen/correlation.h"
#include "listen/decision.h"
#include "listen/film_sound.h"

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace listen {

/// A film that is heard.
struct Heard
{
  std::size_t film = 0; ///< of the catalogue
  Time at{ 0 };         ///< local time of the newest sound that was analyzed
  Time position{ 0 };   ///< of the film at this time
  double rate = 1;      ///< film seconds a second
  double score = 0;     ///< in standard deviations of chance
  bool begins = false;  ///< another film or place than before
};

/// Detects the film that plays and its position, twice a second. A search compares the sound with
/// all films, also at the speeds 25/24 and 24/25; after a find, the sound is compared with this
/// film alone. Searches of more than 5 s, or of a large catalogue, are less frequent. Sound is
/// dropped after 12 seconds. Reads no clock; not thread-safe.
class Listener
{
public:
  /// `rate`: of the sound in Hz. The catalogue must outlive this.
  Listener(const Catalogue &catalogue, int rate);

  /// Adds sound whose first sample was heard at this local time. Returns the film if this call has
  /// found or confirmed it.
  std::optional<Heard> add(std::span<const float> mono, Time at);

  bool knows() const
  {
    return lock_.has_value();
  }

private:
  struct Lock
  {
    std::size_t film = 0;
    double rate = 1;              ///< nominal
    double origin = 0;            ///< step of the film at step 0 of the heard sound
    std::deque<double> origins{}; ///< the last measured ones; `origin` is their median
    int looks = 0;                ///< comparisons so far
    int misses = 0;               ///< comparisons in a row that did not fit
    int absent = 0;               ///< likewise, of the newest sound alone
    double present = 0;           ///< share of comparisons that fit it
  };

  void keep_time(std::size_t count, Time at);
  void take_sound(std::span<const float> mono);
  std::optional<Heard> search();
  std::vector<Bands> newest(std::int64_t onsets) const;
  std::vector<Bands> searched() const;
  void look_up(double rate, std::span<const Bands> changes, std::vector<Candidate> &found);
  void add_place(std::size_t film, double rate, double step, std::span<const Bands> changes,
                 std::vector<Candidate> &found) const;
  std::optional<Heard> track();
  bool is_there(Lock &lock) const;
  void look_around();
  std::optional<Fit> fit_at(std::size_t film, double rate, double step,
                            std::span<const Bands> changes, int near) const;
  Heard heard(const Lock &lock, double score) const;
  void forget();

  const Catalogue &catalogue_;
  const int rate_;
  Downsampler downsampler_;
  PeakFinder peak_finder_;
  Onsets onset_finder_;
  std::vector<float> samples_;
  std::int64_t count_ = 0;        ///< samples that came in
  std::optional<double> began_{}; ///< local time of sample 0, ns
  std::deque<Peak> peaks_;
  std::deque<Onset> onsets_;
  std::int64_t steps_ = 0;     ///< onsets so far
  std::int64_t fresh_ = 0;     ///< step from which on searches use the sound
  std::int64_t looked_at_ = 0; ///< step
  std::size_t votes_ = 0;      ///< of the last search
  Decision decision_;
  std::optional<Lock> lock_;
};

} // namespace listen
