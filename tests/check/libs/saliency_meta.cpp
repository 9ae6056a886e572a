// SPDX-License-Identifier: LGPL-2.1-or-later
#include "refused.h"

#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "support/check_tests.h"

namespace {

constexpr std::array<gfloat, 6> kValues{ 0.0F, 12.5F, 3.0F, 100.0F, 0.001F, 7.0F };
constexpr gfloat kFloor = 0.6F;

GstSaliencyMeta *
add(GstBuffer *buffer)
{
  return gst_buffer_add_saliency_meta(buffer, 3, 2, kValues.data(), kValues.size(), kFloor);
}

void
assert_values(GstBuffer *buffer)
{
  GstSaliencyMeta *meta = gst_buffer_get_saliency_meta(buffer);
  fail_unless(meta != nullptr);
  fail_unless_equals_int(meta->width, 3);
  fail_unless_equals_int(meta->height, 2);
  fail_unless_equals_float(meta->floor, kFloor);
  gsize n = 0;
  const gfloat *values = gst_saliency_meta_get_values(meta, &n);
  fail_unless_equals_int(n, kValues.size());
  for (gsize i = 0; i < n; i++) {
    fail_unless_equals_float(values[i], kValues[i]);
    fail_unless_equals_float(gst_saliency_meta_get_value(meta, i % 3, i / 3), kValues[i]);
  }
}

guint
count_metas(GstBuffer *buffer)
{
  return gst_buffer_get_n_meta(buffer, GST_SALIENCY_META_API_TYPE);
}

} // namespace

CHECK_TEST(test_add_and_get)
{
  GstBuffer *buffer = gst_buffer_new();
  fail_unless(gst_buffer_get_saliency_meta(buffer) == nullptr);
  fail_unless(add(buffer) == gst_buffer_get_saliency_meta(buffer));
  assert_values(buffer);
  const gchar *const *tags = gst_meta_api_type_get_tags(GST_SALIENCY_META_API_TYPE);
  const gchar *const expected[] = { GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR,
                                    GST_META_TAG_VIDEO_ORIENTATION_STR, nullptr };
  for (int i = 0; i < 4; i++)
    fail_unless_equals_string(tags[i], expected[i]);
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_values_are_finite)
{
  constexpr gfloat inf = std::numeric_limits<gfloat>::infinity();
  const std::array<gfloat, 4> wild{ -1, std::nanf(""), inf, 1e30F };
  const std::array<gfloat, 4> tame{ 0, 0, 0, 1e30F };
  GstBuffer *buffer = gst_buffer_new();
  GstSaliencyMeta *meta = gst_buffer_add_saliency_meta(buffer, 4, 1, wild.data(), wild.size(), 0);
  for (guint i = 0; i < tame.size(); i++)
    fail_unless(gst_saliency_meta_get_value(meta, i, 0) == tame[i]);
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_limits)
{
  const std::vector<gfloat> many(4097 * 2, 1.0F);
  GstBuffer *buffer = gst_buffer_new();
  fail_unless(gst_buffer_add_saliency_meta(buffer, 4096, 2, many.data(), 8192, 0) != nullptr);
  fail_unless(gst_buffer_add_saliency_meta(buffer, 2, 4096, many.data(), 8192, 0) != nullptr);
  gst_buffer_unref(buffer);

  buffer = gst_buffer_new();
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 4097, 1, many.data(), 4097, 0));
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 1, 4097, many.data(), 4097, 0));
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 0, 1, many.data(), 0, 0));
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 1, 0, many.data(), 0, 0));
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 3, 2, many.data(), 5, 0));
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 3, 2, nullptr, 6, 0));
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 3, 2, many.data(), 6, -1));
  ASSERT_REFUSED(gst_buffer_add_saliency_meta(buffer, 3, 2, many.data(), 6, std::nanf("")));
  fail_unless_equals_int(count_metas(buffer), 0);
  GstSaliencyMeta *meta = add(buffer);
  g_test_expect_message("visuotactile", G_LOG_LEVEL_CRITICAL, "*assertion*failed*");
  fail_unless(gst_saliency_meta_get_value(meta, 3, 0) == 0);
  g_test_expect_message("visuotactile", G_LOG_LEVEL_CRITICAL, "*assertion*failed*");
  fail_unless(gst_saliency_meta_get_value(meta, 0, 2) == 0);
  g_test_assert_expected_messages();
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_one_per_buffer)
{
  const std::array<gfloat, 1> other{ 9 };
  GstBuffer *buffer = gst_buffer_new();
  gst_buffer_add_saliency_meta(buffer, 1, 1, other.data(), 1, 0);
  add(buffer);
  fail_unless_equals_int(count_metas(buffer), 1);
  assert_values(buffer);
  gst_buffer_unref(buffer);
}

CHECK_TEST(test_copies_and_transforms)
{
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, 100, nullptr);
  GstMeta *meta = &add(buffer)->meta;
  GstBuffer *whole = gst_buffer_copy(buffer);
  GstBuffer *region = gst_buffer_copy_region(buffer, GST_BUFFER_COPY_ALL, 10, 20);

  GstVideoInfo in;
  GstVideoInfo out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_I420, 64, 48);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_I420, 32, 24);
  GstVideoMetaTransform scale{ &in, &out };
  GstBuffer *scaled = gst_buffer_new();
  fail_unless(meta->info->transform_func(scaled, meta, buffer,
                                         gst_video_meta_transform_scale_get_quark(), &scale));
  GstBuffer *other = gst_buffer_new();
  fail_if(meta->info->transform_func(other, meta, buffer,
                                     g_quark_from_static_string("rotated-by-someone"), nullptr));
  fail_unless_equals_int(count_metas(other), 0);

  gst_buffer_get_saliency_meta(buffer)->values[1] = 0; // copies have their own values
  gst_buffer_unref(buffer);
  assert_values(whole);
  assert_values(region);
  assert_values(scaled);
  for (GstBuffer *copy : { whole, region, scaled, other })
    gst_buffer_unref(copy);
}

CHECK_MAIN(saliency_meta)
