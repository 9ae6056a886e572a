// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen_sounds.h"

#include "random.h"

#include <gst/fft/gstfftf32.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <utility>

using visuotactile::Random;

namespace listen_bench {

namespace {

std::size_t
samples(double seconds)
{
  return static_cast<std::size_t>(seconds * kSoundRate);
}

Sound
read(const std::filesystem::path &path)
{
  std::ifstream file(path, std::ios::binary);
  std::vector<std::int16_t> words(std::filesystem::file_size(path) / 2);
  file.read(reinterpret_cast<char *>(words.data()), static_cast<std::streamsize>(words.size() * 2));
  Sound sound(words.size());
  std::ranges::transform(words, sound.begin(),
                         [](std::int16_t word) { return static_cast<float>(word) / 32768; });
  return sound;
}

double
power(std::span<const float> sound)
{
  double sum = 1e-12;
  for (const float sample : sound)
    sum += static_cast<double>(sample) * sample;
  return sum / static_cast<double>(std::max<std::size_t>(sound.size(), 1));
}

double
gain(double decibels)
{
  return std::pow(10, decibels / 20);
}

/// Adds a part of a sound, at another speed, from a place of the mix on. Fades within 50 ms.
void
add(Sound &mix, std::size_t to, std::size_t count, const Sound &from, double begin, double speed,
    double level)
{
  constexpr double kFade = 800;
  for (std::size_t i = 0; i < count && to + i < mix.size(); i++) {
    const double at = begin + static_cast<double>(i) * speed;
    const auto before = static_cast<std::size_t>(at);
    if (before + 1 >= from.size())
      break;
    const double part = at - static_cast<double>(before);
    const double fade
        = std::min({ 1.0, static_cast<double>(i) / kFade, static_cast<double>(count - i) / kFade });
    mix[to + i]
        += static_cast<float>(level * fade * (from[before] * (1 - part) + from[before + 1] * part));
  }
}

/// A stretch of one of these sounds.
struct Stretch
{
  const Sound *from;
  double begin;
  double speed;
};

Stretch
any_of(const std::vector<Sound> &of, std::size_t count, Random &random, double least_speed,
       double most_speed)
{
  const Sound &from = of[static_cast<std::size_t>(random.below(static_cast<int>(of.size())))];
  const double speed = random.uniform(least_speed, most_speed);
  const double room = static_cast<double>(from.size()) - static_cast<double>(count) * speed - 2;
  return { .from = &from, .begin = room > 0 ? random.uniform(0, room) : 0, .speed = speed };
}

/// Adds a stretch of a recording, normalized.
void
add_normalized(Sound &mix, std::size_t to, std::size_t count, const Stretch &of, double level)
{
  const auto first = static_cast<std::size_t>(of.begin);
  const auto used = std::min(of.from->size() - first,
                             static_cast<std::size_t>(static_cast<double>(count) * of.speed));
  add(mix, to, count, *of.from, of.begin, of.speed,
      level / std::sqrt(power(std::span(*of.from).subspan(first, used))));
}

void
add_notes(Sound &mix, std::size_t to, std::size_t count, Random &random)
{
  for (std::size_t at = 0; at < count;) {
    const double pitch = 110 * std::pow(2, random.below(36) / 12.0);
    const double length = random.uniform(0.15, 1.2);
    const double level = random.uniform(0.02, 0.1);
    std::array<double, 6> parts{};
    for (double &part : parts)
      part = random.uniform(0, 1);
    const std::size_t end = std::min({ samples(length), count - at, mix.size() - to - at });
    for (std::size_t i = 0; i < end; i++) {
      const double time = static_cast<double>(i) / kSoundRate;
      const double shape = std::min(time / 0.01, 1.0) * std::exp(-3 * time / length);
      double value = 0;
      for (std::size_t part = 0; part < parts.size(); part++)
        value += parts[part]
                 * std::sin(2 * std::numbers::pi * pitch * static_cast<double>(part + 1) * time);
      mix[to + at + i] += static_cast<float>(level * shape * value);
    }
    at += samples(random.uniform(0.05, 0.5));
  }
}

void
add_bursts(Sound &mix, std::size_t to, std::size_t count, Random &random)
{
  for (std::size_t at = 0; at < count;) {
    const double decay = random.uniform(0.02, 0.4);
    const double level = random.uniform(0.02, 0.4);
    const double smooth = random.uniform(0.1, 1);
    double value = 0;
    const std::size_t end = std::min({ samples(4 * decay), count - at, mix.size() - to - at });
    for (std::size_t i = 0; i < end; i++) {
      value += smooth * (random.uniform(-1, 1) - value);
      mix[to + at + i] += static_cast<float>(
          level * value * std::exp(-static_cast<double>(i) / kSoundRate / decay));
    }
    at += samples(random.uniform(0.2, 3));
  }
}

/// Sums of spectra of the next power of two.
Sound
convolved(const Sound &sound, const Sound &response)
{
  int size = 2;
  while (size < static_cast<int>(sound.size() + response.size()))
    size *= 2;
  GstFFTF32 *there = gst_fft_f32_new(size, FALSE);
  GstFFTF32 *back = gst_fft_f32_new(size, TRUE);
  const auto spectrum = [&](Sound padded) {
    padded.resize(static_cast<std::size_t>(size));
    std::vector<std::complex<float>> bins(static_cast<std::size_t>(size) / 2 + 1);
    gst_fft_f32_fft(there, padded.data(), reinterpret_cast<GstFFTF32Complex *>(bins.data()));
    return bins;
  };
  auto bins = spectrum(sound);
  const auto other = spectrum(response);
  for (std::size_t i = 0; i < bins.size(); i++)
    bins[i] *= other[i] / static_cast<float>(size);
  Sound result(static_cast<std::size_t>(size));
  gst_fft_f32_inverse_fft(back, reinterpret_cast<GstFFTF32Complex *>(bins.data()), result.data());
  gst_fft_f32_free(there);
  gst_fft_f32_free(back);
  result.resize(sound.size());
  return result;
}

} // namespace

Pool::Pool(const std::string &folder, int titles, double seconds, std::uint64_t seed)
    : seed_(seed * 1'000'003)
{
  std::vector<std::filesystem::path> paths;
  for (const auto &entry : std::filesystem::directory_iterator(folder))
    if (entry.file_size() > 0)
      paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::size_t count = 0;
  std::size_t games = 0;
  std::string game;
  for (const auto &path : paths) {
    const std::string name = path.filename().string();
    if (name.starts_with("music_")) {
      // Tunes of a game may have bars or instruments in common, so that others are of other games.
      if (game != name.substr(0, name.find("_usr"))) {
        game = name.substr(0, name.find("_usr"));
        games++;
      }
      (games % 5 == 0 ? other_music_ : music_).push_back(read(path));
    } else if (name.starts_with("speech_")) {
      (count++ % 4 == 0 ? other_speech_ : speech_).push_back(read(path));
    } else if (name.starts_with("effect_")) {
      (count++ % 5 == 0 ? other_effects_ : effects_).push_back(read(path));
    }
  }
  if (music_.empty() || speech_.empty() || effects_.empty())
    throw std::runtime_error("'" + folder
                             + "': expected music_*.s16, speech_*.s16 and effect_*.s16");
  for (int title = 0; title < titles; title++)
    titles_.push_back(pieces(title, seconds));
}

std::vector<Pool::Piece>
Pool::pieces(int number, double seconds) const
{
  constexpr double kSame = 0.02; // of the speed
  // As they are, and where one or both are heard at 25/24 of their speed, or at 24/25.
  constexpr std::array kPlayed = { 1.0, 24.0 / 25, 24.0 * 24 / 25 / 25 };
  constexpr double kEffect = 3; // s: longest
  constexpr int kTries = 1000;
  Random random((seed_ + static_cast<std::uint64_t>(number)) * 7919 + 1);
  const bool others = number >= kOthers;
  std::vector<Piece> made;
  if (number % 4 == 3)
    return made;
  const auto is_heard = [&](const Piece &one) {
    const auto clashes = [&](const Piece &other) {
      if (other.from != one.from || other.count <= samples(kEffect)
          || other.begin > one.begin + static_cast<double>(one.count) * one.speed
          || one.begin > other.begin + static_cast<double>(other.count) * other.speed)
        return false;
      const double ratio = std::max(one.speed, other.speed) / std::min(one.speed, other.speed);
      return std::ranges::any_of(
          kPlayed, [&](double played) { return std::abs(ratio * played - 1) < kSame; });
    };
    return std::ranges::any_of(made, clashes)
           || std::ranges::any_of(
               titles_, [&](const auto &title) { return std::ranges::any_of(title, clashes); });
  };
  const auto add_piece = [&](std::size_t at, std::size_t length, const std::vector<Sound> &of,
                             double level, double least_speed, double most_speed) {
    for (int tries = 0; tries < kTries; tries++) {
      const Stretch any = any_of(of, length, random, least_speed, most_speed);
      const Piece piece{ .from = any.from,
                         .to = at,
                         .count = length,
                         .begin = any.begin,
                         .speed = any.speed,
                         .level = level };
      if (length > samples(kEffect) && !others && is_heard(piece))
        continue;
      made.push_back(piece);
      return;
    }
  };
  const std::size_t size = samples(seconds);
  for (std::size_t at = 0; at < size;) {
    const std::size_t count = std::min(samples(random.uniform(8, 25)), size - at);
    const int kind = random.below(10);
    if (kind < 7)
      add_piece(at, count, others ? other_music_ : music_, 0.1 * gain(random.uniform(-18, 0)), 0.75,
                1.3);
    if (kind >= 4)
      add_piece(at, count, others ? other_speech_ : speech_, 0.1 * gain(random.uniform(-6, 0)), 0.7,
                1.4);
    for (std::size_t then = at; then < at + count; then += samples(random.uniform(0.5, 6)))
      add_piece(then, std::min(samples(random.uniform(0.5, kEffect)), at + count - then),
                others ? other_effects_ : effects_, 0.1 * gain(random.uniform(-15, 3)), 0.7, 1.4);
    at += count;
  }
  return made;
}

Sound
Pool::film(int number, double seconds) const
{
  Random random((seed_ + static_cast<std::uint64_t>(number)) * 104'729 + 1);
  Sound mix(samples(seconds));
  if (number % 4 == 3)
    for (std::size_t at = 0; at < mix.size();) {
      const std::size_t count = std::min(samples(random.uniform(8, 25)), mix.size() - at);
      if (random.below(4) != 0)
        add_notes(mix, at, count, random);
      add_bursts(mix, at, count, random);
      at += count;
    }
  const auto title = static_cast<std::size_t>(number);
  for (const Piece &one : title < titles_.size() ? titles_[title] : pieces(number, seconds))
    add_normalized(mix, one.to, one.count,
                   { .from = one.from, .begin = one.begin, .speed = one.speed }, one.level);
  for (float &sample : mix)
    sample += static_cast<float>(random.uniform(-1, 1) * 2e-4); // the recording's
  return mix;
}

Sound
Pool::music(std::uint64_t seed, double seconds) const
{
  Random random((seed_ + seed) ^ 0x6d75736963U);
  Sound mix(samples(seconds));
  for (std::size_t at = 0; at < mix.size();) {
    const std::size_t count = std::min(samples(random.uniform(20, 90)), mix.size() - at);
    add_normalized(mix, at, count, any_of(other_music_, count, random, 0.9, 1.1), 0.1);
    at += count;
  }
  return mix;
}

Sound
Pool::speech(std::uint64_t seed, double seconds) const
{
  Random random((seed_ + seed) ^ 0x737065656368U);
  Sound mix(samples(seconds));
  for (std::size_t at = 0; at < mix.size();) {
    const std::size_t count = std::min(samples(random.uniform(10, 30)), mix.size() - at);
    add_normalized(mix, at, count, any_of(other_speech_, count, random, 0.9, 1.1), 0.1);
    at += count;
  }
  return mix;
}

Sound
pink_noise(std::uint64_t seed, double seconds)
{
  // P. Kellet's filter.
  Random random(seed ^ 0x70696e6bU);
  Sound noise(samples(seconds));
  double a = 0;
  double b = 0;
  double c = 0;
  for (float &sample : noise) {
    const double white = random.uniform(-1, 1);
    a = 0.99765 * a + white * 0.0990460;
    b = 0.96300 * b + white * 0.2965164;
    c = 0.57000 * c + white * 1.0526913;
    sample = static_cast<float>(0.1 * (a + b + c + white * 0.1848));
  }
  return noise;
}

Sound
in_room(const Sound &sound, double decay, std::uint64_t seed)
{
  Random random(seed ^ 0x726f6f6dU);
  Sound response(samples(decay));
  for (std::size_t i = 0; i < response.size(); i++)
    response[i] = static_cast<float>(
        random.uniform(-1, 1)
        * std::pow(10, -3 * static_cast<double>(i) / static_cast<double>(response.size())));
  // Reflections begin 2 ms after the direct sound.
  std::fill_n(response.begin(), std::min<std::size_t>(32, response.size()), 0.0F);
  const double rest = power(response) * static_cast<double>(response.size());
  response[0] = static_cast<float>(std::sqrt(rest));
  return convolved(sound, response);
}

Sound
by_telephone(const Sound &sound)
{
  // Between 150 and 3400 Hz, by Butterworth filters of the second order, each twice.
  Sound passed = sound;
  const auto filter = [&](double frequency, bool high) {
    const double turn = 2 * std::numbers::pi * frequency / kSoundRate;
    const double alpha = std::sin(turn) / std::numbers::sqrt2;
    const double cosine = std::cos(turn);
    const double a0 = 1 + alpha;
    const double b1 = high ? -(1 + cosine) / a0 : (1 - cosine) / a0;
    const double b0 = std::abs(b1) / 2;
    double x1 = 0;
    double x2 = 0;
    double y1 = 0;
    double y2 = 0;
    for (float &sample : passed) {
      const double out
          = b0 * sample + b1 * x1 + b0 * x2 + 2 * cosine / a0 * y1 - (1 - alpha) / a0 * y2;
      x2 = std::exchange(x1, sample);
      y2 = std::exchange(y1, out);
      sample = static_cast<float>(out);
    }
  };
  for (int twice = 0; twice < 2; twice++) {
    filter(150, true);
    filter(3400, false);
  }
  return passed;
}

Sound
mixed(const Sound &sound, const Sound &other, double ratio)
{
  const double level = std::sqrt(power(sound) / power(other)) * gain(-ratio);
  Sound mix = sound;
  for (std::size_t i = 0; i < mix.size() && i < other.size(); i++)
    mix[i] += static_cast<float>(level * other[i]);
  return mix;
}

Sound
faster(const Sound &sound, double rate)
{
  constexpr int kReach = 16;
  Sound result(static_cast<std::size_t>(static_cast<double>(sound.size()) / rate));
  const double cutoff = std::min(1.0, 1 / rate) * 0.95;
  for (std::size_t i = 0; i < result.size(); i++) {
    const double at = static_cast<double>(i) * rate;
    const auto middle = static_cast<std::ptrdiff_t>(at);
    double sum = 0;
    for (std::ptrdiff_t j = middle - kReach + 1; j <= middle + kReach; j++) {
      if (j < 0 || j >= static_cast<std::ptrdiff_t>(sound.size()))
        continue;
      const double off = at - static_cast<double>(j);
      const double turn = std::numbers::pi * off * cutoff;
      const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * off / kReach);
      sum += sound[static_cast<std::size_t>(j)] * window * cutoff
             * (std::abs(turn) < 1e-9 ? 1 : std::sin(turn) / turn);
    }
    result[i] = static_cast<float>(sum);
  }
  return result;
}

} // namespace listen_bench
