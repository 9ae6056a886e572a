// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What is felt of real sounds, as tables in Markdown: by soundtactile, aubio's detectors and
// an envelope, in the same mixes (real_mixes.py).
//
// Usage: sound_real FOLDER
#include "onsets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

using namespace judged;

namespace {

constexpr int kMixRate = 16000;
constexpr double kWide = 0.05;

struct Film
{
  std::string name;
  std::vector<float> samples;
  std::vector<double> truth;
};

std::map<std::string, std::vector<Film>> films;

bool
read(const std::string &folder)
{
  std::ifstream index(folder + "/index");
  for (std::string line; std::getline(index, line);) {
    std::istringstream fields(line);
    std::string group;
    std::string name;
    std::getline(fields, group, '\t');
    std::getline(fields, name, '\t');
    std::ifstream file(folder + "/" + name, std::ios::binary);
    const std::vector<char> bytes{ std::istreambuf_iterator<char>(file), {} };
    Film film;
    std::getline(fields, film.name, '\t');
    const auto *samples = reinterpret_cast<const float *>(bytes.data());
    film.samples.assign(samples, samples + bytes.size() / sizeof(float));
    for (double at = 0; fields >> at;)
      film.truth.push_back(at);
    films[group].push_back(std::move(film));
  }
  return !films.empty();
}

/// Where the RMS of 10 ms is so many dB above the largest of the 100 ms before.
std::vector<double>
envelope(std::span<const float> samples, double rise_db)
{
  constexpr std::size_t kStep = kMixRate / 100;
  std::vector<double> levels;
  for (std::size_t at = 0; at + kStep <= samples.size(); at += kStep) {
    double power = 1e-8;
    for (const float sample : samples.subspan(at, kStep))
      power += static_cast<double>(sample * sample) / kStep;
    levels.push_back(10 * std::log10(power));
  }
  std::vector<double> result;
  for (std::size_t i = 10; i < levels.size(); i++)
    if (levels[i]
                - *std::max_element(levels.begin() + static_cast<std::ptrdiff_t>(i) - 10,
                                    levels.begin() + static_cast<std::ptrdiff_t>(i))
            > rise_db
        && (result.empty() || 0.01 * static_cast<double>(i) - result.back() > 0.1))
      result.push_back(0.01 * static_cast<double>(i));
  return result;
}

const std::vector<std::string> kMixes{ "silence", "music +6 dB", "music 0 dB", "music −6 dB",
                                       "speech 0 dB" };

/// Those that were best in a longer search.
const std::vector<Peer> kPeers{ { "complex", 1 },  { "complex", 2 }, { "specflux", 1 },
                                { "specflux", 2 }, { "hfc", 1 },     { "hfc", 2 } };

/// Effects are weaker by that, dB.
constexpr std::array kLess{ 0, 6, 12, 18, 24, 30, 36, 42, 48 };

const std::vector<std::string> kAlone{ "music alone", "speech alone" };

/// What is found in these films a minute.
template <typename Heard>
double
a_minute(const std::string &name, const Heard &heard)
{
  double found = 0;
  double minutes = 0;
  for (const Film &film : films[name]) {
    found += static_cast<double>(heard(film.samples).size());
    minutes += static_cast<double>(film.samples.size()) / kMixRate / 60;
  }
  return found / minutes;
}

/// F1 in each mix; what is false in music and in speech a minute.
template <typename Heard>
std::vector<double>
row(const Heard &heard)
{
  std::vector<double> result;
  for (const std::string &mix : kMixes) {
    Count count;
    for (const Film &film : films[mix])
      count.add(heard(film.samples), film.truth, kWide);
    result.push_back(count.f1());
  }
  for (const std::string &alone : kAlone)
    result.push_back(a_minute(alone, heard));
  return result;
}

void
print(const std::string &name, std::span<const double> values)
{
  std::printf("| %s |", name.c_str());
  for (std::size_t i = 0; i < kMixes.size() + kAlone.size(); i++)
    if (i < values.size())
      std::printf(i < kMixes.size() ? " %.2f |" : " %.1f |", values[i]);
    else
      std::printf(" – |");
  std::puts("");
}

/// The best of each column, over some settings.
template <typename Settings, typename Heard>
std::vector<double>
best(const Settings &settings, const Heard &heard)
{
  std::vector<double> result(kMixes.size(), 0);
  for (const auto &setting : settings) {
    const std::vector<double> values
        = row([&](std::span<const float> samples) { return heard(setting, samples); });
    for (std::size_t i = 0; i < result.size(); i++)
      result[i] = std::max(result[i], values[i]);
  }
  return result;
}

struct Felt
{
  double share = 0;
  bool begins = false; ///< near the truth
  double most = 0;
};

Felt
felt(const Film &film, bool rumble, bool looks_ahead = false)
{
  sound::FeelSettings settings;
  settings.rumble = rumble;
  const auto moments
      = analyzed(film.samples, kMixRate, sound::usual_speakers(1), settings, looks_ahead);
  Felt result;
  for (const sound::Moment &moment : moments) {
    const double at = std::chrono::duration<double>(moment.begin).count();
    result.share += moment.level > 0 ? 1.0 / static_cast<double>(moments.size()) : 0;
    result.most = std::max(result.most, static_cast<double>(moment.level));
    for (const double onset : film.truth)
      result.begins |= moment.onset && std::abs(at - onset) <= kWide;
  }
  return result;
}

} // namespace

