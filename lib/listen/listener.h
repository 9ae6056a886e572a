// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/catalogue.h"
#include "listen/correlation.h"
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
  Time at{ 0 };         ///< local time of the newest sound that was looked at
  Time position{ 0 };   ///< of the film, then
  double rate = 1;      ///< film seconds a second
  double score = 0;     ///< of chance's standard deviations
  bool begins = false;  ///< found anew: another film, or elsewhere
};

/// Hears which film plays, and where it is. While it does not know, it looks for all films, also as
/// fast as 24 frames a second become 25, or 25 become 24; once it knows, it compares the sound with
/// that film alone, twice a second. It drops the sound after 12 seconds. Reads no clock; not
/// thread-safe.
class Listener
{
public:
  /// `rate` of the sound in Hz; the catalogue is used as long as this lives.
  Listener(const Catalogue &catalogue, int rate);

  /// Sound, whose first sample was heard at a local time. Returns what is known of it, if it was
  /// looked at; nothing while it is not known.
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
    double origin = 0;            ///< step of the film at step 0 of what is heard, as it was last
    std::deque<double> origins{}; ///< the last ones
    int misses = 0;               ///< looks in turn that did not fit
    int absent = 0;               ///< likewise, of the newest sound alone
    double present = 0;           ///< share of looks that it fits
  };
  /// A place that a search found, in steps as Lock::origin.
  struct Candidate
  {
    std::size_t film = 0;
    double rate = 1;
    double step = 0;
    double score = 0;
    bool is_at(const Candidate &other) const;
  };
  struct Hope
  {
    Candidate candidate;
    std::int64_t since = 0; ///< step
  };

  void keep_time(std::size_t count, Time at);
  void take_sound(std::span<const float> mono);
  std::optional<Heard> search();
  void look_up(double rate, std::vector<Candidate> &found) const;
  bool is_sure(const Candidate &candidate);
  std::optional<Heard> track();
  bool is_there(Lock &lock) const;
  std::optional<Fit> fit_at(std::size_t film, double rate, double step, std::int64_t onsets,
                            int reach) const;
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
  std::int64_t steps_ = 0;     ///< onsets that came
  std::int64_t fresh_ = 0;     ///< step from which on nothing else was heard
  std::int64_t looked_at_ = 0; ///< step
  int round_ = 0;
  std::optional<Hope> hope_; ///< it may be this
  std::optional<Lock> lock_;
};

} // namespace listen
