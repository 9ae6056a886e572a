// SPDX-License-Identifier: LGPL-2.1-or-later
#include "refused.h"

#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "support/check_tests.h"

namespace {

constexpr std::array<gfloat, 6> kLevels{ 0.0F, 0.25F, 0.5F, 0.75F, 1.0F, 0.125F };

GstTactileMeta *
add(GstBuffer *buffer)
{
  return gst_buffer_add_tactile_meta(buffer, 2, 3, kLevels.data(), kLevels.size());
}

void
assert_levels(GstBuffer *buffer)
{
  GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  fail_unless(meta != nullptr);
  fail_unless_equals_int(meta->rows, 2);
  fail_unless_equals_int(meta->columns, 3);
  gsize n = 0;
  const gfloat *levels = gst_tactile_meta_get_levels(meta, &n);
  fail_unless_equals_int(n, kLevels.size());
  for (gsize i = 0; i < n; i++) {
    fail_unless_equals_float(levels[i], kLevels[i]);
    fail_unless_equals_float(gst_tactile_meta_get_level(meta, i / 3, i % 3), kLevels[i]);
  }
}

guint
count_metas(GstBuffer *buffer)
{
  return gst_buffer_get_n_meta(buffer, GST_TACTILE_META_API_TYPE);
}

} // namespace

CHECK_TEST(test_add_and_get)
{
  GstBuffer *buffer = gst_buffer_new();
  fail_unless(gst_buffer_get_tactile_meta(buffer) == nullptr);
  GstTactileMeta *meta = add(buffer);
  fail_unless(meta == gst_buffer_get_tactile_meta(buffer));
  fail_unless(meta->levels != kLevels.data());
  assert_levels(buffer);

  for (const GType api : { GST_TACTILE_META_API_TYPE, GST_SALIENCY_META_API_TYPE }) {
    const gchar *const *tags = gst_meta_api_type_get_tags(api);
    fail_unless_equals_string(tags[0], GST_META_TAG_VIDEO_STR);
    fail_unless_equals_string(tags[1], GST_META_TAG_VIDEO_SIZE_STR);
    fail_unless_equals_string(tags[2], GST_META_TAG_VIDEO_ORIENTATION_STR);
    fail_unless(tags[3] == nullptr);
  }
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_levels_are_clamped)
{
  constexpr gfloat inf = std::numeric_limits<gfloat>::infinity();
  const std::array<gfloat, 6> wild{ -0.5F, 1.5F, std::nanf(""), inf, -inf, 0.5F };
  const std::array<gfloat, 6> tame{ 0, 1, 0, 1, 0, 0.5F };
  GstBuffer *buffer = gst_buffer_new();
  GstTactileMeta *meta = gst_buffer_add_tactile_meta(buffer, 1, 6, wild.data(), wild.size());
  for (guint i = 0; i < tame.size(); i++)
    fail_unless_equals_float(gst_tactile_meta_get_level(meta, 0, i), tame[i]);
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_limits)
{
  const std::vector<gfloat> many(65 * 65, 0.5F);
  GstBuffer *buffer = gst_buffer_new();
  fail_unless(gst_buffer_add_tactile_meta(buffer, 64, 64, many.data(), 64 * 64) != nullptr);
  fail_unless(gst_buffer_add_tactile_meta(buffer, 1, 1, many.data(), 1) != nullptr);
  gst_buffer_unref(buffer);

  buffer = gst_buffer_new();
  ASSERT_REFUSED(gst_buffer_add_tactile_meta(buffer, 0, 3, many.data(), 0));
  ASSERT_REFUSED(gst_buffer_add_tactile_meta(buffer, 3, 0, many.data(), 0));
  ASSERT_REFUSED(gst_buffer_add_tactile_meta(buffer, 65, 1, many.data(), 65));
  ASSERT_REFUSED(gst_buffer_add_tactile_meta(buffer, 1, 65, many.data(), 65));
  ASSERT_REFUSED(gst_buffer_add_tactile_meta(buffer, 3, 3, many.data(), 8));
  ASSERT_REFUSED(gst_buffer_add_tactile_meta(buffer, 3, 3, many.data(), 10));
  ASSERT_REFUSED(gst_buffer_add_tactile_meta(buffer, 3, 3, nullptr, 9));
  fail_unless_equals_int(count_metas(buffer), 0);

  gst_buffer_ref(buffer); // no longer writable
  ASSERT_REFUSED(add(buffer));
  gst_buffer_unref(buffer);
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_out_of_the_grid)
{
  GstBuffer *buffer = gst_buffer_new();
  GstTactileMeta *meta = add(buffer);
  for (const auto &[row, column] : { std::pair{ 2U, 0U }, std::pair{ 0U, 3U } }) {
    g_test_expect_message("visuotactile", G_LOG_LEVEL_CRITICAL, "*assertion*failed*");
    fail_unless_equals_float(gst_tactile_meta_get_level(meta, row, column), 0);
    g_test_assert_expected_messages();
  }
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_one_per_buffer)
{
  const std::array<gfloat, 2> other{ 1, 0 };
  GstBuffer *buffer = gst_buffer_new();
  gst_buffer_add_tactile_meta(buffer, 1, 2, other.data(), other.size());
  add(buffer);
  fail_unless_equals_int(count_metas(buffer), 1);
  assert_levels(buffer);

  // A meta's own levels may be passed back to it.
  GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  gst_buffer_add_tactile_meta(buffer, 2, 3, meta->levels, 6);
  assert_levels(buffer);
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_copies)
{
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, 100, nullptr);
  add(buffer);
  GstBuffer *whole = gst_buffer_copy(buffer);
  GstBuffer *deep = gst_buffer_copy_deep(buffer);
  GstBuffer *region = gst_buffer_copy_region(buffer, GST_BUFFER_COPY_ALL, 10, 20);
  GstBuffer *bare = gst_buffer_copy_region(buffer, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);

  gst_buffer_get_tactile_meta(buffer)->levels[1] = 1; // copies have their own levels
  gst_buffer_unref(buffer);
  assert_levels(whole);
  assert_levels(deep);
  assert_levels(region);
  fail_unless_equals_int(count_metas(bare), 0);
  for (GstBuffer *copy : { whole, deep, region, bare })
    gst_buffer_unref(copy);
}

