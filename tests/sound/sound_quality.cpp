// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What is felt of sounds with ground truth, as tables in Markdown. The sounds' seeds are above
// 5000; those by which the scores of lib/sound/onset_weights.h were learned and chosen are below.
//
// Usage: sound_quality [--only=TABLE] SPEECH.wav ...     (16-bit mono, as espeak-ng writes it)
// TABLE: onsets, others, rumble, places, voices, rates, cost
#include "onsets.h"
#include "speech.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>
#include <numbers>
#include <string_view>

using namespace judged;
using sound::SoundSettings;
using sound::SyntheticSound;

namespace {

constexpr std::uint64_t kFirstSeed = 5001;
constexpr int kFilms = 6;
constexpr double kSeconds = 60;

/// Their mean, which is what a mono mix has.
std::vector<float>
mono_of(std::span<const float> stereo)
{
  std::vector<float> result(stereo.size() / 2);
  for (std::size_t i = 0; i < result.size(); i++)
    result[i] = (stereo[2 * i] + stereo[2 * i + 1]) / 2;
  return result;
}

/// Onsets of impacts in music, ours and aubio's.
void
onsets()
{
  const auto speakers = sound::usual_speakers(2);
  std::puts(
      "## Impacts in music\n\n"
      "Six minutes of impacts in music with bass, chords, melody and hi-hats, in stereo; onsets\n"
      "within 20 ms of the truth. The ratio is of an impact's first 100 ms to the music. Of each "
      "of\n"
      "aubio's methods the row has that of six thresholds, 0.1 to 4, which is best here. aubio\n"
      "looks for all onsets, those of notes, too: its precision says how much a chair would do\n"
      "with it that it should not.\n\n"
      "| ratio | detector | precision | recall | F1 |\n|---|---|---|---|---|");
  for (const double ratio : { 6.0, 0.0, -6.0 }) {
    Count ours;
    std::vector<Peer> others = ratio == 0 ? peers() : std::vector<Peer>();
    std::vector<Count> theirs(others.size());
    for (int film = 0; film < kFilms; film++) {
      const SyntheticSound made({ .seed = kFirstSeed + static_cast<std::uint64_t>(film),
                                  .seconds = kSeconds,
                                  .music = true,
                                  .impacts_db = SoundSettings().music_db + ratio });
      const std::vector<float> frames = rendered(made, kSeconds, judged::kRate, speakers);
      const std::vector<double> truth = impacts_of(made);
      ours.add(onsets_of(analyzed(frames, judged::kRate, speakers)), truth);
      const std::vector<float> mono = mono_of(frames);
      for (std::size_t i = 0; i < others.size(); i++)
        theirs[i].add(heard_by(others[i], mono, judged::kRate), truth);
    }
    const auto row = [&](const std::string &name, const Count &count) {
      std::printf("| %+.0f dB | %s | %.3f | %.3f | %.3f |\n", ratio, name.c_str(),
                  count.precision(), count.recall(), count.f1());
    };
    row("soundtactile", ours);
    std::map<std::string, std::size_t> best;
    for (std::size_t i = 0; i < others.size(); i++) {
      const auto [entry, is_new] = best.try_emplace(others[i].method, i);
      if (!is_new && theirs[i].f1() > theirs[entry->second].f1())
        entry->second = i;
    }
    for (const auto &[method, i] : best) {
      char threshold[32];
      std::snprintf(threshold, sizeof threshold, "%.1f", others[i].threshold);
      row("aubio " + method + ", " + threshold, theirs[i]);
    }
  }
}

/// Onsets of what else there is.
void
others()
{
  const auto speakers = sound::usual_speakers(2);
  Count explosions;
  Count impacts;
  Count music;
  for (int film = 0; film < kFilms; film++) {
    SoundSettings settings{ .seed = kFirstSeed + 100 + static_cast<std::uint64_t>(film) };
    const auto count = [&](Count &into) {
      const SyntheticSound made(settings);
      into.add(onsets_of(analyzed(rendered(made, kSeconds, judged::kRate, speakers), judged::kRate,
                                  speakers)),
               impacts_of(made));
    };
    count(impacts);
    settings.impacts = false;
    settings.explosions = true;
    count(explosions);
    settings.explosions = false;
    settings.music = true;
    count(music);
  }
  std::printf("\n## Other sounds\n\nSix minutes each.\n\n"
              "| sound | result |\n|---|---|\n"
              "| impacts in silence | F1 %.3f |\n| explosions in silence | F1 %.3f |\n"
              "| music alone | %.1f false onsets a minute |\n",
              impacts.f1(), explosions.f1(), music.found * 60.0 / (kFilms * kSeconds));
}

/// How much of some of the time is felt, and how strongly.
struct Felt
{
  int moments = 0;
  int on = 0;
  double level = 0;

