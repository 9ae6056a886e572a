// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/synthetic_sound.h"

#include "random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sound {

namespace {

using Seconds = std::chrono::duration<double>;
using visuotactile::mix_bits;
using visuotactile::Random;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kLongest = 3600;
constexpr int kBlock = 64; ///< frames; exact at its begin, by rotation within
constexpr double kNoiseTop = 7500;
constexpr double kStep = 12; ///< Hz between a noise's sines
/// In decay times: −65 dB.
constexpr double kHeard = 7.5;
/// In decay times: −20 dB.
constexpr double kFallen = 2.3;

double
amplitude(double db)
{
  return std::pow(10, db / 20);
}

/// Mean square of the envelope over the first `seconds`.
double
mean_power(double attack, double decay, double seconds)
{
  constexpr int kSteps = 200;
  double sum = 0;
  for (int i = 0; i < kSteps; i++) {
    const double t = (i + 0.5) * seconds / kSteps;
    const double level = (1 - std::exp(-t / attack)) * std::exp(-t / decay);
    sum += level * level;
  }
  return sum / kSteps;
}

template <typename Voice>
double
energy(const Voice &voice)
{
  double sum = 0;
  for (const auto &partial : voice.partials)
    sum += partial.amplitude * partial.amplitude / 2;
  return sum;
}

template <typename Voice>
void
scale(Voice &voice, double factor)
{
  for (auto &partial : voice.partials)
    partial.amplitude *= factor;
}

/// Noise as sines, one in about `step` Hz; `slope` in dB an octave.
template <typename Partial>
std::vector<Partial>
noise(Random &random, double low, double high, double step, double slope)
{
  std::vector<Partial> result;
  for (double hz = low; hz < high; hz += step * random.uniform(0.5, 1.5))
    result.push_back({ hz, amplitude(slope * std::log2(hz / low)) * random.uniform(0.5, 1.5),
                       random.uniform(0, kTurn) });
  return result;
}

} // namespace

void
pan(double across, double behind, std::span<const Speaker> speakers, std::span<double> gains)
{
  const bool has_rear = std::ranges::any_of(speakers, [](const Speaker &speaker) {
    return speaker.role == Speaker::Role::place && speaker.behind > 0;
  });
  const bool has_places = std::ranges::any_of(
      speakers, [](const Speaker &speaker) { return speaker.role == Speaker::Role::place; });
  const double side = (across + 1) / 4 * std::numbers::pi;
  const double back = has_rear ? behind / 2 * std::numbers::pi : 0;
  std::size_t rears = 0;
  for (const Speaker &speaker : speakers)
    rears += speaker.role == Speaker::Role::place && speaker.behind > 0 ? 1 : 0;
  for (std::size_t i = 0; i < speakers.size(); i++) {
    const Speaker &speaker = speakers[i];
    if (speaker.role == Speaker::Role::low)
      gains[i] = 0;
    else if (speaker.role == Speaker::Role::center)
      gains[i] = has_places ? 0 : 1;
    else
      gains[i]
          = (speaker.across < 0 ? std::cos(side) : std::sin(side))
            * (speaker.behind > 0 ? std::sin(back) * std::sqrt(2.0 / static_cast<double>(rears))
                                  : std::cos(back));
  }
}

SyntheticSound::SyntheticSound(const SoundSettings &settings) : settings_(settings)
{
  settings_.seconds = std::clamp(settings_.seconds, 0.0, kLongest);
  Random random(settings_.seed);
  const auto place = [&](double side) {
    return settings_.panned ? side * (random.below(3) - 1) : 0;
  };
  const auto behind = [&] {
    return settings_.panned && random.below(2) == 1 ? 1.0 : 0.0;
  };
  const auto seed = [&](std::uint64_t salt) {
    return mix_bits(settings_.seed * 1009 + salt + voices_.size());
  };
  const double last = settings_.seconds - 1;
  if (settings_.impacts)
    for (double at = random.uniform(1, 2); at < last; at += random.uniform(0.8, 2)) {
      const double across = place(1);
      add_impact(at, settings_.impacts_db, across, behind(), seed(1));
    }
  if (settings_.explosions)
    for (double at = random.uniform(3, 6); at < last; at += random.uniform(5, 9)) {
      const double across = place(1);
      add_explosion(at, across, behind(), seed(2));
    }
  if (settings_.rumble)
    for (double at = random.uniform(2, 5); at < last; at += random.uniform(6, 10))
      add_rumble(at, seed(3));
  if (settings_.music)
    add_music(seed(4));
}

const std::vector<SoundEvent> &
SyntheticSound::events() const
{
  return events_;
}

std::size_t
SyntheticSound::add_event(SoundKind kind, double at, double seconds, double across, double behind)
{
  events_.push_back({ kind, std::chrono::round<Time>(Seconds(at)),
                      std::chrono::round<Time>(Seconds(at + seconds)), across, behind });
  return events_.size() - 1;
}

