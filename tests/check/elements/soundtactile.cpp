// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/sound_meta.h"
#include "sound/synthetic_sound.h"

#include "support/check_tests.h"
#include <gst/audio/audio.h>
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace {

constexpr int kRate = 48000;
constexpr gsize kBlock = 480; ///< frames: 10 ms
constexpr GstClockTime kBlockTime = 10 * GST_MSECOND;
constexpr const gchar *kStereo = "audio/x-raw,format=F32LE,layout=interleaved,rate=48000,"
                                 "channels=2,channel-mask=(bitmask)3";

/// The element with a harness on each of its source pads.
class Sound
{
public:
  explicit Sound(const gchar *caps = kStereo)
      : element_(gst_element_factory_make("soundtactile", nullptr)),
        audio(gst_harness_new_with_element(element_, "sink", "src")),
        tactile(gst_harness_new_with_element(element_, nullptr, "tactile"))
  {
    if (caps != nullptr)
      gst_harness_set_src_caps_str(audio, caps);
  }

  ~Sound()
  {
    gst_harness_teardown(tactile);
    gst_harness_teardown(audio);
    gst_object_unref(element_);
  }

  Sound(const Sound &) = delete;
  Sound &operator=(const Sound &) = delete;

private:
  GstElement *element_;

public:
  GstHarness *audio;
  GstHarness *tactile;
};

/// One impact in the left, at `at`.
std::vector<float>
impact(const std::vector<sound::Speaker> &speakers, double seconds, double *at)
{
  for (std::uint64_t seed = 1;; seed++) {
    const sound::SyntheticSound made({ .seed = seed, .seconds = 3 });
    const sound::SoundEvent &event = made.events().front();
    if (event.across >= 0 || event.behind > 0)
      continue;
    *at = std::chrono::duration<double>(event.begin).count();
    std::vector<float> frames(static_cast<std::size_t>(seconds * kRate) * speakers.size());
    made.render(kRate, 0, speakers, frames);
    return frames;
  }
}

GstBuffer *
buffer(const float *samples, gsize count, GstClockTime pts)
{
  GstBuffer *result = gst_buffer_new_memdup(samples, count * sizeof(float));
  GST_BUFFER_PTS(result) = pts;
  GST_BUFFER_DURATION(result) = kBlockTime;
  return result;
}

GstBuffer *
silence(guint number)
{
  const std::vector<float> samples(2 * kBlock);
  return buffer(samples.data(), samples.size(), number * kBlockTime);
}

struct Map
{
  GstClockTime pts;
  GstClockTime duration;
  std::array<float, 9> levels;

  float most() const
  {
    return std::ranges::max(levels);
  }
};

std::vector<Map>
maps(GstHarness *harness)
{
  std::vector<Map> result;
  while (GstBuffer *taken = gst_harness_try_pull(harness)) {
    Map map{ GST_BUFFER_PTS(taken), GST_BUFFER_DURATION(taken), {} };
    gfloat *levels = nullptr;
    gsize count = 0;
    fail_unless(gst_tactile_map_buffer_get_levels(taken, 3, 3, &levels, &count));
    std::copy_n(levels, count, map.levels.begin());
    g_free(levels);
    gst_buffer_unref(taken);
    result.push_back(map);
  }
  return result;
}

/// Names of the events since the last call.
std::string
events(GstHarness *harness)
{
  std::string names;
  while (GstEvent *event = gst_harness_try_pull_event(harness)) {
    names += names.empty() ? "" : " ";
    names += GST_EVENT_TYPE_NAME(event);
    gst_event_unref(event);
  }
  return names;
}

#define ASSERT_EVENTS(harness, expected)                                                           \
  G_STMT_START                                                                                     \
  {                                                                                                \
    const std::string came = events(harness);                                                      \
    fail_unless_equals_string(came.c_str(), expected);                                             \
  }                                                                                                \
  G_STMT_END

} // namespace

