// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Films known by their sound: how soon, how surely and how exactly, in rooms and noise, beside
// Chromaprint's fingerprints by a sliding match. Tables of docs/measured/listen.md.
//
// Usage: listen FOLDER [TITLES [QUERIES]]      FOLDER: sounds, see listen_sounds.h
#include "listen_sounds.h"

#include "listen/listener.h"
#include "random.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <unistd.h>

using namespace listen_bench;
using visuotactile::Random;

namespace {

constexpr double kFilm = 50;   ///< s
constexpr double kLength = 12; ///< s of each query
constexpr double kLead = 1;    ///< s before, of the room's reverberation
constexpr double kRight = 150; ///< ms
constexpr int kPeerTitles = 60;
constexpr std::size_t kBlock = 1600;
constexpr std::array kSpeeds = { 1.0, 1.0, 1.0, 25.0 / 24, 24.0 / 25 };

struct Condition
{
  double decay;
  bool telephone;
  const char *noise;
  double ratio; ///< dB
};

struct Query
{
  int film;
  double start; ///< s
  double speed;
  Sound sound;
};

struct Outcome
{
  double first = -1; ///< s until it was right; < 0: never
  bool wrong = false;
  std::vector<double> errors{}; ///< ms, of all that was right
};

double
thread_time()
{
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

/// On two threads.
template <typename Do>
void
for_each_of(int count, const Do &act)
{
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int i = next++; i < count; i = next++)
      act(i);
  };
  std::thread other(work);
  work();
  other.join();
}

Query
query(const Pool &pool, int titles, int number, const Condition &condition)
{
  Random random(static_cast<std::uint64_t>(number) * 31 + 7);
  Query made{ .film = random.below(titles),
              .start = random.uniform(2, kFilm - kLength * 1.05 - 2),
              .speed = kSpeeds[static_cast<std::size_t>(number) % kSpeeds.size()],
              .sound = {} };
  const Sound film = pool.film(made.film, kFilm);
  const auto at = [&](double seconds) {
    return film.begin() + static_cast<std::ptrdiff_t>(std::clamp(seconds, 0.0, kFilm) * kSoundRate);
  };
  Sound part(at(made.start - kLead * made.speed), at(made.start + kLength * made.speed));
  if (made.speed != 1)
    part = faster(part, made.speed);
  const auto seed = static_cast<std::uint64_t>(number);
  Sound heard = in_room(part, condition.decay, seed);
  if (condition.telephone)
    heard = by_telephone(heard);
  const double length = static_cast<double>(heard.size()) / kSoundRate;
  const std::string noise = condition.noise;
  heard = mixed(heard,
                noise == "pink noise" ? pink_noise(seed, length)
                : noise == "music"    ? pool.music(seed, length)
                                      : pool.speech(seed, length),
                condition.ratio);
  made.sound.assign(heard.begin() + static_cast<std::ptrdiff_t>(kLead * kSoundRate), heard.end());
  return made;
}

Outcome
heard(const listen::Catalogue &catalogue, const Query &query)
{
  Outcome outcome;
  listen::Listener listener(catalogue, kSoundRate);
  for (std::size_t at = 0; at + kBlock <= query.sound.size(); at += kBlock) {
    const auto found
        = listener.add(std::span(query.sound).subspan(at, kBlock),
                       listen::Time(std::llround(static_cast<double>(at) / kSoundRate * 1e9)));
    if (!found)
      continue;
    const double truth = query.start + static_cast<double>(found->at.count()) / 1e9 * query.speed;
    const double error = std::abs(static_cast<double>(found->position.count()) / 1e9 - truth) * 1e3;
    if (static_cast<int>(found->film) != query.film || error > kRight) {
      outcome.wrong = true;
      continue;
    }
    if (outcome.first < 0)
      outcome.first = static_cast<double>(at + kBlock) / kSoundRate;
    outcome.errors.push_back(error);
  }
  return outcome;
}