  void add(const sound::Moment &moment)
  {
    moments++;
    on += moment.level > 0 ? 1 : 0;
    level += static_cast<double>(moment.level);
  }

  void print(const char *name) const
  {
    std::printf("| %s | %.1f %% | %.2f |\n", name, 100.0 * on / std::max(moments, 1),
                level / std::max(moments, 1));
  }
};

/// A four-stroke engine at 1600 turns a minute with four cylinders: two ignitions a turn, and what
/// each cylinder has of its own. At −15 dB of full scale.
std::vector<float>
engine(double seconds)
{
  constexpr double kCycle = 1600.0 / 60 / 2;
  constexpr int kPartials = 36;
  std::vector<float> frames(static_cast<std::size_t>(seconds * judged::kRate));
  double power = 0;
  for (std::size_t i = 0; i < frames.size(); i++) {
    const double turns = kCycle * static_cast<double>(i) / judged::kRate;
    double sum = 0;
    for (int n = 2; n <= kPartials; n++)
      sum += (n % 4 == 0 ? 1 : 0.4) / n
             * std::sin(2 * std::numbers::pi * (n * turns + 0.37 * n * n));
    frames[i] = static_cast<float>(sum);
    power += sum * sum;
  }
  const double factor
      = std::pow(10, -15.0 / 20) / std::sqrt(power / static_cast<double>(frames.size()));
  for (float &sample : frames)
    sample *= static_cast<float>(factor);
  return frames;
}

/// What goes on below 65 Hz.
void
rumble()
{
  std::puts(
      "\n## Rumble\n\n"
      "How much of the time something is felt, and the mean level in [0, 1]. Rumble counts from\n"
      "0.5 s after its begin until it has fallen by 20 dB, explosions from their begin. The\n"
      "engine has partials of 27 to 480 Hz and runs for 30 s. Six minutes of each other sound.\n\n"
      "| sound | felt | level |\n|---|---|---|");
  const auto made = [](const char *name, SoundSettings settings, int channels, bool in_events) {
    const auto speakers = sound::usual_speakers(channels);
    Felt felt;
    for (int film = 0; film < kFilms; film++) {
      settings.seed = kFirstSeed + 300 + static_cast<std::uint64_t>(film);
      settings.impacts = false;
      const SyntheticSound sound(settings);
      for (const sound::Moment &moment :
           analyzed(rendered(sound, kSeconds, judged::kRate, speakers), judged::kRate, speakers))
        if (!in_events || std::ranges::any_of(sound.events(), [&](const sound::SoundEvent &event) {
              const bool swells = event.kind == sound::SoundKind::rumble;
              return event.kind != sound::SoundKind::music
                     && moment.begin > event.begin + std::chrono::milliseconds(swells ? 500 : 0)
                     && moment.begin < event.end;
            }))
          felt.add(moment);
    }
    felt.print(name);
  };
  made("rumble", { .rumble = true }, 2, true);
  made("rumble, music 6 dB weaker", { .rumble = true, .music = true }, 2, true);
  made("explosions", { .explosions = true }, 2, true);
  made("explosions, music 6 dB weaker", { .explosions = true, .music = true, .music_db = -18 }, 2,
       true);
  made("music alone", { .music = true }, 2, false);
  const auto moments = analyzed(engine(30), judged::kRate, sound::usual_speakers(1));
  for (const int from : { 0, 5, 10, 15, 20, 25 }) {
    Felt felt;
    for (const sound::Moment &moment : moments)
      if (moment.begin >= std::chrono::seconds(from)
          && moment.begin < std::chrono::seconds(from + 5))
        felt.add(moment);
    char name[64];
    std::snprintf(name, sizeof name, "engine, %d to %d s", from, from + 5);
    felt.print(name);
  }
}

/// Columns and rows of impacts.
void
places()
{
  std::puts(
      "\n## Places\n\n"
      "Impacts from the left, the middle and the right, in 5.1 from front and rear, felt most in\n"
      "that column (row) of 3 × 3 cells during their first 60 ms. Counted are those found.\n\n"
      "| sound | channels | impacts | right column | right row |\n|---|---|---|---|---|");
  for (const bool music : { false, true })
    for (const int channels : { 2, 6, 8 }) {
      const auto speakers = sound::usual_speakers(channels);
      int found = 0;
      int columns = 0;
      int rows = 0;
      for (int film = 0; film < kFilms; film++) {
        const SyntheticSound made({ .seed = kFirstSeed + 200 + static_cast<std::uint64_t>(film),
                                    .seconds = kSeconds,
                                    .music = music });
        const auto moments
            = analyzed(rendered(made, kSeconds, judged::kRate, speakers), judged::kRate, speakers);
        for (const sound::SoundEvent &event : made.events())
          for (std::size_t i = 0; i < moments.size(); i++)
            if (event.kind == sound::SoundKind::impact && moments[i].onset
                && std::chrono::abs(moments[i].begin - event.begin)
                       <= std::chrono::milliseconds(20)) {
              tactile::TactileMap map(3, 3);
              for (std::size_t j = i; j < std::min(i + 12, moments.size()); j++)
                sound::raise(map, moments[j].place, channels > 2, moments[j].level);
              const auto most = std::ranges::max_element(map.levels) - map.levels.begin();
              found++;
              columns += most % 3 == std::lround(event.across) + 1 ? 1 : 0;
              rows += most / 3 == (event.behind > 0 ? 2 : 0) ? 1 : 0;
            }
      }
      std::printf("| %s | %s | %d | %.1f %% | ", music ? "in music, 0 dB" : "alone",
                  channels == 2   ? "stereo"
                  : channels == 6 ? "5.1"
                                  : "7.1",
                  found, 100.0 * columns / std::max(found, 1));
      if (channels > 2)
        std::printf("%.1f %% |\n", 100.0 * rows / std::max(found, 1));
      else
        std::puts("– |");
    }
}

/// How much of the time motors are on while somebody talks.
bool
voices(std::span<char *> names)
{
  std::puts(
      "\n## Voices alone\n\n"
      "Voices at −20 dB of full scale, in silence and in white noise at −60 dB: espeak-ng's, and\n"
      "flite's, which are made of recordings of people. kal has a rate of 8 kHz. The others are\n"
      "people, at the rate of the recording and at 8 kHz: Allison speaks Asterisk's announcements\n"
      "in English and in Spanish (es), ALSA is who names the speakers in its test. A man reads a\n"
      "book (LibriVox), men name cards and say commands (of pocketsphinx). es-co, fr-Armelle and\n"
      "it-Menardi are announcements of three women, recorded at 8 kHz.\n"
      "\n"
      "More than 1 % have recordings that are less clean, and one at 8 kHz. As their spectra "
      "tell,\n"
      "what is felt are steps at the beginning of messages (fr-Armelle), deep noise that lasts\n"
      "(it-Menardi), puffs of breath of an “f”, a knock, and a “t” at the very beginning (cards,\n"
      "commands). Of Allison-es-8kHz syllables are taken for impacts, none of them at 16 kHz.\n"
      "Without what is below 80 Hz, which sound editors usually take out of speech, all have at\n"
      "most 1 %, but for the knock.\n\n"
      "| voice | seconds | on in silence | on in noise |\n|---|---|---|---|");
  const auto speakers = sound::usual_speakers(1);
  double seconds = 0;
  std::array<double, 2> on{};
  for (const char *name : names) {
    Speech speech = read_speech(name);
    if (speech.samples.empty()) {
      std::fprintf(stderr, "%s: expected a WAV file with 16-bit samples\n", name);
      return false;
    }
    const char *slash = std::strrchr(name, '/');
    const std::string base = slash ? slash + 1 : name;
    const bool is_whole = base.find("-above-") == std::string::npos;
    std::array<double, 2> shares{};
    std::uint64_t state = 1;
    for (std::size_t noisy = 0; noisy < 2; noisy++) {
      if (noisy == 1)
        for (float &sample : speech.samples) {
          state = state * 6364136223846793005U + 1442695040888963407U;
          sample += (static_cast<float>(state >> 40U) / 8388608.0F - 1) * 0.00173F; // −60 dB
        }
      const auto moments = analyzed(speech.samples, speech.rate, speakers);
      const auto count = std::ranges::count_if(
          moments, [](const sound::Moment &moment) { return moment.level > 0; });
      if (is_whole)
        on[noisy] += static_cast<double>(count) * 0.005;
      shares[noisy] = static_cast<double>(count) / static_cast<double>(moments.size());
    }
    const double lasts = static_cast<double>(speech.samples.size()) / speech.rate;
    if (is_whole)
      seconds += lasts;
    std::printf("| %s | %.0f | %.2f %% | %.2f %% |\n", base.substr(0, base.size() - 4).c_str(),
                lasts, 100 * shares[0], 100 * shares[1]);
  }
  std::printf("| all unfiltered | %.0f | %.2f %% | %.2f %% |\n", seconds, 100 * on[0] / seconds,
              100 * on[1] / seconds);
  return true;
}

/// The same sound at other rates.
void
rates()
{
  std::puts("\n## Sample rates\n\n"
            "One minute of impacts in music at 0 dB, in stereo, against the same sound at 48 kHz: "
            "onsets\n"
            "that have one within 10 ms, and the mean difference of levels.\n\n"
            "| rate | onsets | in common | mean difference of levels |\n|---|---|---|---|");
  const auto speakers = sound::usual_speakers(2);
  const SyntheticSound made({ .seed = kFirstSeed, .seconds = kSeconds, .music = true });
  const auto expected
      = analyzed(rendered(made, kSeconds, judged::kRate, speakers), judged::kRate, speakers);
  const auto truth = onsets_of(expected);
  for (const int rate : { 8000, 11025, 16000, 22050, 32000, 44100, 48000, 96000, 192000 }) {
    const auto moments = analyzed(rendered(made, kSeconds, rate, speakers), rate, speakers);
    const auto found = onsets_of(moments);
    const auto common = std::ranges::count_if(found, [&](double at) {
      return std::ranges::any_of(truth,
                                 [&](double other) { return std::abs(at - other) < 0.0101; });
    });
    double difference = 0;
    const std::size_t count = std::min(moments.size(), expected.size());
    for (std::size_t i = 0; i < count; i++)
      difference += std::abs(static_cast<double>(moments[i].level - expected[i].level));
    std::printf("| %d Hz | %zu | %td of %zu | %.4f |\n", rate, found.size(), common, truth.size(),
                difference / static_cast<double>(count));
  }
}

/// Processor time of this thread, seconds.
double
processor_time()
{
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void
cost()
{
  std::puts(
      "\n## Cost\n\n"
      "The analysis without GStreamer, blocks of 1024 frames: the least of seven runs.\n\n"
      "| channels | rate | of one core | latency with 100 maps a second |\n|---|---|---|---|");
  for (const auto &[channels, rate] :
       { std::pair{ 1, 48000 }, { 2, 48000 }, { 6, 48000 }, { 8, 48000 }, { 2, 192000 } }) {
    const auto speakers = sound::usual_speakers(channels);
    const SyntheticSound made({ .seed = kFirstSeed, .seconds = 10, .music = true });
    const std::vector<float> frames = rendered(made, 10, rate, speakers);
    double least = 1e9;
    sound::SoundAnalyzer analyzer(rate, speakers);
    for (int run = 0; run < 7; run++) {
      analyzer.reset();
      const double begin = processor_time();
      const std::size_t block = 1024 * speakers.size();
      for (std::size_t at = 0; at < frames.size(); at += block)
        analyzer.add(std::span(frames).subspan(at, std::min(block, frames.size() - at)), {});
      least = std::min(least, processor_time() - begin);
    }
    std::printf("| %d | %d Hz | %.2f %% | %.1f ms |\n", channels, rate, 10 * least,
                10 + std::chrono::duration<double, std::milli>(analyzer.delay()).count());
  }
}

} // namespace

int
main(int argc, char **argv)
{
  constexpr std::string_view kOnly = "--only=";
  std::span<char *> names(argv + 1, static_cast<std::size_t>(argc - 1));
  std::string_view only;
  if (!names.empty() && std::string_view(names[0]).starts_with(kOnly)) {
    only = std::string_view(names[0]).substr(kOnly.size());
    names = names.subspan(1);
  }
  const auto is_wanted = [&](std::string_view table) {
    return only.empty() || only == table;
  };
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (is_wanted("onsets"))
    onsets();
  if (is_wanted("others"))
    others();
  if (is_wanted("rumble"))
    rumble();
  if (is_wanted("places"))
    places();
  const bool read = !is_wanted("voices") || voices(names);
  if (is_wanted("rates"))
    rates();
  if (is_wanted("cost"))
    cost();
  return read ? 0 : 1;
}