// Each buffer comes out as the same memory; maps follow each other without gaps until the end.
CHECK_TEST(test_audio_and_maps)
{
  Sound sound;
  for (guint i = 0; i < 20; i++) {
    GstBuffer *in = silence(i);
    GstMemory *memory = gst_buffer_peek_memory(in, 0);
    fail_unless_equals_int(gst_harness_push(sound.audio, in), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(sound.audio);
    fail_unless(out == in && gst_buffer_peek_memory(out, 0) == memory);
    gst_buffer_unref(out);
  }
  // 20 ms and a bit are needed until a map is known.
  std::vector<Map> before = maps(sound.tactile);
  fail_unless_equals_int(before.size(), 18);
  fail_unless(gst_harness_push_event(sound.audio, gst_event_new_eos()));
  for (const Map &map : maps(sound.tactile))
    before.push_back(map);
  fail_unless_equals_int(before.size(), 20);
  for (guint i = 0; i < 20; i++) {
    fail_unless_equals_uint64(before[i].pts, i * kBlockTime);
    fail_unless_equals_uint64(before[i].duration, kBlockTime);
    fail_unless_equals_float(before[i].most(), 0);
  }
  ASSERT_EVENTS(sound.tactile, "stream-start caps segment eos");
  ASSERT_EVENTS(sound.audio, "stream-start caps segment eos");
}

// An impact in the left is felt in the left column, at its time, whatever the format.
CHECK_TEST(test_impact)
{
  const auto speakers = sound::usual_speakers(2);
  double at = 0;
  const std::vector<float> frames = impact(speakers, 3, &at);
  for (const char *format : { "F32LE", "S16LE", "S24LE", "F64BE", "U8" }) {
    Sound sound(nullptr);
    const std::string caps = std::string("audio/x-raw,layout=interleaved,rate=48000,channels=2,"
                                         "channel-mask=(bitmask)3,format=")
                             + format;
    gst_harness_set_src_caps_str(sound.audio, caps.c_str());
    GstAudioInfo info;
    GstCaps *parsed = gst_caps_from_string(caps.c_str());
    fail_unless(gst_audio_info_from_caps(&info, parsed));
    gst_caps_unref(parsed);
    std::vector<double> wide(frames.begin(), frames.end());
    if (info.finfo->unpack_format == GST_AUDIO_FORMAT_S32) {
      auto *whole = reinterpret_cast<gint32 *>(wide.data());
      for (std::size_t i = 0; i < frames.size(); i++)
        whole[i] = static_cast<gint32>(std::clamp(static_cast<double>(frames[i]), -0.999, 0.999)
                                       * 0x1p31);
    }
    GstBuffer *all = gst_buffer_new_allocate(
        nullptr, frames.size() / 2 * static_cast<gsize>(GST_AUDIO_INFO_BPF(&info)), nullptr);
    GstMapInfo memory;
    fail_unless(gst_buffer_map(all, &memory, GST_MAP_WRITE));
    info.finfo->pack_func(info.finfo, GST_AUDIO_PACK_FLAG_NONE, wide.data(), memory.data,
                          static_cast<gint>(frames.size()));
    gst_buffer_unmap(all, &memory);
    GST_BUFFER_PTS(all) = 5 * GST_SECOND;
    fail_unless_equals_int(gst_harness_push(sound.audio, all), GST_FLOW_OK);

    const std::vector<Map> felt = maps(sound.tactile);
    const auto onset = std::ranges::find_if(felt, [](const Map &map) { return map.most() > 0; });
    fail_unless(onset != felt.end());
    const double begin = static_cast<double>(onset->pts) / GST_SECOND - 5;
    fail_unless(begin > at - 0.025 && begin < at + 0.02);
    fail_unless(onset->levels[0] > 2 * onset->levels[1]);
    fail_unless(onset->levels[0] > 10 * onset->levels[2]);
    fail_unless_equals_float(onset->levels[0], onset->levels[6]);
  }
}

// Maps have the sound's own frequency, within half of a third of an octave.
CHECK_TEST(test_frequency)
{
  for (const double hz : { 32.0, 50.0 }) {
    // All of a channel for low frequency effects is felt.
    Sound sound("audio/x-raw,format=F32LE,layout=interleaved,rate=48000,channels=6,"
                "channel-mask=(bitmask)0x3f");
    std::vector<float> frames(static_cast<std::size_t>(kRate) * 12);
    for (std::size_t i = 3; i < frames.size(); i += 6) {
      const double seconds = static_cast<double>(i / 6) / kRate;
      frames[i] = static_cast<float>(0.15 * std::min(1.0, 10 * seconds)
                                     * std::sin(2 * std::numbers::pi * hz * seconds));
    }
    fail_unless_equals_int(gst_harness_push(sound.audio, buffer(frames.data(), frames.size(), 0)),
                           GST_FLOW_OK);
    guint felt = 0;
    while (GstBuffer *map = gst_harness_try_pull(sound.tactile)) {
      gfloat *levels = nullptr;
      gsize count = 0;
      fail_unless(gst_tactile_map_buffer_get_levels(map, 3, 3, &levels, &count));
      if (levels[0] > 0 && GST_BUFFER_PTS(map) > GST_SECOND / 2) {
        const auto got = static_cast<double>(gst_buffer_get_tactile_frequency(map));
        fail_unless(std::abs(std::log2(got / hz)) < 0.2, "%g Hz is felt at %g Hz", hz, got);
        felt++;
      }
      g_free(levels);
      gst_buffer_unref(map);
    }
    ck_assert_uint_gt(felt, 50);
  }
}

// Tactors take what is felt at once, and its end.
CHECK_TEST(test_marked_maps)
{
  double at = 0;
  const std::vector<float> frames = impact(sound::usual_speakers(2), 3, &at);
  Sound sound;
  fail_unless_equals_int(gst_harness_push(sound.audio, buffer(frames.data(), frames.size(), 0)),
                         GST_FLOW_OK);
  bool sounded = false;
  guint marked = 0;
  while (GstBuffer *map = gst_harness_try_pull(sound.tactile)) {
    gfloat *levels = nullptr;
    gsize count = 0;
    fail_unless(gst_tactile_map_buffer_get_levels(map, 3, 3, &levels, &count));
    const bool sounds = *std::max_element(levels, levels + count) > 0;
    ck_assert_int_eq(GST_BUFFER_FLAG_IS_SET(map, kSoundMap), sounds || sounded);
    marked += sounds || sounded;
    sounded = sounds;
    g_free(levels);
    gst_buffer_unref(map);
  }
  ck_assert_uint_ge(marked, 7); // an impact is felt for 60 ms at least
}

// In planes, too; the loudspeakers' places are those of the caps, here right before left.
CHECK_TEST(test_planes)
{
  const auto speakers = sound::usual_speakers(2);
  double at = 0;
  const std::vector<float> frames = impact(speakers, 3, &at);
  Sound sound("audio/x-raw,format=F32LE,layout=non-interleaved,rate=48000,channels=2,"
              "channel-mask=(bitmask)3");
  const gsize count = frames.size() / 2;
  std::vector<float> planes(frames.size());
  for (gsize i = 0; i < count; i++) {
    planes[i] = frames[2 * i + 1]; // swapped
    planes[count + i] = frames[2 * i];
  }
  GstBuffer *all = buffer(planes.data(), planes.size(), 0);
  GstAudioInfo info;
  GstCaps *caps = gst_pad_get_current_caps(sound.audio->srcpad);
  fail_unless(gst_audio_info_from_caps(&info, caps));
  gst_caps_unref(caps);
  gst_buffer_add_audio_meta(all, &info, count, nullptr);
  fail_unless_equals_int(gst_harness_push(sound.audio, all), GST_FLOW_OK);
  const std::vector<Map> felt = maps(sound.tactile);
  const auto onset = std::ranges::find_if(felt, [](const Map &map) { return map.most() > 0; });
  fail_unless(onset != felt.end());
  fail_unless(onset->levels[2] > 10 * onset->levels[0]);
}

// What comes before a flush is forgotten: no map of it, and the next begins at the new time.
CHECK_TEST(test_flush)
{
  Sound sound;
  for (guint i = 0; i < 10; i++)
    gst_harness_push(sound.audio, silence(i));
  maps(sound.tactile);
  fail_unless(gst_harness_push_event(sound.audio, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(sound.audio, gst_event_new_flush_stop(TRUE)));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  fail_unless(gst_harness_push_event(sound.audio, gst_event_new_segment(&segment)));
  for (guint i = 100; i < 105; i++)
    fail_unless_equals_int(gst_harness_push(sound.audio, silence(i)), GST_FLOW_OK);
  const std::vector<Map> after = maps(sound.tactile);
  fail_unless_equals_int(after.size(), 3);
  fail_unless_equals_uint64(after.front().pts, GST_SECOND);
}

// Sound that leaps is read anew; what came before is felt to its end. Rounded times are no leap.
CHECK_TEST(test_leap)
{
  Sound sound;
  for (guint i = 0; i < 10; i++)
    gst_harness_push(sound.audio, silence(i));
  GstBuffer *late = silence(10);
  GST_BUFFER_PTS(late) += GST_MSECOND;
  gst_harness_push(sound.audio, late);
  fail_unless_equals_int(maps(sound.tactile).size(), 9);
  for (guint i = 50; i < 53; i++)
    gst_harness_push(sound.audio, silence(i));
  const std::vector<Map> after = maps(sound.tactile);
  fail_unless_equals_int(after.size(), 3);
  fail_unless_equals_uint64(after[1].pts, 10 * kBlockTime);
  fail_unless_equals_uint64(after[2].pts, 50 * kBlockTime);
}

// A gap of the audio is one of the maps, after what came before it.
CHECK_TEST(test_gap)
{
  Sound sound;
  for (guint i = 0; i < 10; i++)
    gst_harness_push(sound.audio, silence(i));
  fail_unless(
      gst_harness_push_event(sound.audio, gst_event_new_gap(10 * kBlockTime, 5 * kBlockTime)));
  fail_unless_equals_int(maps(sound.tactile).size(), 10);
  ASSERT_EVENTS(sound.tactile, "stream-start caps segment gap");
}

// Backwards there is nothing to feel, and audio passes.
CHECK_TEST(test_backwards)
{
  Sound sound;
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = GST_SECOND;
  fail_unless(gst_harness_push_event(sound.audio, gst_event_new_segment(&segment)));
  fail_unless_equals_int(gst_harness_push(sound.audio, silence(9)), GST_FLOW_OK);
  fail_unless_equals_int(maps(sound.tactile).size(), 0);
  ASSERT_EVENTS(sound.tactile, "stream-start caps segment segment gap");
  fail_unless_equals_int(gst_harness_buffers_received(sound.audio), 1);
}

// A map's length and what the analysis waits for are the tactile pad's latency; audio has none.
CHECK_TEST(test_latency)
{
  Sound sound;
  gst_harness_set_upstream_latency(sound.audio, 30 * GST_MSECOND);
  const GstClockTime own = gst_harness_query_latency(sound.tactile) - 30 * GST_MSECOND;
  fail_unless(own > 20 * GST_MSECOND && own <= 25 * GST_MSECOND);
  fail_unless_equals_uint64(gst_harness_query_latency(sound.audio), 30 * GST_MSECOND);

  // It is no less than what it takes, with the smallest buffers.
  const std::vector<float> frame(2);
  for (gint64 count = 1; count < kRate; count++) {
    const auto pts = static_cast<GstClockTime>((count - 1) * GST_SECOND / kRate);
    gst_harness_push(sound.audio, buffer(frame.data(), 2, pts));
    if (gst_harness_buffers_received(sound.tactile) == 0)
      continue;
    const auto heard = static_cast<GstClockTime>(count * GST_SECOND / kRate);
    fail_unless(heard <= own && heard > own - GST_MSECOND);
    return;
  }
  fail("no map came");
}

// New caps are read from then on; caps that cannot be read pass, with gaps and a warning.
CHECK_TEST(test_caps)
{
  Sound sound;
  gst_harness_push(sound.audio, silence(0));
  gst_harness_set_src_caps_str(sound.audio,
                               "audio/x-raw,format=F32LE,layout=interleaved,rate=96000,channels=1");
  std::vector<float> mono(960);
  for (guint i = 1; i < 5; i++)
    gst_harness_push(sound.audio, buffer(mono.data(), mono.size(), i * kBlockTime));
  std::vector<Map> felt = maps(sound.tactile);
  fail_unless_equals_int(felt.size(), 3);
  fail_unless_equals_uint64(felt[1].pts, kBlockTime);

  GstBus *bus = gst_bus_new();
  gst_element_set_bus(sound.audio->element, bus);
  gst_harness_set_src_caps_str(sound.audio,
                               "audio/x-raw,format=F32LE,layout=interleaved,rate=48000,channels=9,"
                               "channel-mask=(bitmask)0");
  GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING);
  fail_unless(message != nullptr);
  gst_message_unref(message);
  gst_element_set_bus(sound.audio->element, nullptr);
  gst_object_unref(bus);
  maps(sound.tactile);
  events(sound.tactile);
  const std::vector<float> wide(9 * kBlock);
  fail_unless_equals_int(
      gst_harness_push(sound.audio, buffer(wide.data(), wide.size(), 5 * kBlockTime)), GST_FLOW_OK);
  fail_unless_equals_int(maps(sound.tactile).size(), 0);
  ASSERT_EVENTS(sound.tactile, "gap");
}

// Either branch may be left unlinked.
CHECK_TEST(test_unlinked)
{
  GstHarness *alone = gst_harness_new_with_padnames("soundtactile", "sink", "src");
  gst_harness_set_src_caps_str(alone, kStereo);
  for (guint i = 0; i < 5; i++)
    fail_unless_equals_int(gst_harness_push(alone, silence(i)), GST_FLOW_OK);
  gst_harness_teardown(alone);

  GstHarness *felt = gst_harness_new_with_padnames("soundtactile", "sink", "tactile");
  gst_harness_set_src_caps_str(felt, kStereo);
  for (guint i = 0; i < 5; i++)
    fail_unless_equals_int(gst_harness_push(felt, silence(i)), GST_FLOW_OK);
  fail_unless_equals_int(gst_harness_buffers_received(felt), 3);
  gst_harness_teardown(felt);
}

// A chair of another grid is followed while sound is felt.
CHECK_TEST(test_another_grid)
{
  Sound sound;
  for (guint i = 0; i < 30; i++) {
    if (i == 10)
      gst_harness_set_sink_caps_str(sound.tactile, "application/x-tactile-map,rows=2,columns=4");
    fail_unless_equals_int(gst_harness_push(sound.audio, silence(i)), GST_FLOW_OK);
  }
  fail_unless(gst_harness_push_event(sound.audio, gst_event_new_eos()));
  std::vector<gsize> grids;
  GstClockTime last = 0;
  while (GstBuffer *map = gst_harness_try_pull(sound.tactile)) {
    const gsize cells = gst_buffer_get_size(map) / sizeof(gfloat);
    if (grids.empty() || grids.back() != cells)
      grids.push_back(cells);
    fail_unless_equals_uint64(GST_BUFFER_PTS(map), last); // none is missing, none comes twice
    last += GST_BUFFER_DURATION(map);
    gst_buffer_unref(map);
  }
  fail_unless((grids == std::vector<gsize>{ 9, 8 }));
  fail_unless_equals_uint64(last, 30 * kBlockTime);
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(sound.tactile->sinkpad);
  guint rows = 0;
  guint columns = 0;
  fail_unless(gst_tactile_map_caps_parse(caps, &rows, &columns, nullptr, nullptr));
  ck_assert_uint_eq(rows, 2);
  ck_assert_uint_eq(columns, 4);
}

// Other rates of maps keep their grid, and their latency.
CHECK_TEST(test_maps_per_second)
{
  Sound sound(nullptr);
  gst_element_set_state(sound.audio->element, GST_STATE_NULL);
  gst_harness_set(sound.audio, "soundtactile", "maps-per-second", 60, nullptr);
  gst_element_set_state(sound.audio->element, GST_STATE_PLAYING);
  gst_harness_set_src_caps_str(sound.audio, kStereo);
  for (guint i = 0; i < 100; i++)
    gst_harness_push(sound.audio, silence(i));
  fail_unless(gst_harness_push_event(sound.audio, gst_event_new_eos()));
  const std::vector<Map> felt = maps(sound.tactile);
  fail_unless_equals_int(felt.size(), 60);
  for (guint i = 0; i < 60; i++)
    fail_unless_equals_uint64(felt[i].pts, gst_util_uint64_scale(i, GST_SECOND, 60));
  // The end of a map is up to one analysis, 5 ms, before what is read.
  fail_unless(gst_harness_query_latency(sound.tactile) <= 31 * GST_MSECOND);
}

// `blows` is the former name of `impacts`, and deprecated.
CHECK_TEST(test_former_name)
{
  GstElement *element = gst_element_factory_make("soundtactile", nullptr);
  const GParamSpec *former = g_object_class_find_property(G_OBJECT_GET_CLASS(element), "blows");
  fail_unless(former && (former->flags & G_PARAM_DEPRECATED));
  g_object_set(element, "blows", FALSE, nullptr);
  gboolean impacts = TRUE;
  g_object_get(element, "impacts", &impacts, nullptr);
  fail_if(impacts);
  g_object_set(element, "impacts", TRUE, nullptr);
  gboolean blows = FALSE;
  g_object_get(element, "blows", &blows, nullptr);
  fail_unless(blows);
  gst_object_unref(element);
}

CHECK_MAIN(soundtactile)