void
SyntheticSound::add_impact(double at, double db, double across, double behind, std::uint64_t seed)
{
  Random random(seed);
  const double body_decay = random.uniform(0.05, 0.15);
  const std::size_t event = add_event(SoundKind::impact, at, kFallen * body_decay, across, behind);
  Voice body{ event, 0.002, body_decay, {} };
  const double hz = random.uniform(40, 110);
  body.partials = { { hz, 1, random.uniform(0, kTurn) },
                    { hz * random.uniform(1.4, 2.2), 0.5, random.uniform(0, kTurn) } };
  Voice crack{ event, random.uniform(0.0003, 0.0015), random.uniform(0.03, 0.12), {} };
  crack.partials = noise<Partial>(random, 100, kNoiseTop, kStep, random.uniform(-4.5, -1));

  const double body_power = energy(body) * mean_power(body.attack, body.decay, 0.1);
  const double crack_power = energy(crack) * mean_power(crack.attack, crack.decay, 0.1);
  const double share = std::pow(10, random.uniform(-3, 6) / 10); // of body to crack
  const double wanted = amplitude(db) * amplitude(db) / (1 + share);
  scale(crack, std::sqrt(wanted / crack_power));
  scale(body, std::sqrt(wanted * share / body_power));
  voices_.push_back(std::move(body));
  voices_.push_back(std::move(crack));
}

void
SyntheticSound::add_explosion(double at, double across, double behind, std::uint64_t seed)
{
  Random random(seed);
  const double decay = random.uniform(0.4, 1);
  const std::size_t event = add_event(SoundKind::explosion, at, kFallen * decay, across, behind);
  Voice roll{ event, 0.004, decay, noise<Partial>(random, 25, 400, kStep / 4, -6) };
  Voice crack{ event, 0.002, random.uniform(0.1, 0.3),
               noise<Partial>(random, 100, kNoiseTop, kStep, -4.5) };
  scale(roll, amplitude(-12) / std::sqrt(energy(roll)));
  scale(crack, amplitude(-16) / std::sqrt(energy(crack)));
  voices_.push_back(std::move(roll));
  voices_.push_back(std::move(crack));
}

void
SyntheticSound::add_rumble(double at, std::uint64_t seed)
{
  Random random(seed);
  const double decay = random.uniform(0.8, 1.6);
  const std::size_t event = add_event(SoundKind::rumble, at, kFallen * decay, 0, 0);
  Voice voice{ event, random.uniform(0.3, 0.6), decay,
               noise<Partial>(random, 25, 60, kStep / 8, -3) };
  scale(voice, amplitude(-14) / std::sqrt(energy(voice)));
  voices_.push_back(std::move(voice));
}

void
SyntheticSound::add_note(double at, double hz, double level, double across, std::uint64_t seed)
{
  Random random(seed);
  const double decay = random.uniform(0.15, 0.6);
  const std::size_t event = add_event(SoundKind::music, at, kFallen * decay, across, 0);
  Voice voice{ event, random.uniform(0.003, 0.02), decay, {} };
  const double slope = random.uniform(1, 1.8);
  for (int n = 1; n <= 16 && n * hz < kNoiseTop; n++)
    voice.partials.push_back({ n * hz, level * std::pow(n, -slope), random.uniform(0, kTurn) });
  voices_.push_back(std::move(voice));
}

void
SyntheticSound::add_hat(double at, double level, std::uint64_t seed)
{
  Random random(seed);
  const std::size_t event = add_event(SoundKind::music, at, 0.07, 0.3, 0);
  Voice voice{ event, 0.0005, 0.03, noise<Partial>(random, 4000, 15000, 4 * kStep, 0) };
  scale(voice, level / std::sqrt(energy(voice)));
  voices_.push_back(std::move(voice));
}

void
SyntheticSound::add_music(std::uint64_t seed)
{
  constexpr std::array kScale{ 0, 2, 4, 5, 7, 9, 11 }; // semitones, major
  Random random(seed);
  const double beat = 60 / random.uniform(80, 140);
  const double root = 110 * std::exp2(random.uniform(-0.5, 0.5));
  const auto hz = [&](int degree) {
    return root
           * std::exp2((12.0 * (degree / 7) + kScale[static_cast<std::size_t>(degree % 7)]) / 12);
  };
  const std::size_t first = voices_.size();
  int chord = 0;
  int beats = 0;
  for (double at = 0.3; at < settings_.seconds - 1; at += beat, beats++) {
    const std::uint64_t salt = mix_bits(seed + static_cast<std::uint64_t>(beats));
    if (beats % 4 == 0)
      chord = random.below(7);
    if (beats % 2 == 0) // bass: 39 to 147 Hz
      add_note(at, hz(chord) / (random.below(2) + 1) / (hz(chord) > 147 ? 2 : 1), 0.5, 0, salt);
    if (beats % 2 == 0 || random.below(2) == 0)
      for (const int third : { 7, 9, 11 })
        add_note(at + random.uniform(0, 0.01), hz(chord + third), 0.2, (third - 13) / 10.0,
                 mix_bits(salt + static_cast<std::uint64_t>(third)));
    for (const double half : { 0.0, 0.5 })
      if (random.below(3) > 0)
        add_note(at + half * beat, hz(chord + 14 + random.below(7)), 0.25, 0.5,
                 mix_bits(salt + 31) + static_cast<std::uint64_t>(2 * half));
    for (const double half : { 0.0, 0.5 })
      add_hat(at + half * beat, 0.1, mix_bits(salt + 47) + static_cast<std::uint64_t>(2 * half));
  }
  double power = 0;
  for (std::size_t i = first; i < voices_.size(); i++) {
    const double lasts = kHeard * voices_[i].decay;
    power += energy(voices_[i]) * mean_power(voices_[i].attack, voices_[i].decay, lasts) * lasts;
  }
  const double factor
      = amplitude(settings_.music_db) / std::sqrt(power / std::max(settings_.seconds, 1.0));
  for (std::size_t i = first; i < voices_.size(); i++)
    scale(voices_[i], factor);
}

