// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/listener.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace listen {

namespace {

constexpr double kSteps = Onsets::kOnsetRate; ///< a second
constexpr std::int64_t
steps(double seconds)
{
  return static_cast<std::int64_t>(seconds * kSteps);
}

constexpr std::int64_t kHeld = steps(12);
constexpr std::int64_t kLooksEvery = steps(0.5);
constexpr std::size_t kVotesAStep = 25'000; ///< a tenth of a core counts so many
constexpr std::int64_t kLeast = steps(2);   ///< shortest sound for a search
constexpr std::int64_t kMost = steps(10);   ///< longest sound for a search
constexpr std::size_t kPlaces = 24;         ///< found by a search and compared
constexpr int kReach = 75;                  ///< steps compared on each side of a place
constexpr double kStill = 5;                ///< least score while the film continues
constexpr double kNear = 12;                ///< most steps by which the origin moves
constexpr std::int64_t kWindow = steps(4);
constexpr int kMostMisses = 6; ///< 3 s
// The end of a film shows sooner in the newest sound alone, if this sound usually fits.
constexpr std::int64_t kShortWindow = steps(1.5);
constexpr int kMostAbsent = 3;
constexpr double kUsually = 0.8;
constexpr double kForgets = 0.1; ///< weight of a comparison in Lock::present
// The place that was found first may be a repetition of the true one.
constexpr int kLooksAround = 24; ///< comparisons: 12 s
constexpr int kLookAroundEvery = 4;
constexpr std::size_t kOrigins = 9;
constexpr double kLostSound = 40e6; ///< ns

/// Film seconds a second.
constexpr std::array<double, 3> kRates = { 1, 25.0 / 24, 24.0 / 25 };

} // namespace

Listener::Listener(const Catalogue &catalogue, int rate)
    : catalogue_(catalogue), rate_(rate), downsampler_(rate), peak_finder_(kHeardPeaks)
{
}

std::optional<Heard>
Listener::add(std::span<const float> mono, Time at)
{
  keep_time(mono.size(), at);
  take_sound(mono);
  const std::int64_t wait
      = lock_ ? kLooksEvery : std::max(kLooksEvery, std::min(steps_ - fresh_, kMost) / 10);
  if (steps_ - looked_at_ < wait + static_cast<std::int64_t>(votes_ / kVotesAStep)
      || steps_ - fresh_ < kLeast)
    return std::nullopt;
  looked_at_ = steps_;
  votes_ = 0;
  return lock_ ? track() : search();
}

/// Smooths the times of a card's blocks, which vary a little.
void
Listener::keep_time(std::size_t count, Time at)
{
  const double began = static_cast<double>(at.count()) - static_cast<double>(count_) / rate_ * 1e9;
  if (began_ && std::abs(began - *began_) > kLostSound)
    forget();
  began_ = began_ ? *began_ + (began - *began_) * 0.02 : began;
  count_ += static_cast<std::int64_t>(count);
}

/// Drops the film and earlier sound, after missing sound.
void
Listener::forget()
{
  began_.reset();
  lock_.reset();
  decision_.forget();
  fresh_ = steps_;
}

void
Listener::take_sound(std::span<const float> mono)
{
  samples_.clear();
  downsampler_.add(mono, samples_);
  peak_finder_.add(samples_);
  onset_finder_.add(samples_);
  for (const Peak &peak : peak_finder_.take())
    peaks_.push_back(peak);
  for (const Onset &onset : onset_finder_.take()) {
    onsets_.push_back(onset);
    steps_++;
  }
  while (static_cast<std::int64_t>(onsets_.size()) > kHeld)
    onsets_.pop_front();
  const std::int64_t first
      = (steps_ - static_cast<std::int64_t>(onsets_.size())) * Onsets::kHop / PeakFinder::kHop;
  while (!peaks_.empty() && peaks_.front().frame < first)
    peaks_.pop_front();
}

/// Weighted changes of the newest onsets.
std::vector<Bands>
Listener::newest(std::int64_t onsets) const
{
  const auto count = std::min(static_cast<std::ptrdiff_t>(onsets), std::ssize(onsets_));
  return weighted(std::vector<Onset>(onsets_.end() - count, onsets_.end()));
}

/// Compares the newest() with a film. `step`: the estimate of Lock::origin.
std::optional<Fit>
Listener::fit_at(std::size_t film, double rate, double step, std::span<const Bands> changes,
                 int near) const
{
  const double first = static_cast<double>(steps_ - std::ssize(changes)) * rate;
  const std::int64_t from = std::llround(step + first) - kReach;
  const auto reference
      = catalogue_.films()[film].reference(from, reference_steps(changes.size(), rate, kReach));
  if (!reference)
    return std::nullopt;
  Fit found = fit(changes, *reference, rate, kReach, near);
  found.step += static_cast<double>(from) - first;
  return found;
}