#if GST_CHECK_VERSION(1, 24, 0)
CHECK_TEST(test_serialized)
{
  GstBuffer *frame = gst_buffer_new();
  constexpr std::array<gfloat, 6> kLevels{ 0, 0.1F, 0.2F, 0.5F, 0.75F, 1 };
  GstTactileMeta *meta = gst_buffer_add_tactile_meta(frame, 2, 3, kLevels.data(), kLevels.size());
  gst_tactile_meta_set_video_direction(meta, GST_VIDEO_ORIENTATION_90R);
  gst_buffer_set_tactile_frequency(frame, 120);
  g_autoptr(GByteArray) bytes = g_byte_array_new();
  fail_unless(gst_meta_serialize_simple(GST_META_CAST(meta), bytes));
  GstBuffer *other = gst_buffer_new();
  guint32 used = 0;
  meta = reinterpret_cast<GstTactileMeta *>(
      gst_meta_deserialize(other, bytes->data, bytes->len, &used));
  fail_unless(meta != nullptr && used == bytes->len && meta->rows == 2 && meta->columns == 3);
  fail_unless(std::equal(kLevels.begin(), kLevels.end(), meta->levels));
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(other), 120);
  // The direction, too: the same bytes again.
  g_autoptr(GByteArray) again = g_byte_array_new();
  fail_unless(gst_meta_serialize_simple(GST_META_CAST(meta), again));
  fail_unless(again->len == bytes->len && memcmp(again->data, bytes->data, bytes->len) == 0);
  // A frequency that a map cannot have: NaN, infinite, 1001 Hz, -1 Hz.
  for (const guint32 bits : { 0x7fc00000U, 0x7f800000U, 0x447a4000U, 0xbf800000U }) {
    GST_WRITE_UINT32_LE(again->data + bytes->len - 28, bits);
    fail_unless(gst_meta_deserialize(other, again->data, again->len, &used) != nullptr);
    fail_unless_equals_float(gst_buffer_get_tactile_frequency(other), 0);
  }
  memcpy(again->data, bytes->data, bytes->len);
  // Hostile bytes: the last 40 are rows, columns, direction, frequency and levels.
  for (guint at = bytes->len - 40; at < bytes->len - 28; at++) {
    again->data[at] = 0xff;
    fail_unless(gst_meta_deserialize(other, again->data, again->len, &used) == nullptr, "%u", at);
    again->data[at] = bytes->data[at];
  }
  gst_buffer_unref(other);
  gst_buffer_unref(frame);
}
#endif

