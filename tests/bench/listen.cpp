// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Films known by their sound: how soon, how surely and how exactly, in rooms and noise, beside
// Chromaprint's fingerprints by a sliding match. Tables of docs/measured/listen.md.
//
// Usage: listen FOLDER [TITLES [QUERIES [MINUTES [SEED]]]]      FOLDER: see listen_sounds.h;
//          QUERIES: a row; MINUTES: of each sound that is in no entry; SEED: of other titles
//        listen --among FILMS FOLDER TITLES QUERIES      titles among so many films of two hours
//        listen --search FILE FILMS      a search in so many films of two hours; FILE: see sizes()
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
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

using namespace listen_bench;
using visuotactile::Random;

namespace {

constexpr double kFilm = 50;   ///< s
constexpr int kTitle = 7200;   ///< s of a title of sizes()
constexpr double kLength = 12; ///< s of each query
constexpr double kLead = 1;    ///< s before, of the room's reverberation
constexpr double kRight = 150; ///< ms
constexpr int kPeerTitles = 60;
constexpr int kPeerQueries = 10;
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

/// On all processors.
template <typename Do>
void
for_each_of(int count, const Do &act)
{
  std::atomic<int> next = 0;
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(std::thread::hardware_concurrency(), 1U); i++)
    threads.emplace_back([&] {
      for (int one = next++; one < count; one = next++)
        act(one);
    });
  for (std::thread &thread : threads)
    thread.join();
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

constexpr std::array kRatios = { 10.0, 0.0 };
constexpr std::array kNoises = { "pink noise", "music", "speech" };
constexpr std::array kRooms = { std::pair(0.2, false), std::pair(0.4, true), std::pair(0.8, true) };

/// Outcomes of some queries.
struct Sums
{
  int queries = 0;
  int five = 0; ///< right within 5 s
  int ten = 0;
  int wrong = 0;

  void add(const Outcome &one)
  {
    queries++;
    five += one.first >= 0 && one.first <= 5.05 ? 1 : 0;
    ten += one.first >= 0 && one.first <= 10.05 ? 1 : 0;
    wrong += one.wrong ? 1 : 0;
  }
  void add(const Sums &other)
  {
    queries += other.queries;
    five += other.five;
    ten += other.ten;
    wrong += other.wrong;
  }
};

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
  int number = 0;
  int wrong = 0;
  std::string sums;
  for (const double ratio : kRatios) {
    Sums all;
    for (const char *noise : kNoises)
      for (const auto &[decay, telephone] : kRooms) {
        const Condition condition{ decay, telephone, noise, ratio };
        std::vector<Outcome> outcomes(static_cast<std::size_t>(queries));
        for_each_of(queries, [&](int i) {
          outcomes[static_cast<std::size_t>(i)]
              = heard(catalogue, query(pool, titles, number + i, condition));
        });
        number += queries;
        Sums row;
        std::vector<double> errors;
        std::vector<double> firsts;
        for (const Outcome &one : outcomes) {
          row.add(one);
          firsts.push_back(one.first < 0 ? kLength : one.first);
          errors.insert(errors.end(), one.errors.begin(), one.errors.end());
        }
        all.add(row);
        std::array<std::atomic<int>, 2> of_peer{};
        const int peers = std::min(queries, kPeerQueries);
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
                    decay, telephone ? "150–3400 Hz" : "full", noise, ratio,
                    100.0 * row.five / queries, 100.0 * row.ten / queries, quantile(firsts, 0.5),
                    row.wrong, queries, quantile(errors, 0.5), quantile(errors, 0.95),
                    100.0 * of_peer[0] / peers, 100.0 * of_peer[1] / peers);
        std::fflush(stdout);
      }
    std::array<char, 200> sum{};
    std::snprintf(sum.data(), sum.size(),
                  "All %d queries at %+.0f dB: %.1f %% right within 5 s, "
                  "%.1f %% within 10 s.\n",
                  all.queries, ratio, 100.0 * all.five / all.queries,
                  100.0 * all.ten / all.queries);
    sums += sum.data();
    wrong += all.wrong;
  }
  std::printf("\n%sWrong in all: %d of %d queries.\n", sums.c_str(), wrong, number);
}