void
Listener::look_up(double rate, std::span<const Bands> changes, std::vector<Candidate> &found)
{
  const double first
      = static_cast<double>(steps_ - std::ssize(changes)) * Onsets::kHop / PeakFinder::kHop;
  std::vector<Peak> peaks;
  for (const Peak &peak : peaks_)
    if (static_cast<double>(peak.frame) >= first) {
      peaks.push_back(peak);
      peaks.back().frame -= static_cast<std::int64_t>(first);
    }
  constexpr double kOfFrame = static_cast<double>(PeakFinder::kHop) / Onsets::kHop; // steps
  const HashIndex::Found fitting = catalogue_.index().search(heard_hashes(peaks, rate), kPlaces);
  votes_ += fitting.votes;
  for (const Place &place : fitting.places) {
    const double step = (static_cast<double>(place.frame) - std::floor(first) * rate) * kOfFrame;
    add_place(place.film, rate, step, changes, found);
  }
}

void
Listener::add_place(std::size_t film, double rate, double step, std::span<const Bands> changes,
                    std::vector<Candidate> &found) const
{
  if (const auto fit = fit_at(film, rate, step, changes, kReach))
    found.push_back({ .film = film, .rate = rate, .step = fit->step, .score = fit->score });
}

/// The longest sound that searches use.
std::vector<Bands>
Listener::searched() const
{
  return newest(steps_ - std::max(fresh_, steps_ - kMost));
}

std::optional<Heard>
Listener::search()
{
  std::vector<Candidate> found;
  const std::vector<Bands> changes = searched();
  for (const double rate : kRates)
    look_up(rate, changes, found);
  for (const Candidate &hope : decision_.hopes()) // also those that hashes no longer find
    add_place(hope.film, hope.rate, hope.step, changes, found);
  const auto best = decision_.take(found, steps_, [&](const Candidate &place, std::int64_t since) {
    const auto fit = fit_at(place.film, place.rate, place.step, newest(steps_ - since),
                            static_cast<int>(kSame));
    return fit ? fit->score : 0;
  });
  if (!best)
    return std::nullopt;
  lock_ = Lock{
    .film = best->film, .rate = best->rate, .origin = best->step, .origins = { best->step }
  };
  Heard now = heard(*lock_, best->score);
  now.begins = true;
  return now;
}

/// Forgets the place where another is better.
void
Listener::look_around()
{
  std::vector<Candidate> found;
  const std::vector<Bands> changes = searched();
  look_up(lock_->rate, changes, found);
  const auto here = fit_at(lock_->film, lock_->rate, lock_->origin, changes, kReach);
  const bool is_worse
      = here && std::ranges::any_of(found, [&](const Candidate &one) {
          return one.score > here->score
                 && (one.film != lock_->film || std::abs(one.step - lock_->origin) > kNear);
        });
  if (is_worse)
    lock_.reset();
}

std::optional<Heard>
Listener::track()
{
  if (++lock_->looks <= kLooksAround && lock_->looks % kLookAroundEvery == 0)
    look_around();
  if (!lock_)
    return search();
  Lock &lock = *lock_;
  const bool there = is_there(lock);
  const auto found = fit_at(lock.film, lock.rate, lock.origin, newest(kWindow), kReach);
  const bool fits = found && found->score >= kStill && std::abs(found->step - lock.origin) <= kNear;
  lock.misses = fits ? 0 : lock.misses + 1;
  if (!found || lock.misses > kMostMisses || lock.absent >= kMostAbsent) {
    lock_.reset();
    fresh_ = std::max(fresh_, steps_ - kShortWindow);
    return std::nullopt;
  }
  if (!fits || !there)
    return std::nullopt;
  lock.origins.push_back(found->step);
  if (lock.origins.size() > kOrigins)
    lock.origins.pop_front();
  std::vector<double> sorted(lock.origins.begin(), lock.origins.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  lock.origin = *middle;
  return heard(lock, found->score);
}

/// Whether the newest sound fits the film, or seldom fits it.
bool
Listener::is_there(Lock &lock) const
{
  const auto found = fit_at(lock.film, lock.rate, lock.origin, newest(kShortWindow), kReach);
  const bool fits = found && std::abs(found->step - lock.origin) <= kSame;
  const bool shows = lock.present >= kUsually;
  lock.absent = fits || !shows ? 0 : lock.absent + 1;
  if (fits || !shows) // misses that count as absent do not lower it
    lock.present += ((fits ? 1 : 0) - lock.present) * kForgets;
  return fits || !shows;
}

Heard
Listener::heard(const Lock &lock, double score) const
{
  const double seconds = static_cast<double>(steps_) / kSteps;
  return { .film = lock.film,
           .at = Time(std::llround(*began_ + seconds * 1e9)),
           .position = Time(std::llround((lock.origin / kSteps + seconds * lock.rate) * 1e9)),
           .rate = lock.rate,
           .score = score };
}

} // namespace listen