/// A meta that has no map yet is in no copy.
CHECK_TEST(test_no_map)
{
  GstBuffer *frame = gst_buffer_new();
  const auto *meta = reinterpret_cast<GstTactileMeta *>(
      gst_buffer_add_meta(frame, GST_TACTILE_META_INFO, nullptr));
  fail_unless(meta->levels == nullptr && meta->rows == 0 && meta->columns == 0);
  GstBuffer *copy = gst_buffer_copy(frame);
  fail_unless_equals_int(count_metas(copy), 0);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(copy), 0);
#if GST_CHECK_VERSION(1, 24, 0)
  g_autoptr(GByteArray) bytes = g_byte_array_new();
  fail_if(gst_meta_serialize_simple(&meta->meta, bytes));
#endif
  gst_buffer_unref(copy);
  gst_buffer_unref(frame);
}

CHECK_TEST(test_frequency)
{
  GstBuffer *frame = gst_buffer_new();
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(frame), 0);
  gst_buffer_set_tactile_frequency(frame, 120);
  gst_buffer_set_tactile_frequency(frame, 121);
  GstBuffer *copy = gst_buffer_copy(frame);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(copy), 121);
  gst_buffer_set_tactile_frequency(frame, 0);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(frame), 0);
  gst_buffer_unref(copy);
  // A map that replaces another one has a frequency of its own.
  add(frame);
  gst_buffer_set_tactile_frequency(frame, 120);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(frame), 120);
  copy = gst_buffer_copy(frame);
  add(frame);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(frame), 0);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(copy), 120);
  gst_buffer_unref(copy);
  gst_buffer_unref(frame);
}

CHECK_TEST(test_transforms)
{
  GstBuffer *source = gst_buffer_new();
  GstMeta *meta = &add(source)->meta;
  gst_buffer_set_tactile_frequency(source, 120);
  GstVideoInfo in;
  GstVideoInfo out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_I420, 64, 48);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_I420, 32, 24);
  GstVideoMetaTransform scale{ &in, &out };

  GstBuffer *scaled = gst_buffer_new();
  fail_unless(meta->info->transform_func(scaled, meta, source,
                                         gst_video_meta_transform_scale_get_quark(), &scale));
  assert_levels(scaled);
  fail_unless_equals_float(gst_buffer_get_tactile_frequency(scaled), 120);
  gst_buffer_unref(scaled);

  GstBuffer *other = gst_buffer_new();
  fail_if(meta->info->transform_func(other, meta, source,
                                     g_quark_from_static_string("rotated-by-someone"), nullptr));
  fail_unless_equals_int(count_metas(other), 0);
  gst_buffer_unref(other);
  gst_buffer_unref(source);
}

/// As GStreamer 1.28 has it.
struct Matrix
{
  GstVideoInfo *in_info;
  GstVideoRectangle in;
  GstVideoInfo *out_info;
  GstVideoRectangle out;
  gfloat matrix[3][3];
};

/// Calls the meta's transform by a matrix. FALSE: the map is dropped.
static gboolean
move(GstBuffer *from, GstBuffer *to, const Matrix &matrix)
{
  GstMeta *meta = &gst_buffer_get_tactile_meta(from)->meta;
  Matrix data = matrix;
  return meta->info->transform_func(to, meta, from, g_quark_from_static_string("gst-video-matrix"),
                                    &data);
}

