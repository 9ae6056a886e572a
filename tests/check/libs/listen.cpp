// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Films known by their sound: the truth is where and how fast the test plays them.
#include "listen/correlation.h"
#include "listen/listener.h"
#include "random.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "support/unwrap.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using listen::Heard;
using listen::Time;
using visuotactile::Random;

namespace {

using Sound = std::vector<float>;

constexpr int kRate = 16000;
constexpr double kFilm = 40; ///< s

/// Tones and bursts of noise, at random; sample i is at i / `rate` · `speed` seconds of the film.
Sound
film(std::uint64_t seed, int rate = kRate, double speed = 1, double seconds = kFilm)
{
  Random random(seed);
  Sound sound(static_cast<std::size_t>(seconds / speed * rate));
  std::uint64_t burst = seed << 20U;
  for (double begin = 0; begin < seconds; begin += random.uniform(0.03, 0.3)) {
    const double hertz = random.uniform(200, 3000);
    const double length = random.uniform(0.05, 0.5);
    const double tone = random.uniform(0, 0.3);
    burst++;
    const auto first = static_cast<std::size_t>(std::ceil(begin / speed * rate));
    for (std::size_t i = first; i < sound.size(); i++) {
      const double time = static_cast<double>(i) / rate * speed - begin;
      if (time > length)
        break;
      // Noise in steps of 1/4000 s, the same whatever the rate.
      const auto step = static_cast<std::uint64_t>(time * 4000);
      const double noise
          = static_cast<double>(visuotactile::mix_bits(burst * 4096 + step) >> 11U) * 0x1p-53 - 0.5;
      sound[i] += static_cast<float>(
          (tone * std::sin(2 * std::numbers::pi * hertz * time) + (0.3 - tone) * noise)
          * (1 - time / length));
    }
  }
  return sound;
}

const std::string &
learned(std::uint64_t seed)
{
  static std::map<std::uint64_t, std::string> entries;
  if (const auto known = entries.find(seed); known != entries.end())
    return known->second;
  listen::FilmSoundMaker maker(kRate);
  maker.add(film(seed));
  return entries[seed] = unwrap(listen::write_entry({ .film = std::to_string(seed) + ".mkv",
                                                      .track_name = "a.csv",
                                                      .track = "track",
                                                      .duration = Time(40s),
                                                      .sound = maker.finish() }));
}

constexpr std::uint64_t kFilms = 3;

const listen::Catalogue &
catalogue()
{
  static const listen::Catalogue films = [] {
    std::vector<listen::Entry> entries;
    for (std::uint64_t seed = 1; seed <= kFilms; seed++)
      entries.push_back(unwrap(listen::Entry::of(learned(seed))));
    return listen::Catalogue(std::move(entries));
  }();
  return films;
}

/// Everything that is heard, in blocks of 20 ms.
std::vector<Heard>
hear(listen::Listener &listener, std::span<const float> sound, int rate, Time from = Time(0))
{
  std::vector<Heard> all;
  const auto block = static_cast<std::size_t>(rate / 50);
  for (std::size_t at = 0; at + block <= sound.size(); at += block)
    if (const auto heard
        = listener.add(sound.subspan(at, block),
                       from + Time(std::llround(static_cast<double>(at) / rate * 1e9))))
      all.push_back(*heard);
  return all;
}

/// Expects film 3, which was at `origin` seconds at the local time 0.
void
expect_film(const std::vector<Heard> &all, double origin, double speed, double most_ms)
{
  fail_if(all.empty(), "nothing was heard");
  fail_unless(all.front().begins);
  for (const Heard &heard : all) {
    const double truth = origin + static_cast<double>(heard.at.count()) / 1e9 * speed;
    const double error = (static_cast<double>(heard.position.count()) / 1e9 - truth) * 1e3;
    fail_unless(heard.film == 2 && std::abs(error) <= most_ms, "film %zu, %.3f ms off", heard.film,
                error);
  }
}

std::span<const float>
from(const Sound &sound, double seconds, int rate = kRate)
{
  return std::span(sound).subspan(static_cast<std::size_t>(seconds * rate));
}

} // namespace

/// A copy that comes later is found to a sample of kRate, where no noise is.
CHECK_TEST(test_delay)
{
  const Sound sound = film(7, listen::kRate, 1, 10);
  listen::Onsets of_film;
  of_film.add(sound);
  std::vector<std::uint8_t> reference;
  for (const listen::Onset &onset : of_film.take())
    reference.push_back(listen::signs(onset));
  for (const int delay : { 0, 32, 64, 7, 16, 1000 }) {
    listen::Onsets heard;
    heard.add(std::span(sound).subspan(static_cast<std::size_t>(8000 - delay)));
    std::vector<listen::Onset> onsets = heard.take();
    onsets.erase(onsets.begin(), onsets.begin() + 100); // of the cut
    onsets.resize(1000);
    const auto window = std::span(reference).subspan(250 + 100 - 60);
    const listen::Fit fit = listen::fit(listen::weighted(onsets), window, 1, 60, 60);
    const double samples = (60 - fit.step) * listen::Onsets::kHop;
    fail_unless(std::abs(samples - delay) < 1 && fit.score > 15, "%d samples: %.2f, score %.1f",
                delay, samples, fit.score);
  }
}

