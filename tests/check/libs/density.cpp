// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The density control by its closed forms: how much is felt, when, and at any frame rate.
#include "tactile/density.h"

#include "frame_rate.h"
#include "saliency_map.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <random>
#include <vector>

#include "support/check_tests.h"

using tactile::DensityControl;
using tactile::Time;
using namespace std::chrono_literals;

namespace {

constexpr double kFloor = 0.6;
const double kRange = std::log(DensityControl::kHighest);

/// Strength of the film's event at a time in seconds.
using Film = std::function<double(double)>;

/// Strengths that hold for up to two seconds each, `scale` times kFloor × [1, 4.5], log-uniform.
Film
random_film(unsigned seed, double seconds, double scale = 1)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> length(0.05, 2);
  std::uniform_real_distribution<double> strength(0, std::log(4.5));
  std::vector<double> ends;
  std::vector<double> values;
  for (double end = 0; end < seconds;) {
    end += length(generator);
    ends.push_back(end);
    values.push_back(scale * kFloor * std::exp(strength(generator)));
  }
  return [=](double time) {
    const auto place = std::ranges::upper_bound(ends, time) - ends.begin();
    return values[std::min(static_cast<std::size_t>(place), values.size() - 1)];
  };
}

/// Whether a map of this strength is felt.
bool
felt(DensityControl &control, double strength, double density, Time time)
{
  const double floor
      = control.follow(Map(1, 1, static_cast<float>(strength)).view(), kFloor, density, time);
  fail_unless(floor >= kFloor);
  fail_unless_at_most(floor, DensityControl::kHighest * kFloor * (1 + 1e-12));
  return static_cast<double>(static_cast<float>(strength)) > floor;
}

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// The share of a film that is felt.
double
felt_share(const Film &film, double density, double length, const FrameRate &rate = { 30, 1 })
{
  DensityControl control;
  double sum = 0;
  for (int i = 0; seconds(rate.frame(i)) < length; ++i)
    if (felt(control, film(seconds(rate.frame(i))), density, rate.frame(i)))
      sum += seconds(rate.frame(i + 1) - rate.frame(i));
  return sum / length;
}

} // namespace

/// With 0 and with 1 the floor is the mapping's, whatever happens. A floor of 0 stays.
CHECK_TEST(test_off)
{
  for (const double density : { 0.0, 1.0 }) {
    DensityControl control;
    for (Time time{ 0 }; time < 60s; time += 40ms)
      fail_unless_near(control.follow(Map(2, 2, 1).view(), kFloor, density, time), kFloor, 0);
  }
  DensityControl control;
  for (Time time{ 0 }; time < 60s; time += 40ms)
    fail_unless_near(control.follow(Map(2, 2, 1).view(), 0, 0.25, time), 0, 0);
}

/// Films that are felt all the time are brought to the share that is asked for.
CHECK_TEST(test_share)
{
  constexpr double kLength = 600;
  unsigned seed = 0;
  for (const double density : { 0.1, 0.25, 0.5, 0.75 })
    for (int i = 0; i < 5; ++i) {
      const double share = felt_share(random_film(++seed, kLength), density, kLength);
      fail_unless_at_most(share, density + kRange / (DensityControl::kRate * kLength) + 1e-3);
      fail_unless(share > density - 0.03, "%g of %g", share, density);
    }
}

/// The bound at any time, of any film whose events the control may drop. Weaker films are left as
/// they are.
CHECK_TEST(test_bound)
{
  unsigned seed = 100;
  for (const double density : { 0.05, 0.25, 0.6 })
    for (const double length : { 2.0, 10.0, 30.0, 100.0 })
      for (const double scale : { 0.5, 1.0, 1.06 }) {
        const double share = felt_share(random_film(++seed, length, scale), density, length);
        fail_unless_at_most(share, density + (kRange + 0.02) / (DensityControl::kRate * length));
      }

  const Film sparse = [](double time) {
    return std::fmod(time, 10) < 1 ? 2 * kFloor : 0;
  };
  fail_unless_near(felt_share(sparse, 0.25, 100), 0.1, 1e-3);
}

/// An event that stays: the times at which it goes and comes, by the rates.
CHECK_TEST(test_event_that_stays)
{
  constexpr double kStrength = 2; // of the floor
  const double hold = std::log(1 / DensityControl::kHold);
  for (const double density : { 0.1, 0.25, 0.5 }) {
    DensityControl control;
    const double up = DensityControl::kRate * (1 - density);
    const double down = DensityControl::kRate * density;
    std::vector<double> expected{ (std::log(kStrength) + hold) / up };
    for (int i = 0; i < 4; ++i) {
      expected.push_back(expected.back() + hold / down);
      expected.push_back(expected.back() + hold / up);
    }
    std::vector<double> switches;
    bool last = true;
    for (Time time{ 0 }; switches.size() < expected.size(); time += 1ms)
      if (const bool now = felt(control, kStrength * kFloor, density, time); now != last) {
        switches.push_back(seconds(time));
        last = now;
      }
    for (std::size_t i = 0; i < expected.size(); ++i)
      // A millisecond too long at one rate is made up for at the other.
      fail_unless_near(switches[i], expected[i],
                       0.001 * static_cast<double>(i + 1) * (1 + up / down));
  }
}