double
quantile(std::vector<double> values, double share)
{
  if (values.empty())
    return 0;
  const auto at = std::min(values.size() - 1,
                           static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

/// Chromaprint's numbers of a sound.
std::vector<std::uint32_t>
chromaprint(const Sound &sound, int thread)
{
  const std::string path
      = "/tmp/listen-bench-" + std::to_string(getpid()) + "-" + std::to_string(thread) + ".raw";
  std::ofstream file(path, std::ios::binary);
  for (const float sample : sound) {
    const auto word = static_cast<std::int16_t>(std::clamp(sample, -1.0F, 1.0F) * 32767);
    file.write(reinterpret_cast<const char *>(&word), 2);
  }
  file.close();
  const std::string command = "fpcalc -raw -plain -format s16le -rate 16000 -channels 1 -length 0 "
                              + path + " 2>/dev/null";
  std::vector<std::uint32_t> numbers;
  if (FILE *pipe = popen(command.c_str(), "r")) {
    unsigned number = 0;
    while (std::fscanf(pipe, "%u,", &number) == 1)
      numbers.push_back(number);
    pclose(pipe);
  }
  unlink(path.c_str());
  return numbers;
}

constexpr double kPeerStep = 4096.0 / 3 / 11025; ///< s, of Chromaprint's frames

/// The film, and its position, with the fewest different bits.
std::pair<int, double>
slide(const std::vector<std::vector<std::uint32_t>> &films, const std::vector<std::uint32_t> &heard)
{
  std::pair<int, double> best{ -1, 0 };
  int fewest = 1 << 30;
  for (std::size_t film = 0; film < films.size(); film++)
    for (std::size_t at = 0; at + heard.size() <= films[film].size() && !heard.empty(); at++) {
      int bits = 0;
      for (std::size_t i = 0; i < heard.size(); i++)
        bits += std::popcount(films[film][at + i] ^ heard[i]);
      if (bits < fewest) {
        fewest = bits;
        best = { static_cast<int>(film), static_cast<double>(at) * kPeerStep };
      }
    }
  return best;
}

void
conditions(const Pool &pool, const listen::Catalogue &catalogue, int titles, int queries)
{
  std::vector<std::vector<std::uint32_t>> peer(
      static_cast<std::size_t>(std::min(titles, kPeerTitles)));
  for_each_of(static_cast<int>(peer.size()), [&](int film) {
    peer[static_cast<std::size_t>(film)] = chromaprint(pool.film(film, kFilm), film);
  });
  std::printf(
      "| room | band | noise | right within 5 s | 10 s | seconds, median | wrong | error, "
      "median | p95 | Chromaprint, 5 s | 10 s |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  int all = 0;
  int all_wrong = 0;
  int number = 0;
  for (const double ratio : { 10.0, 0.0 })
    for (const char *noise : { "pink noise", "music", "speech" })
      for (const auto &[decay, telephone] :
           { std::pair(0.2, false), std::pair(0.4, true), std::pair(0.8, true) }) {
        const Condition condition{ decay, telephone, noise, ratio };
        std::vector<Outcome> outcomes(static_cast<std::size_t>(queries));
        for_each_of(queries, [&](int i) {
          outcomes[static_cast<std::size_t>(i)]
              = heard(catalogue, query(pool, titles, number + i, condition));
        });
        number += queries;
        int five = 0;
        int ten = 0;
        int wrong = 0;
        std::vector<double> errors;
        std::vector<double> firsts;
        for (const Outcome &one : outcomes) {
          five += one.first >= 0 && one.first <= 5.05 ? 1 : 0;
          ten += one.first >= 0 && one.first <= 10.05 ? 1 : 0;
          wrong += one.wrong ? 1 : 0;
          firsts.push_back(one.first < 0 ? kLength : one.first);
          errors.insert(errors.end(), one.errors.begin(), one.errors.end());
        }
        all += queries;
        all_wrong += wrong;
        std::array<std::atomic<int>, 2> of_peer{};
        const int peers = std::min(queries, 6);
        for_each_of(peers, [&](int i) {
          // It does not look for other speeds.
          const Query one = query(pool, static_cast<int>(peer.size()), 5 * i, condition);
          for (const std::size_t part : { 0U, 1U }) {
            const Sound cut(one.sound.begin(),
                            one.sound.begin() + (part == 0 ? 5 : 10) * kSoundRate);
            const auto [film, position] = slide(peer, chromaprint(cut, 1'000'000 + i));
            of_peer[part]
                += film == one.film && std::abs(position - one.start) * 1e3 <= kRight ? 1 : 0;
          }
        });
        std::printf("| %.1f s | %s | %s %+.0f dB | %.0f %% | %.0f %% | %.1f | %d of %d | %.2f ms | "
                    "%.2f ms | %.0f %% | %.0f %% |\n",
                    decay, telephone ? "150–3400 Hz" : "full", noise, ratio, 100.0 * five / queries,
                    100.0 * ten / queries, quantile(firsts, 0.5), wrong, queries,
                    quantile(errors, 0.5), quantile(errors, 0.95), 100.0 * of_peer[0] / peers,
                    100.0 * of_peer[1] / peers);
        std::fflush(stdout);
      }
  std::printf("\nWrong in all: %d of %d queries.\n", all_wrong, all);
}

void
not_in_catalogue(const Pool &pool, const listen::Catalogue &catalogue)
{
  constexpr int kMinutes = 20;
  std::printf("\n| sound that is in no entry | minutes | taken for a film | seconds "
              "|\n|---|---|---|---|\n");
  for (const char *kind : { "other films", "music", "speech" }) {
    std::atomic<int> times = 0;
    std::atomic<int> looks = 0;
    for_each_of(kMinutes, [&](int minute) {
      const auto seed = static_cast<std::uint64_t>(minute + 1000);
      const Sound sound = kind[0] == 'o'   ? pool.film(Pool::kOthers + minute, 60)
                          : kind[0] == 'm' ? pool.music(seed, 60)
                                           : pool.speech(seed, 60);
      listen::Listener listener(catalogue, kSoundRate);
      for (std::size_t at = 0; at + kBlock <= sound.size(); at += kBlock)
        if (const auto found = listener.add(
                std::span(sound).subspan(at, kBlock),
                listen::Time(std::llround(static_cast<double>(at) / kSoundRate * 1e9)))) {
          times += found->begins ? 1 : 0;
          looks++;
        }
    });
    std::printf("| %s | %d | %d times | %.1f |\n", kind, kMinutes, times.load(),
                looks.load() / 2.0);
    std::fflush(stdout);
  }
}

void
cpu(const Pool &pool, const listen::Catalogue &catalogue, int titles)
{
  const auto share = [&](const Sound &sound) {
    listen::Listener listener(catalogue, kSoundRate);
    const double begin = thread_time();
    for (std::size_t at = 0; at + kBlock <= sound.size(); at += kBlock)
      listener.add(std::span(sound).subspan(at, kBlock),
                   listen::Time(std::llround(static_cast<double>(at) / kSoundRate * 1e9)));
    return 100 * (thread_time() - begin) / (static_cast<double>(sound.size()) / kSoundRate);
  };
  std::printf(
      "\nCPU time, of a core: %.2f %% while it follows a film, %.2f %% while it searches %d "
      "titles.\n",
      share(pool.film(1, kFilm)), share(pool.music(5, kFilm)), titles);
}

/// A catalog of films of two hours each, with values as frequent as those of the titles.
void
sizes(const Pool &pool, const listen::Catalogue &catalogue)
{
  std::vector<std::uint32_t> values;
  for (const listen::Entry &film : catalogue.films())
    for (const listen::RankedHash &hash : film.hashes(listen::kRanks - 1))
      values.push_back(hash.value);
  listen::PeakFinder finder(listen::kHeardPeaks);
  std::vector<float> samples;
  listen::Downsampler(kSoundRate).add(pool.film(2, 10), samples);
  finder.add(samples);
  const auto hashes = listen::heard_hashes(finder.take(), 1);
  constexpr std::int64_t kSeconds = 7200;
  const auto frames = static_cast<std::int64_t>(kSeconds * listen::PeakFinder::kFrameRate);
  std::printf(
      "\n| titles of two hours | index | made in | a search of 10 s |\n|---|---|---|---|\n");
  for (const std::size_t count : { 10U, 100U, 1000U, 10'000U }) {
    const auto begin = std::chrono::steady_clock::now();
    const listen::HashIndex index(
        std::vector<std::int64_t>(count, frames),
        [&](std::size_t film, unsigned rank) {
          std::vector<listen::RankedHash> made;
          made.reserve(static_cast<std::size_t>(kSeconds * listen::kOfRank[rank]));
          std::uint64_t state = film * 1'000'003;
          for (std::int64_t second = 0; second < kSeconds; second++)
            for (int i = 0; i < listen::kOfRank[rank]; i++) {
              state = visuotactile::mix_bits(state);
              made.push_back({ .frame = second * 125 / 2 + static_cast<std::int64_t>(state % 62),
                               .value = values[(state >> 8U) % values.size()] });
            }
          return made;
        },
        listen::Catalogue::kMostBytes);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    double least = 1e9;
    for (int i = 0; i < 3; i++) {
      const double from = thread_time();
      (void)index.search(hashes, 24);
      least = std::min(least, thread_time() - from);
    }
    std::printf("| %zu | %.0f MB | %.1f s | %.0f ms |\n", count,
                static_cast<double>(index.bytes()) / 1e6, took.count(), least * 1e3);
    std::fflush(stdout);
  }
}

} // namespace

int
main(int argc, char **argv)
{
  if (argc < 2) {
    std::fprintf(stderr, "Usage: listen FOLDER [TITLES [QUERIES]]\n");
    return 2;
  }
  const Pool pool(argv[1]);
  const int titles = argc > 2 ? std::atoi(argv[2]) : 1000;
  const int queries = argc > 3 ? std::atoi(argv[3]) : 40;
  std::vector<std::string> entries(static_cast<std::size_t>(titles));
  std::atomic<double> learning = 0;
  for_each_of(titles, [&](int title) {
    const Sound sound = pool.film(title, kFilm);
    const double begin = thread_time();
    listen::FilmSoundMaker maker(kSoundRate);
    maker.add(sound);
    auto bytes = listen::write_entry(
        { .duration = listen::Time(std::llround(kFilm * 1e9)), .sound = maker.finish() });
    if (bytes)
      entries[static_cast<std::size_t>(title)] = *std::move(bytes);
    learning = learning + thread_time() - begin;
  });
  std::vector<listen::Entry> films;
  std::size_t bytes = 0;
  for (std::string &entry : entries) {
    bytes += entry.size();
    films.push_back(std::move(*listen::Entry::of(std::move(entry))));
  }
  const listen::Catalogue catalogue(std::move(films));
  std::printf(
      "%d titles of %.0f s, one in four synthetic; an entry of two hours has %.1f MB, and is "
      "made in %.0f s of CPU time without decoding.\n\n",
      titles, kFilm, static_cast<double>(bytes) / titles / kFilm * 7200 / 1e6,
      learning / titles / kFilm * 7200);
  conditions(pool, catalogue, titles, queries);
  not_in_catalogue(pool, catalogue);
  cpu(pool, catalogue, titles);
  sizes(pool, catalogue);
  return 0;
}