static std::vector<gfloat>
levels_of(GstBuffer *buffer)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  return { meta->levels, meta->levels + std::size_t{ meta->rows } * meta->columns };
}

CHECK_TEST(test_moved_picture)
{
  GstVideoInfo in;
  GstVideoInfo out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_I420, 60, 40);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_I420, 60, 40);
  const GstVideoRectangle all{ 0, 0, 60, 40 };
  const Matrix mirrored{ &in, all, &out, all, { { -1, 0, 59 }, { 0, 1, 0 }, { 0, 0, 1 } } };
  // The right third of the picture fills the output.
  const Matrix third{
    &in, { 40, 0, 20, 40 }, &out, all, { { 3, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }
  };
  // All of it in the output's lower right quarter.
  const Matrix quarter{
    &in, all, &out, { 30, 20, 30, 20 }, { { 0.5F, 0, 0 }, { 0, 0.5F, 0 }, { 0, 0, 1 } }
  };
  const Matrix sheared{ &in, all, &out, all, { { 1, 0.5F, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
  const Matrix perspective{ &in, all, &out, all, { { 1, 0, 0 }, { 0, 1, 0 }, { 0.1F, 0, 1 } } };
  const Matrix nowhere{ &in, all, &out, all, { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 1 } } };

  g_autoptr(GstBuffer) source = gst_buffer_new();
  add(source);
  for (const auto &[matrix, levels] :
       { std::pair{ mirrored, std::vector<gfloat>{ 0.5F, 0.25F, 0, 0.125F, 1, 0.75F } },
         std::pair{ third, std::vector<gfloat>{ 0.5F, 0.5F, 0.5F, 0.125F, 0.125F, 0.125F } },
         // Cells are 20 x 20 pixels, those of the picture in it 10 x 10.
         std::pair{ quarter, std::vector<gfloat>{ 0, 0, 0, 0, 0.375F,
                                                  (0.25F + 0.5F + 1 + 0.125F) / 4 } } }) {
    g_autoptr(GstBuffer) moved = gst_buffer_new();
    fail_unless(move(source, moved, matrix));
    const std::vector<gfloat> got = levels_of(moved);
    for (std::size_t i = 0; i < levels.size(); i++)
      fail_unless(std::abs(got[i] - levels[i]) < 1e-5F, "cell %u: %g", static_cast<guint>(i),
                  static_cast<double>(got[i]));
  }
  for (const Matrix &matrix : { sheared, perspective, nowhere }) {
    g_autoptr(GstBuffer) moved = gst_buffer_new();
    fail_if(move(source, moved, matrix));
    fail_unless_equals_int(count_metas(moved), 0);
  }
}

/// Two pictures in one frame have one map, the stronger level of each cell.
CHECK_TEST(test_two_pictures)
{
  GstVideoInfo in;
  GstVideoInfo out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_I420, 60, 40);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_I420, 120, 40);
  const GstVideoRectangle all{ 0, 0, 60, 40 };
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  for (const int x : { 0, 60, 0 }) {
    const std::array<gfloat, 4> levels{ 0.25F, 0.5F, x > 0 ? 1.0F : 0.75F, 0 };
    g_autoptr(GstBuffer) picture = gst_buffer_new();
    gst_buffer_add_tactile_meta(picture, 1, 4, levels.data(), levels.size());
    fail_unless(
        move(picture, frame,
             { &in, all, &out, { x, 0, 60, 40 }, { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }));
  }
  fail_unless(levels_of(frame) == std::vector<gfloat>({ 0.375F, 0.375F, 0.375F, 0.5F }));
}

/// The levels are upright already: who turns the frame, too, leaves them. What comes after that
/// turns both.
CHECK_TEST(test_turned_as_told)
{
  GstVideoInfo in;
  GstVideoInfo out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_I420, 60, 40);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_I420, 40, 60);
  const Matrix right{
    &in, { 0, 0, 60, 40 }, &out, { 0, 0, 40, 60 }, { { 0, -1, 39 }, { 1, 0, 0 }, { 0, 0, 1 } }
  };
  const Matrix mirrored{
    &out, { 0, 0, 40, 60 }, &out, { 0, 0, 40, 60 }, { { -1, 0, 39 }, { 0, 1, 0 }, { 0, 0, 1 } }
  };
  // The left half of the stored frame is the upper half of what is seen.
  const Matrix half{
    &in, { 0, 0, 30, 40 }, &in, { 0, 0, 60, 40 }, { { 2, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }
  };
  g_autoptr(GstBuffer) source = gst_buffer_new();
  gst_tactile_meta_set_video_direction(add(source), GST_VIDEO_ORIENTATION_90R);
  g_autoptr(GstBuffer) turned = gst_buffer_new();
  fail_unless(move(source, turned, right));
  assert_levels(turned);
  g_autoptr(GstBuffer) copy = gst_buffer_copy(turned);
  g_autoptr(GstBuffer) then = gst_buffer_new();
  fail_unless(move(copy, then, mirrored));
  fail_unless(levels_of(then) == std::vector<gfloat>({ 0.5F, 0.25F, 0, 0.125F, 1, 0.75F }));
  g_autoptr(GstBuffer) upper = gst_buffer_new();
  fail_unless(move(source, upper, half));
  fail_unless(levels_of(upper) == std::vector<gfloat>({ 0, 0.25F, 0.5F, 0, 0.25F, 0.5F }));
}