/// Faint sounds beside steady loud tones are peaks from the first half second on.
CHECK_TEST(test_first_peaks)
{
  constexpr int kPips = 10;
  Sound sound(2 * listen::kRate);
  for (std::size_t i = 0; i < sound.size(); i++) {
    const double time = static_cast<double>(i) / listen::kRate;
    for (int tone = 1; tone <= 6; tone++)
      sound[i] += static_cast<float>(0.1 * std::sin(2 * std::numbers::pi * 500 * tone * time));
  }
  const auto middle = [](int pip) {
    return 0.2 + 0.1 * pip;
  };
  const auto hertz = [](int pip) {
    return 500.0 * (1 + pip % 6) + 62.5;
  };
  for (int pip = 0; pip < kPips; pip++)
    for (int i = -240; i < 240; i++) // 60 ms
      sound[static_cast<std::size_t>(std::lround(middle(pip) * listen::kRate) + i)]
          += static_cast<float>(0.01 * (1 - std::abs(i) / 240.0)
                                * std::sin(2 * std::numbers::pi * hertz(pip) * i / listen::kRate));
  listen::PeakFinder finder(listen::kHeardPeaks);
  finder.add(sound);
  const std::vector<listen::Peak> peaks = finder.take();
  for (int pip = 0; pip < kPips; pip++) {
    const bool is_found = std::ranges::any_of(peaks, [&](const listen::Peak &peak) {
      const double time = static_cast<double>(peak.frame) / listen::PeakFinder::kFrameRate;
      return std::abs(time - middle(pip)) < 0.03
             && std::abs(peak.bin * listen::PeakFinder::kBinHz - hertz(pip)) < 16;
    });
    fail_unless(is_found, "the one at %.1f s", middle(pip));
  }
}

/// Of a steady noise, louder onsets have more weight than those within it.
CHECK_TEST(test_weights)
{
  std::vector<listen::Onset> onsets(90);
  for (std::size_t n = 0; n < onsets.size(); n++) {
    onsets[n].change.fill(n % 2 == 0 ? 0.5F : -0.5F);
    onsets[n].level.fill(n < 60 ? -8.0F : -2.0F);
  }
  const auto changes = listen::weighted(onsets);
  for (const std::size_t band : { std::size_t{ 0 }, listen::kBands - 1 }) {
    fail_unless(changes[10][band] > 0 && changes[11][band] == -changes[10][band]);
    fail_unless(changes[70][band] > 2 * changes[10][band]);
  }
  fail_unless(listen::weighted({}).empty());
}

CHECK_TEST(test_any_rate)
{
  for (const int rate : { 8000, 44100 }) {
    listen::Listener listener(catalogue(), rate);
    const Sound sound = film(3, rate);
    const auto all
        = hear(listener, from(sound, 12, rate).first(static_cast<std::size_t>(12 * rate)), rate);
    expect_film(all, 12, 1, 1);
    fail_unless(all.front().at <= 5s && all.front().rate == 1);
    fail_unless(all.size() > 12, "%zu looks in 12 s", all.size());
  }
}

/// A film of 24 frames a second at 25, as in Europe's television, and the other way round.
CHECK_TEST(test_television)
{
  for (const double speed : { 25.0 / 24, 24.0 / 25 }) {
    listen::Listener listener(catalogue(), kRate);
    const Sound sound = film(3, kRate, speed);
    const auto all = hear(listener, from(sound, 10).first(10 * kRate), kRate);
    expect_film(all, 10 * speed, speed, 2);
    fail_unless_equals_float(all.front().rate, speed);
  }
}

/// Clocks of sound cards differ.
CHECK_TEST(test_drift)
{
  for (const double speed : { 1.0002, 0.9998 }) {
    listen::Listener listener(catalogue(), kRate);
    const Sound sound = film(3, kRate, speed);
    expect_film(hear(listener, from(sound, 2), kRate), 2 * speed, speed, 2);
  }
}

CHECK_TEST(test_unknown)
{
  Random random(1);
  Sound noise(20 * kRate);
  for (float &sample : noise)
    sample = static_cast<float>(random.uniform(-0.5, 0.5));
  listen::Listener of_noise(catalogue(), kRate);
  fail_unless(hear(of_noise, noise, kRate).empty());
  listen::Listener of_silence(catalogue(), kRate);
  fail_unless(hear(of_silence, Sound(10 * kRate), kRate).empty());
  listen::Listener of_another(catalogue(), kRate);
  fail_unless(hear(of_another, film(kFilms + 1, kRate, 1, 20), kRate).empty());
  const listen::Catalogue none;
  listen::Listener of_nothing(none, kRate);
  fail_unless(hear(of_nothing, film(3), kRate).empty());
}

