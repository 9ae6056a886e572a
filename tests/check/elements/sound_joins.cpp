// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Picture and sound of a film in playbin and playbin3: a ball that hits the ground with a blow is
// one cue. No test depends on the machine's speed: a map waits until the sound of its time has been
// heard.
#include "sound/synthetic_sound.h"
#include "tactile/synthetic_film.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/start_player.h"
#include "support/temporary_file.h"
#include "trace.h"

using tactor::IssuedCommand;
using tactor::Time;

namespace {

constexpr int kRate = 48000;
constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kLength = 8; ///< s

/// When a ball appears, and where: the cell of 3 x 3.
struct Hit
{
  double at; ///< s
  int cell;
};

std::vector<Hit>
hits()
{
  std::vector<Hit> result;
  const tactile::SyntheticFilm film({ .seed = 3, .balls = 1 });
  Time last{ -1 };
  for (int frame = 0; frame < kLength * 30; frame++)
    for (const tactile::Ball &ball :
         film.balls_at(Time(frame * GST_SECOND / 30), kWidth, kHeight)) {
      if (ball.onset == last)
        continue;
      last = ball.onset;
      result.push_back({ std::chrono::duration<double>(ball.onset).count(),
                         static_cast<int>(ball.y * 3 / kHeight) * 3
                             + static_cast<int>(ball.x * 3 / kWidth) });
    }
  return result;
}

/// The blow of a hit: 1.5 s of sound.
std::vector<float>
blow()
{
  const sound::SyntheticSound made({ .seed = 5, .seconds = 3, .panned = false });
  const auto begin = made.events().front().begin;
  std::vector<float> frames(static_cast<std::size_t>(kRate) * 3);
  const auto speakers = sound::usual_speakers(1);
  made.render(kRate, begin.count() * kRate / static_cast<std::int64_t>(GST_SECOND), speakers,
              std::span(frames).first(static_cast<std::size_t>(kRate / 2)));
  frames.resize(static_cast<std::size_t>(kRate / 2));
  return frames;
}

/// A film whose balls come with blows if it has `blows`.
void
make_film(const std::string &path, bool blows, double later)
{
  const TemporaryFile raw("", ".raw");
  std::vector<gint16> samples(static_cast<std::size_t>(kLength * kRate) * 2);
  const std::vector<float> one = blow();
  for (const Hit &hit : hits())
    for (std::size_t i = 0; blows && i < one.size(); i++) {
      const std::size_t at = (static_cast<std::size_t>((hit.at + later) * kRate) + i) * 2;
      if (at + 1 < samples.size())
        samples[at] = samples[at + 1] = static_cast<gint16>(std::lround(
            std::clamp(static_cast<double>(one[i]), -1.0, 1.0) * 32767 / std::sqrt(2.0)));
    }
  std::ofstream(raw.path, std::ios::binary)
      .write(reinterpret_cast<const char *>(samples.data()),
             static_cast<std::streamsize>(samples.size() * sizeof(gint16)));
  play_to_the_end(make_pipeline(
      "tactiletestsrc pattern=static-motion seed=3 balls=1 num-buffers="
      + std::to_string(static_cast<int>(kLength * 30))
      + " ! video/x-raw,format=I420,width=320,height=240,framerate=30/1 ! jpegenc ! matroskamux "
        "name=mux ! filesink location="
      + path + " filesrc location=" + raw.path
      + " ! rawaudioparse pcm-format=s16le sample-rate=48000 num-channels=2 ! mux."));
}

} // namespace
GST_START_TEST(test_print)
{
  const TemporaryFile film("", ".mkv");
  make_film(film.path, true, 0.02);
  for (const Hit &hit : hits())
    g_print("hit %.3f cell %d\n", hit.at, hit.cell);
  GstElement *p = gst_element_factory_make("playbin", nullptr);
  const TemporaryFile trace("", ".csv");
  g_autofree gchar *uri = gst_filename_to_uri(film.path.c_str(), nullptr);
  GstElement *chair = gst_element_factory_make("visuotactilesink", nullptr);
  GstElement *screen = gst_element_factory_make("fakesink", nullptr);
  GstElement *speakers = gst_element_factory_make("fakesink", nullptr);
  g_object_set(screen, "sync", TRUE, nullptr);
  g_object_set(speakers, "sync", TRUE, nullptr);
  g_object_set(chair, "driver", "simulator", "trace-location", trace.path.c_str(), "video-sink", screen, nullptr);
  gst_util_set_object_arg(G_OBJECT(chair), "sound", g_getenv("SOUND") ? g_getenv("SOUND") : "film");
  g_object_set(p, "uri", uri, "video-sink", chair, "audio-sink", speakers, nullptr);
  if (!g_getenv("NOFILTER"))
    g_object_set(p, "audio-filter", gst_element_factory_make("soundtactile", nullptr), nullptr);
  start_player(p, GST_STATE_PLAYING);
  wait_for_eos(p);
  gst_element_set_state(p, GST_STATE_NULL);
  for (const IssuedCommand &l : unwrap(tactor::read_command_trace(trace.path)))
    g_print("%.3f tactor %d %.2f V lead %.3f\n", l.command.effect.count() / 1e9, l.command.tactor, l.command.volts, l.command.lead.count() / 1e9);
}
GST_END_TEST;

static Suite *
sound_joins_suite(void)
{
  Suite *suite = suite_create("sound_joins");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_test(cases, test_print);
  return suite;
}

GST_CHECK_MAIN(sound_joins);