void
SyntheticSound::render_block(int rate, std::int64_t first, const Voice &voice, double *out) const
{
  std::fill_n(out, kBlock, 0.0);
  const double step = 1.0 / rate;
  const double begin
      = static_cast<double>(first) * step - Seconds(events_[voice.event].begin).count();
  const int skip = std::max(0, static_cast<int>(std::ceil(-begin * rate)));
  if (skip >= kBlock)
    return;
  const double start = begin + skip * step;
  // Phasors that turn, some at a time: their sums do not wait for each other.
  constexpr std::size_t kLanes = 8;
  for (std::size_t from = 0; from < voice.partials.size(); from += kLanes) {
    std::array<double, kLanes> x{};
    std::array<double, kLanes> y{};
    std::array<double, kLanes> turn_x{};
    std::array<double, kLanes> turn_y{};
    for (std::size_t lane = 0; lane < std::min(kLanes, voice.partials.size() - from); lane++) {
      const Partial &partial = voice.partials[from + lane];
      if (2 * partial.hz > rate)
        continue;
      const double turn = kTurn * partial.hz * step;
      const double angle = std::fmod(kTurn * partial.hz * start, kTurn) + partial.phase;
      x[lane] = partial.amplitude * std::cos(angle);
      y[lane] = partial.amplitude * std::sin(angle);
      turn_x[lane] = std::cos(turn);
      turn_y[lane] = std::sin(turn);
    }
    for (int i = skip; i < kBlock; i++) {
      double sum = 0;
      for (std::size_t lane = 0; lane < kLanes; lane++)
        sum += y[lane];
      out[i] += sum;
      for (std::size_t lane = 0; lane < kLanes; lane++) {
        const double next = x[lane] * turn_x[lane] - y[lane] * turn_y[lane];
        y[lane] = x[lane] * turn_y[lane] + y[lane] * turn_x[lane];
        x[lane] = next;
      }
    }
  }
  const double fade = std::exp(-step / voice.decay);
  const double swell = std::exp(-step / voice.attack);
  double level = std::exp(-start / voice.decay);
  double missing = std::exp(-start / voice.attack);
  for (int i = skip; i < kBlock; i++) {
    out[i] *= level * (1 - missing);
    level *= fade;
    missing *= swell;
  }
}

void
SyntheticSound::render(int rate, std::int64_t first, std::span<const Speaker> speakers,
                       std::span<float> out) const
{
  std::ranges::fill(out, 0.0F);
  const auto frames = static_cast<std::int64_t>(out.size() / speakers.size());
  const double from = static_cast<double>(first) / rate;
  const double to = static_cast<double>(first + frames) / rate;
  std::vector<double> gains(speakers.size());
  std::array<double, kBlock> block{};
  for (const Voice &voice : voices_) {
    const SoundEvent &event = events_[voice.event];
    const double begin = Seconds(event.begin).count();
    const double end = begin + kHeard * (voice.decay + voice.attack);
    if (begin >= to || end <= from)
      continue;
    pan(event.across, event.behind, speakers, gains);
    const auto last = std::min(first + frames, static_cast<std::int64_t>(std::ceil(end * rate)));
    const auto begins = std::max(first, static_cast<std::int64_t>(begin * rate));
    for (std::int64_t at = begins / kBlock * kBlock; at < last; at += kBlock) {
      render_block(rate, at, voice, block.data());
      for (int i = 0; i < kBlock; i++) {
        const std::int64_t frame = at + i;
        if (frame < first || frame >= last)
          continue;
        float *samples = &out[static_cast<std::size_t>(frame - first) * speakers.size()];
        for (std::size_t c = 0; c < speakers.size(); c++)
          samples[c] += static_cast<float>(gains[c] * block[static_cast<std::size_t>(i)]);
      }
    }
  }
}

} // namespace sound