void
not_in_catalogue(const Pool &pool, const listen::Catalogue &catalogue, int minutes)
{
  std::printf("\n| sound that is in no entry | minutes | taken for a film | seconds "
              "|\n|---|---|---|---|\n");
  for (const char *kind : { "other films", "music", "speech" }) {
    std::atomic<int> times = 0;
    std::atomic<int> looks = 0;
    for_each_of(minutes, [&](int minute) {
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
    std::printf("| %s | %d | %d times | %.1f |\n", kind, minutes, times.load(), looks.load() / 2.0);
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

/// A second of hashes up to a rank, with any of these values.
void
add_hashes(std::vector<listen::RankedHash> &made, int second, unsigned rank,
           std::span<const std::uint32_t> values, std::uint64_t seed)
{
  const std::size_t first = made.size();
  std::uint64_t state = seed << 32U | static_cast<std::uint64_t>(second);
  unsigned of = 0;
  for (int i = 0; i < listen::kOfRank[rank]; i++) {
    state = visuotactile::mix_bits(state);
    if (i == listen::kOfRank[of])
      of++;
    made.push_back({ .frame = std::int64_t{ second } * 125 / 2 + static_cast<int>(state % 62),
                     .value = values[(state >> 8U) % values.size()],
                     .rank = of });
  }
  std::ranges::sort(made.begin() + static_cast<std::ptrdiff_t>(first), made.end(), {},
                    &listen::RankedHash::frame);
}

std::vector<std::uint32_t>
values_of(std::span<const listen::FilmSound> sounds)
{
  std::vector<std::uint32_t> values;
  for (const listen::FilmSound &sound : sounds)
    for (const listen::RankedHash &hash : sound.hashes)
      values.push_back(hash.value);
  return values;
}

void
write(std::ofstream &file, std::span<const std::uint32_t> numbers)
{
  const auto count = static_cast<std::uint32_t>(numbers.size());
  file.write(reinterpret_cast<const char *>(&count), 4);
  file.write(reinterpret_cast<const char *>(numbers.data()), 4 * std::ssize(numbers));
}

std::vector<std::uint32_t>
read_numbers(std::ifstream &file)
{
  std::uint32_t count = 0;
  file.read(reinterpret_cast<char *>(&count), 4);
  std::vector<std::uint32_t> numbers(count);
  file.read(reinterpret_cast<char *>(numbers.data()), 4 * std::ssize(numbers));
  return numbers;
}

/// Searches in films of two hours each, with values as frequent as those of the titles, in
/// processes of their own.
void
sizes(const Pool &pool, std::span<const std::uint32_t> values, const std::string &program)
{
  listen::PeakFinder finder(listen::kHeardPeaks);
  std::vector<float> samples;
  listen::Downsampler(kSoundRate).add(pool.film(2, 10), samples);
  finder.add(samples);
  std::vector<std::uint32_t> heard;
  for (const listen::Hash &hash : listen::heard_hashes(finder.take(), 1)) {
    heard.push_back(static_cast<std::uint32_t>(hash.frame));
    heard.push_back(hash.value);
  }
  const std::string path = "/tmp/listen-bench-" + std::to_string(getpid());
  std::ofstream file(path, std::ios::binary);
  write(file, values);
  write(file, heard);
  file.close();
  std::printf(
      "\n| titles of two hours | index | made in | a search of 10 s | votes | most memory of "
      "the process |\n|---|---|---|---|---|---|\n");
  for (const int count : { 10, 100, 1000, 10'000 }) {
    std::fflush(stdout);
    const std::string command = program + " --search " + path + ' ' + std::to_string(count);
    if (std::system(command.c_str()) != 0)
      std::fprintf(stderr, "listen: cannot search in %d films\n", count);
  }
  unlink(path.c_str());
}

/// The titles' sounds, and the CPU time that they took.
std::pair<std::vector<listen::FilmSound>, double>
learned(const Pool &pool, int titles)
{
  std::vector<listen::FilmSound> sounds(static_cast<std::size_t>(titles));
  std::atomic<double> took = 0;
  for_each_of(titles, [&](int title) {
    const Sound sound = pool.film(title, kFilm);
    const double begin = thread_time();
    listen::FilmSoundMaker maker(kSoundRate);
    maker.add(sound);
    sounds[static_cast<std::size_t>(title)] = maker.finish();
    took = took + thread_time() - begin;
  });
  return { std::move(sounds), took };
}

/// The titles among films of two hours with hashes as frequent as theirs, and with seconds of their
/// references.
void
among(const Pool &pool, const std::vector<listen::FilmSound> &sounds, int films, int queries)
{
  const auto titles = static_cast<int>(sounds.size());
  const std::vector<std::uint32_t> values = values_of(sounds);
  std::vector<listen::Entry> entries;
  const auto add = [&](const listen::FilmSound &sound) {
    entries.push_back(*listen::Entry::of(*listen::write_entry({ .sound = sound })));
  };
  for (const listen::FilmSound &sound : sounds)
    add(sound);
  for (int film = 0; film < films; film++) {
    Random random(static_cast<std::uint64_t>(film));
    listen::FilmSound sound;
    for (int second = 0; second < kTitle; second++) {
      add_hashes(sound.hashes, second, 3, values, static_cast<std::uint64_t>(film));
      const auto &of = sounds[static_cast<std::size_t>(random.below(titles))].reference;
      const auto from
          = of.begin() + listen::Onsets::kOnsetRate * random.below(static_cast<int>(kFilm) - 1);
      sound.reference.insert(sound.reference.end(), from, from + listen::Onsets::kOnsetRate);
    }
    add(sound);
  }
  const listen::Catalogue catalogue(std::move(entries));
  int number = 0;
  for (const double ratio : kRatios) {
    std::vector<Outcome> outcomes(kNoises.size() * kRooms.size()
                                  * static_cast<std::size_t>(queries));
    for_each_of(static_cast<int>(outcomes.size()), [&](int i) {
      const auto row = static_cast<std::size_t>(i / queries);
      const auto &[decay, telephone] = kRooms[row % kRooms.size()];
      outcomes[static_cast<std::size_t>(i)]
          = heard(catalogue, query(pool, titles, number + i,
                                   { decay, telephone, kNoises[row / kRooms.size()], ratio }));
    });
    Sums sums;
    for (const Outcome &one : outcomes)
      sums.add(one);
    number += sums.queries;
    std::printf(
        "%d titles among %d films of two hours, %+.0f dB: %.1f %% right within 5 s, %.1f %% "
        "within 10 s, %d of %d wrong.\n",
        titles, films, ratio, 100.0 * sums.five / sums.queries, 100.0 * sums.ten / sums.queries,
        sums.wrong, sums.queries);
    std::fflush(stdout);
  }
  cpu(pool, catalogue, titles + films);
}

void
search(const char *path, std::size_t films)
{
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint32_t> values = read_numbers(file);
  const std::vector<std::uint32_t> heard = read_numbers(file);
  std::vector<listen::Hash> hashes;
  for (std::size_t i = 0; i + 1 < heard.size(); i += 2)
    hashes.push_back({ .frame = heard[i], .value = heard[i + 1] });
  const auto frames = static_cast<std::int64_t>(kTitle * listen::PeakFinder::kFrameRate);
  const auto begin = std::chrono::steady_clock::now();
  const listen::HashIndex index(
      std::vector<std::int64_t>(films, frames),
      [&](std::size_t film, unsigned rank) {
        std::vector<listen::RankedHash> made;
        for (int second = 0; second < kTitle; second++)
          add_hashes(made, second, rank, values, film);
        return made;
      },
      listen::Catalogue::kMostBytes);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  double least = 1e9;
  std::size_t votes = 0;
  for (int i = 0; i < 3; i++) {
    const double from = thread_time();
    votes = index.search(hashes, 24).votes;
    least = std::min(least, thread_time() - from);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("| %zu | %.0f MB | %.1f s | %.0f ms | %.1f million | %.0f MB |\n", index.films(),
              static_cast<double>(index.bytes()) / 1e6, took.count(), least * 1e3,
              static_cast<double>(votes) / 1e6, static_cast<double>(usage.ru_maxrss) * 1024 / 1e6);
}

} // namespace

int
main(int argc, char **argv)
{
  if (argc < 2) {
    std::fprintf(stderr, "Usage: listen FOLDER [TITLES [QUERIES [MINUTES [SEED]]]]\n");
    return 2;
  }
  if (argc == 4 && std::string(argv[1]) == "--search") {
    search(argv[2], static_cast<std::size_t>(std::atoi(argv[3])));
    return 0;
  }
  if (argc == 6 && std::string(argv[1]) == "--among") {
    const int titles = std::atoi(argv[4]);
    const Pool pool(argv[3], titles, kFilm);
    among(pool, learned(pool, titles).first, std::atoi(argv[2]), std::atoi(argv[5]));
    return 0;
  }
  const int titles = argc > 2 ? std::atoi(argv[2]) : 1000;
  const int queries = argc > 3 ? std::atoi(argv[3]) : 40;
  const int minutes = argc > 4 ? std::atoi(argv[4]) : 20;
  const Pool pool(argv[1], titles, kFilm, argc > 5 ? std::strtoull(argv[5], nullptr, 10) : 0);
  auto [sounds, learning] = learned(pool, titles);
  const std::vector<std::uint32_t> values = values_of(sounds);
  std::vector<std::string> entries(sounds.size());
  for_each_of(titles, [&](int title) {
    const auto index = static_cast<std::size_t>(title);
    entries[index] = *listen::write_entry({ .duration = listen::Time(std::llround(kFilm * 1e9)),
                                            .sound = std::exchange(sounds[index], {}) });
  });
  std::size_t bytes = 0;
  std::vector<listen::Entry> films;
  for (std::string &entry : entries) {
    bytes += entry.size();
    films.push_back(*listen::Entry::of(std::move(entry)));
  }
  const listen::Catalogue catalogue(std::move(films));
  std::printf(
      "%d titles of %.0f s, one in four synthetic; an entry of two hours has %.1f MB, and is "
      "made in %.0f s of CPU time without decoding.\n\n",
      titles, kFilm, static_cast<double>(bytes) / titles / kFilm * kTitle / 1e6,
      learning / titles / kFilm * kTitle);
  conditions(pool, catalogue, titles, queries);
  not_in_catalogue(pool, catalogue, minutes);
  cpu(pool, catalogue, titles);
  sizes(pool, values, argv[0]);
  return 0;
}
