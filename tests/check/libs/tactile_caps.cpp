// SPDX-License-Identifier: LGPL-2.1-or-later
#include "refused.h"

#include <gst/tactile/tactile.h>

#include <array>
#include <cstring>
#include <vector>

#include "support/check_tests.h"

namespace {

/// Whether the caps can be read. If not, no output may be written.
bool
parses(const gchar *text, guint *rows, guint *columns, gint *n, gint *d)
{
  GstCaps *caps = gst_caps_from_string(text);
  fail_unless(caps != nullptr, "%s", text);
  const gboolean ok = gst_tactile_map_caps_parse(caps, rows, columns, n, d);
  gst_caps_unref(caps);
  return ok;
}

} // namespace

CHECK_TEST(test_caps)
{
  GstCaps *caps = gst_tactile_map_caps_new(3, 5, 30000, 1001);
  GstCaps *expected = gst_caps_from_string(
      "application/x-tactile-map, rows=(int)3, columns=(int)5, framerate=(fraction)30000/1001");
  GstCaps *any = gst_caps_from_string(GST_TACTILE_MAP_CAPS);
  fail_unless(gst_caps_is_fixed(caps));
  fail_unless(gst_caps_is_strictly_equal(caps, expected));
  fail_unless(gst_caps_is_subset(caps, any));

  guint rows = 0;
  guint columns = 0;
  gint n = -1;
  gint d = -1;
  fail_unless(gst_tactile_map_caps_parse(caps, &rows, &columns, &n, &d));
  fail_unless_equals_int(rows, 3);
  fail_unless_equals_int(columns, 5);
  fail_unless_equals_int(n, 30000);
  fail_unless_equals_int(d, 1001);
  fail_unless(gst_tactile_map_caps_parse(caps, nullptr, nullptr, nullptr, nullptr));
  for (GstCaps *c : { caps, expected, any })
    gst_caps_unref(c);
}

CHECK_TEST(test_caps_without_framerate)
{
  guint rows = 0;
  guint columns = 0;
  gint n = -1;
  gint d = -1;
  fail_unless(parses("application/x-tactile-map, rows=64, columns=1", &rows, &columns, &n, &d));
  fail_unless_equals_int(rows, 64);
  fail_unless_equals_int(columns, 1);
  fail_unless_equals_int(n, 0);
  fail_unless_equals_int(d, 1);
}

CHECK_TEST(test_caps_of_something_else)
{
  guint rows = 77;
  guint columns = 78;
  gint n = 79;
  gint d = 80;
  for (const gchar *text : {
           "video/x-raw, rows=3, columns=3",
           "application/x-tactile-map",
           "application/x-tactile-map, rows=3",
           "application/x-tactile-map, columns=3",
           "application/x-tactile-map, rows=0, columns=3",
           "application/x-tactile-map, rows=3, columns=65",
           "application/x-tactile-map, rows=-1, columns=3",
           "application/x-tactile-map, rows=(string)3, columns=3",
           "application/x-tactile-map, rows=[1,3], columns=3",
           "application/x-tactile-map, rows=3, columns=3, framerate=30.5",
           "application/x-tactile-map, rows=3, columns=3, framerate=(fraction)-1/1",
           "ANY",
           "EMPTY",
       })
    fail_if(parses(text, &rows, &columns, &n, &d), "%s", text);
  fail_unless(rows == 77 && columns == 78 && n == 79 && d == 80);

  ASSERT_REFUSED(gst_tactile_map_caps_new(0, 3, 30, 1));
  ASSERT_REFUSED(gst_tactile_map_caps_new(3, 65, 30, 1));
  ASSERT_REFUSED(gst_tactile_map_caps_new(3, 3, -1, 1));
  ASSERT_REFUSED(gst_tactile_map_caps_new(3, 3, 30, 0));
}

CHECK_TEST(test_buffer_bytes)
{
  // IEEE 754 single precision, little endian.
  const std::array<gfloat, 4> levels{ 0.25F, 1.0F, -3.0F, std::nanf("") };
  const std::array<guint8, 16> bytes{ 0, 0, 0x80, 0x3e, 0, 0, 0x80, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0 };
  GstBuffer *buffer = gst_tactile_map_buffer_new(levels.data(), levels.size());
  fail_unless_equals_int(gst_buffer_get_size(buffer), bytes.size());
  fail_unless(gst_buffer_memcmp(buffer, 0, bytes.data(), bytes.size()) == 0);
  fail_if(GST_BUFFER_PTS_IS_VALID(buffer));
  gst_buffer_unref(buffer);

  ASSERT_REFUSED(gst_tactile_map_buffer_new(nullptr, 9));
  ASSERT_REFUSED(gst_tactile_map_buffer_new(levels.data(), 0));
  ASSERT_REFUSED(gst_tactile_map_buffer_new(levels.data(), 64 * 64 + 1));
}

CHECK_TEST(test_buffer_levels)
{
  // 0.5, 2.0, NaN, -1.0 from two memories. A level straddles them.
  const std::array<guint8, 16> bytes{ 0, 0, 0,    0x3f, 0, 0, 0,    0x40,
                                      0, 0, 0xc0, 0x7f, 0, 0, 0x80, 0xbf };
  const std::array<gfloat, 4> expected{ 0.5F, 1.0F, 0.0F, 0.0F };
  GstBuffer *buffer = gst_buffer_new_memdup(bytes.data(), 6);
  buffer = gst_buffer_append(buffer, gst_buffer_new_memdup(bytes.data() + 6, 10));

  gfloat *levels = nullptr;
  gsize n = 0;
  fail_unless(gst_tactile_map_buffer_get_levels(buffer, 2, 2, &levels, &n));
  fail_unless_equals_int(n, 4);
  for (gsize i = 0; i < n; i++)
    fail_unless_equals_float(levels[i], expected[i]);
  g_free(levels);

  for (const auto &[rows, columns] :
       { std::pair{ 1U, 3U }, std::pair{ 5U, 1U }, std::pair{ 3U, 3U } }) {
    levels = reinterpret_cast<gfloat *>(1);
    n = 99;
    fail_if(gst_tactile_map_buffer_get_levels(buffer, rows, columns, &levels, &n));
    fail_unless(levels == nullptr && n == 0);
  }
  ASSERT_REFUSED(gst_tactile_map_buffer_get_levels(buffer, 0, 4, &levels, &n));
  ASSERT_REFUSED(gst_tactile_map_buffer_get_levels(buffer, 65, 4, &levels, &n));
  gst_buffer_unref(buffer);

  GstBuffer *empty = gst_buffer_new();
  fail_if(gst_tactile_map_buffer_get_levels(empty, 1, 1, &levels, &n));
  gst_buffer_unref(empty);
}

CHECK_TEST(test_round_trip)
{
  std::vector<gfloat> in(64 * 64);
  for (gsize i = 0; i < in.size(); i++)
    in[i] = static_cast<gfloat>(i) / static_cast<gfloat>(in.size());
  GstBuffer *buffer = gst_tactile_map_buffer_new(in.data(), in.size());
  gfloat *out = nullptr;
  gsize n = 0;
  fail_unless(gst_tactile_map_buffer_get_levels(buffer, 64, 64, &out, &n));
  fail_unless(n == in.size() && std::memcmp(in.data(), out, n * sizeof(gfloat)) == 0);
  g_free(out);
  gst_buffer_unref(buffer);
}

CHECK_MAIN(tactile_caps)