/// As loud as the film.
CHECK_TEST(test_noise)
{
  Random random(2);
  Sound sound = film(3);
  double power = 0;
  for (const float sample : sound)
    power += sample * sample;
  const double most = std::sqrt(3 * power / static_cast<double>(sound.size()));
  for (float &sample : sound)
    sample += static_cast<float>(random.uniform(-most, most));
  listen::Listener listener(catalogue(), kRate);
  const auto all = hear(listener, from(sound, 5).first(15 * kRate), kRate);
  expect_film(all, 5, 1, 3);
  fail_unless(all.front().at <= 10s);
}

/// After a seek nothing is told of where the film was, but for 1.5 s; then it is found again.
CHECK_TEST(test_seek)
{
  const Sound sound = film(3);
  Sound played(sound.begin() + 5 * kRate, sound.begin() + 17 * kRate);
  played.insert(played.end(), sound.begin() + 25 * kRate, sound.end());
  listen::Listener listener(catalogue(), kRate);
  const auto all = hear(listener, played, kRate);
  const auto again
      = std::find_if(all.begin() + 1, all.end(), [](const Heard &heard) { return heard.begins; });
  fail_if(again == all.end(), "it was not found again");
  expect_film({ all.begin(), again }, 5, 1, 1);
  expect_film({ again, all.end() }, 13, 1, 1);
  fail_unless((again - 1)->at <= 13500ms && again->at <= 18s,
              "known up to %.1f s, again from %.1f s on",
              std::chrono::duration<double>((again - 1)->at).count(),
              std::chrono::duration<double>(again->at).count());
}

/// A pause: the film stops, and goes on 10 s later.
CHECK_TEST(test_pause)
{
  const Sound sound = film(3);
  Sound played(sound.begin() + 5 * kRate, sound.begin() + 17 * kRate);
  played.resize(22 * kRate);
  played.insert(played.end(), sound.begin() + 17 * kRate, sound.end());
  listen::Listener listener(catalogue(), kRate);
  for (const Heard &heard : hear(listener, played, kRate)) {
    fail_if(heard.at > 13500ms && heard.at < 22s, "silence is heard as a film");
    const Time truth = heard.at + (heard.at < 15s ? Time(5s) : Time(-5s));
    fail_unless(std::chrono::abs(heard.position - truth) <= 1ms);
  }
  fail_unless(listener.knows());
}

/// Sound was lost: times no longer fit, and it starts anew.
CHECK_TEST(test_gap)
{
  const Sound sound = film(3);
  listen::Listener listener(catalogue(), kRate);
  expect_film(hear(listener, from(sound, 5).first(10 * kRate), kRate), 5, 1, 1);
  const auto all = hear(listener, from(sound, 15), kRate, 12s); // it stood for two seconds
  expect_film(all, 3, 1, 1);
}

/// Two films that are the same to the ear are not told apart; of a copy the user is told, and the
/// first one is found.
CHECK_TEST(test_alike)
{
  const Sound sound = film(3);
  Random random(4);
  Sound edition = sound;
  for (float &sample : edition)
    sample += static_cast<float>(random.uniform(-1e-3, 1e-3));
  listen::FilmSoundMaker maker(kRate);
  maker.add(edition);
  const std::string other
      = unwrap(listen::write_entry({ .film = "edition.mkv", .sound = maker.finish() }));
  const auto films = [](std::vector<std::string> entries) {
    std::vector<listen::Entry> all;
    for (std::string &entry : entries)
      all.push_back(unwrap(listen::Entry::of(std::move(entry))));
    return listen::Catalogue(std::move(all));
  };
  const std::span<const float> played = from(sound, 0).first(15 * kRate);
  const listen::Catalogue editions = films({ learned(3), other });
  fail_unless(editions.films().size() == 2 && editions.complaints().empty());
  listen::Listener of_editions(editions, kRate);
  fail_unless(hear(of_editions, played, kRate).empty());
  const listen::Catalogue copies = films({ learned(2), learned(1), learned(3), learned(3) });
  fail_unless(copies.films().size() == 3 && copies.complaints().size() == 1);
  listen::Listener of_copies(copies, kRate);
  expect_film(hear(of_copies, played, kRate), 0, 1, 1);
}