CHECK_TEST(test_pooled_buffers)
{
  GstBufferPool *pool = gst_buffer_pool_new();
  GstStructure *config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, nullptr, 64, 1, 1);
  fail_unless(gst_buffer_pool_set_config(pool, config));
  fail_unless(gst_buffer_pool_set_active(pool, TRUE));

  GstBuffer *acquired = nullptr;
  fail_unless_equals_int(gst_buffer_pool_acquire_buffer(pool, &acquired, nullptr), GST_FLOW_OK);
  GstTactileMeta *meta = add(acquired);
  fail_if(GST_META_FLAG_IS_SET(&meta->meta, GST_META_FLAG_POOLED));
  fail_if(GST_META_FLAG_IS_SET(&meta->meta, GST_META_FLAG_LOCKED));
  const GstBuffer *same = acquired;
  gst_buffer_unref(acquired);

  // Levels of the last frame must not appear in the next one.
  GstBuffer *again = nullptr;
  fail_unless_equals_int(gst_buffer_pool_acquire_buffer(pool, &again, nullptr), GST_FLOW_OK);
  fail_unless(again == same);
  fail_unless_equals_int(count_metas(again), 0);
  gst_buffer_unref(again);
  gst_buffer_pool_set_active(pool, FALSE);
  gst_object_unref(pool);
}

CHECK_TEST(test_survives_real_elements)
{
  GstHarness *h = gst_harness_new_parse(
      "videoconvert ! videoscale ! video/x-raw,format=RGB,width=20,height=30 ! "
      "videoconvert ! video/x-raw,format=NV12 ! identity");
  gst_harness_set_src_caps_str(
      h, "video/x-raw,format=I420,width=40,height=30,framerate=30/1,interlace-mode=progressive");
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, 40 * 30 * 3 / 2, nullptr);
  gst_buffer_memset(buffer, 0, 128, -1);
  add(buffer);
  const std::array<gfloat, 1> value{ 2.5F };
  gst_buffer_add_saliency_meta(buffer, 1, 1, value.data(), 1, 0.5F);
  GstBuffer *out = gst_harness_push_and_pull(h, buffer);
  fail_unless(out != nullptr);
  assert_levels(out);
  GstSaliencyMeta *saliency = gst_buffer_get_saliency_meta(out);
  fail_unless(saliency != nullptr);
  fail_unless_equals_float(gst_saliency_meta_get_value(saliency, 0, 0), 2.5);
  fail_unless_equals_float(saliency->floor, 0.5);
  gst_buffer_unref(out);
  gst_harness_teardown(h);
}

CHECK_MAIN(tactile_meta)