int
main(int argc, char **argv)
{
  if (argc != 2 || !read(argv[1]))
    return 2;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::puts(
      "| detector | silence | music +6 dB | 0 dB | −6 dB | speech 0 dB | music alone, a minute "
      "| speech alone, a minute |\n|---|---|---|---|---|---|---|---|");
  const auto speakers = sound::usual_speakers(1);
  const auto heard = [&](float surer, bool looks_ahead) {
    return [&speakers, surer, looks_ahead](std::span<const float> samples) {
      return onsets_of(analyzed(samples, kMixRate, speakers, { .surer = surer }, looks_ahead));
    };
  };
  print("soundtactile", row(heard(0, false)));
  print("soundtactile that looks 100 ms ahead", row(heard(0, true)));
  // Not a setting of the element: how good it is where less is false.
  for (const bool looks_ahead : { false, true }) {
    float surer = 0.25F;
    while (a_minute(kAlone[0], heard(surer, looks_ahead)) > 2)
      surer += 0.25F;
    print(looks_ahead ? "the same, at most 2 a minute in music"
                      : "soundtactile, at most 2 a minute in music",
          row(heard(surer, looks_ahead)));
  }
  print("aubio, the best of 6 settings in each column",
        best(kPeers, [](const Peer &peer, std::span<const float> samples) {
          return heard_by(peer, samples, kMixRate, 512);
        }));
  print("envelope, the best of 6",
        best(std::vector{ 3.0, 4.5, 6.0, 9.0, 12.0, 15.0 },
             [](double rise, std::span<const float> samples) { return envelope(samples, rise); }));

  std::printf(
      "\nThe share of sounds of which anything is felt, and which begin to be felt within 50 ms, "
      "as impacts; the mean of the strongest levels. Each sound comes after silence.\n");
  std::string missed;
  for (const bool looks_ahead : { false, true }) {
    std::printf("\n| sound%s | n |", looks_ahead ? ", looking ahead" : "");
    for (const int less : kLess)
      std::printf(" −%d dB |", less);
    std::printf("\n|---|---|");
    for (std::size_t i = 0; i < std::size(kLess); i++)
      std::printf("---|");
    for (const char *kind : { "explosion", "impact", "gun", "footstep" }) {
      std::printf("\n| %s | %zu |", kind, films[kind].size());
      for (const int less : kLess) {
        const auto &some = films[less > 0 ? kind + (", −" + std::to_string(less)) + " dB" : kind];
        const auto n = static_cast<double>(some.size());
        double any = 0;
        double begins = 0;
        double most = 0;
        for (const Film &film : some) {
          const Felt one = felt(film, false, looks_ahead);
          any += one.most > 0 ? 1 : 0;
          begins += one.begins ? 1 : 0;
          most += one.most / n;
          if (less == 0 && !looks_ahead && one.most == 0)
            missed += (missed.empty() ? "" : ", ") + film.name;
        }
        std::printf(" %.0f %%, %.0f %%, %.2f |", 100 * any / n, 100 * begins / n, most);
      }
    }
    std::puts("");
  }
  std::printf("\nNothing is felt, at full level, of: %s.\n",
              missed.empty() ? "none" : missed.c_str());

  std::puts("\n| sound | n | some is felt | felt of the time | some is felt, with rumble | felt of "
            "the time |"
            "\n|---|---|---|---|---|---|");
  for (const char *kind :
       { "music alone", "speech alone", "narrator", "engine", "ambient", "explosion" }) {
    double any = 0;
    double share = 0;
    double any_with = 0;
    double with = 0;
    const std::vector<Film> &some = films[kind];
    const auto n = static_cast<double>(some.size());
    for (const Film &film : some) {
      const Felt impacts = felt(film, false);
      const Felt all = felt(film, true);
      share += impacts.share / n;
      with += all.share / n;
      any += impacts.most > 0 ? 1 : 0;
      any_with += all.most > 0 ? 1 : 0;
    }
    std::printf("| %s | %zu | %.0f %% | %.1f %% | %.0f %% | %.1f %% |\n", kind, some.size(),
                100 * any / n, 100 * share, 100 * any_with / n, 100 * with);
  }
  return 0;
}