/// The strongest events are always felt, and after silence every event is.
CHECK_TEST(test_what_stays)
{
  for (const double density : { 0.02, 0.25, 0.75 }) {
    DensityControl control;
    const Film film = random_film(7, 60);
    Time time{ 0 };
    for (int i = 0; time < 60s; time += 40ms, ++i)
      if (i % 50 == 49)
        fail_unless(felt(control, 1.001 * DensityControl::kHighest * kFloor, density, time));
      else
        felt(control, film(seconds(time)), density, time);

    // The floor rises so far and no further.
    for (const Time begin = time; time < begin + 120s; time += 40ms)
      fail_unless(felt(control, 20 * kFloor, density, time));
    fail_unless_near(control.follow(Map(1, 1).view(), kFloor, density, time),
                     DensityControl::kHighest * DensityControl::kHold * kFloor, 1e-9);

    const Time silence(std::llround(1e9 * kRange / (DensityControl::kRate * density)));
    const Time begin = time;
    for (; time < begin + silence + 80ms; time += 40ms)
      fail_if(felt(control, 0.99 * kFloor, density, time));
    fail_unless(felt(control, 1.001 * kFloor, density, time));
  }
}

/// Of two kinds of events that alternate, the weaker ones are dropped.
CHECK_TEST(test_weaker_ones_first)
{
  DensityControl control;
  int strong = 0;
  int weak = 0;
  for (int i = 0; i < 120 * 30; ++i) {
    const bool is_strong = i / 30 % 4 == 0; // a quarter of the time
    const bool is_felt
        = felt(control, (is_strong ? 4 : 2) * kFloor, 0.25, FrameRate{ 30, 1 }.frame(i));
    if (i >= 20 * 30)
      (is_strong ? strong : weak) += is_felt ? 1 : 0;
  }
  fail_unless(strong >= 0.95 * 25 * 30, "%d frames of strong events", strong);
  fail_unless(weak <= 0.05 * 75 * 30, "%d frames of weak ones", weak);
}

/// At any frame rate the same share is felt, within 0.02, and the same moments: all but 6 %.
CHECK_TEST(test_rates_agree)
{
  constexpr double kLength = 120;
  const Film film = random_film(11, kLength);
  const auto moments = [&](const FrameRate &rate) {
    DensityControl control;
    std::vector<bool> each; // millisecond
    for (int i = 0; seconds(rate.frame(i)) < kLength; ++i)
      each.resize(static_cast<std::size_t>(rate.frame(i + 1) / 1ms),
                  felt(control, film(seconds(rate.frame(i))), 0.25, rate.frame(i)));
    each.resize(static_cast<std::size_t>(kLength * 1000));
    return each;
  };
  const std::vector<bool> reference = moments({ 1000, 1 });
  for (const FrameRate &rate :
       { FrameRate{ 24, 1 }, { 25, 1 }, { 30000, 1001 }, { 50, 1 }, { 60, 1 } }) {
    const std::vector<bool> own = moments(rate);
    int others = 0;
    for (std::size_t i = 0; i < own.size(); ++i)
      others += own[i] != reference[i];
    fail_unless_at_most(others, 0.06 * static_cast<double>(own.size()));
    fail_unless_near(static_cast<double>(std::ranges::count(own, true)) / own.size(),
                     static_cast<double>(std::ranges::count(reference, true)) / own.size(), 0.02);
  }
}

/// The past is dropped by reset(), by a time that goes back and while the control is off; a gap
/// counts for a second.
CHECK_TEST(test_resets)
{
  DensityControl control;
  const auto raise = [&] {
    for (Time time{ 10s }; time <= 20s; time += 40ms)
      felt(control, 4 * kFloor, 0.25, time);
    fail_if(felt(control, 1.2 * kFloor, 0.25, 20s));
  };
  raise();
  fail_unless(felt(control, 1.2 * kFloor, 0.25, 20s - 1ns));
  control.reset();
  raise();
  control.reset();
  fail_unless(felt(control, 1.2 * kFloor, 0.25, 20s));
  control.reset();
  raise();
  fail_unless(felt(control, 1.2 * kFloor, 0, 20s));
  fail_unless(felt(control, 1.2 * kFloor, 0.25, 20s));

  control.reset();
  fail_unless(felt(control, 1.2 * kFloor, 0.25, 0s));
  fail_unless(felt(control, 1.2 * kFloor, 0.25, 0s)); // no time passes
  const double floor = control.follow(Map(1, 1).view(), kFloor, 0.25, 3600s);
  fail_unless_near(floor, kFloor * std::exp(DensityControl::kRate * 0.75) * DensityControl::kHold,
                   1e-9);
}

CHECK_MAIN(density)