CHECK_TEST(test_entry)
{
  const std::string bytes = learned(1);
  const auto entry = unwrap(listen::Entry::of(bytes));
  fail_unless(entry.film() == "1.mkv" && entry.track_name() == "a.csv" && entry.track() == "track"
              && entry.duration() == 40s);
  const auto all = entry.hashes(listen::kRanks - 1);
  fail_unless(std::ranges::is_sorted(all, {}, &listen::RankedHash::frame));
  fail_unless(all.size() > 40 * 20 && all.size() <= 41 * 40, "%zu hashes", all.size());
  fail_unless(entry.hashes(0).size() <= 41 * 3);
  // Two hours in 4 MB.
  fail_unless(bytes.size() * 180 <= 4'000'000, "%zu bytes", bytes.size());
  // Outside of the film.
  const auto before = entry.reference(-10, 20);
  fail_unless(
      before && before->size() == 20
      && std::all_of(before->begin(), before->begin() + 10, [](int step) { return step == 0; }));
  fail_unless(entry.reference(1'000'000'000, 5)->size() == 5);
}

/// Whatever is torn or says what cannot be.
CHECK_TEST(test_hostile_entry)
{
  const std::string bytes = learned(1);
  for (std::size_t size = 0; size < bytes.size(); size += size < 100 ? 1 : 997)
    fail_if(listen::Entry::of(bytes.substr(0, size)).has_value(), "%zu bytes", size);
  fail_if(listen::Entry::of(bytes + "x").has_value());
  for (std::size_t at = 0; at < 36; at++) {
    std::string wrong = bytes;
    wrong[at] = '\xff';
    if (wrong != bytes && (at < 8 || at >= 16)) // but the duration
      fail_if(listen::Entry::of(wrong).has_value(), "byte %zu", at);
  }
  std::string path = bytes;
  path[40] = '/'; // in the film's name
  fail_if(listen::Entry::of(path).has_value());
  // A hash that lies after the film's end is none.
  listen::FilmSound sound{ .hashes
                           = { { .frame = 10, .value = 5 }, { .frame = 100'000, .value = 6 } },
                           .reference = std::vector<std::uint8_t>(250) };
  const auto entry = unwrap(listen::Entry::of(unwrap(listen::write_entry({ .sound = sound }))));
  fail_unless(entry.hashes(0).size() == 1 && entry.hashes(0)[0].frame == 10);
}

/// Votes are counted in stretches of the time line: the place is found wherever it is, also where
/// two stretches meet.
CHECK_TEST(test_stretches)
{
  constexpr std::int64_t kFrames = 62 * 1200;
  constexpr std::size_t kCrowd = 120;
  const std::vector<std::int64_t> films(kCrowd, kFrames);
  for (const std::size_t mine : { std::size_t{ 0 }, std::size_t{ 106 }, kCrowd - 1 })
    for (const std::int64_t at : { std::int64_t{ 0 }, std::int64_t{ 63'718 } }) {
      const listen::HashIndex index(
          films,
          [&](std::size_t film, unsigned) {
            Random random(film + 1);
            std::vector<listen::RankedHash> hashes;
            for (std::int64_t frame = 0; frame < kFrames; frame += 2)
              hashes.push_back(
                  { .frame = frame, .value = static_cast<std::uint32_t>(random.below(120'000)) });
            for (std::uint32_t i = 0; film == mine && i < 40; i++)
              hashes[static_cast<std::size_t>(at) / 2 + i].value = 100 + i;
            return hashes;
          },
          std::size_t{ 64 } << 20);
      std::vector<listen::Hash> heard;
      for (std::uint32_t i = 0; i < 40; i++)
        for (int times = 0; times < 20; times++)
          heard.push_back({ .frame = 2 * i + i % 2 * 2, .value = 100 + i });
      for (std::uint32_t value = 0; value < 60'000; value++)
        heard.insert(heard.end(), 2, { .frame = 0, .value = value });
      const auto found = index.search(heard, 3);
      fail_unless(!found.places.empty() && found.places[0].film == mine
                      && std::abs(found.places[0].frame - at) <= 2 && found.places[0].votes >= 800,
                  "film %zu, frame %ld", mine, static_cast<long>(at));
    }
}

/// A catalogue takes no more memory than it may.
CHECK_TEST(test_memory)
{
  constexpr std::size_t kMost = std::size_t{ 4 } << 20;
  const std::vector<std::int64_t> films(100, 62 * 600);
  const listen::HashIndex index(
      films,
      [](std::size_t film, unsigned rank) {
        Random random(film + 1);
        std::vector<listen::RankedHash> hashes;
        for (int i = 0; i < 600 * listen::kOfRank[rank]; i++)
          hashes.push_back(
              { .frame = random.below(62 * 600),
                .value = static_cast<std::uint32_t>(random.below(1 << listen::kHashBits)) });
        return hashes;
      },
      kMost);
  fail_unless(index.bytes() <= kMost && index.bytes() > kMost / 2, "%zu bytes", index.bytes());
}

CHECK_MAIN_TIMEOUT(listen, 0)
