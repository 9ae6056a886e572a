// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The frames that visuotactile-play keeps for its picture.
#include "visuotactile-play/strip.h"

#include <array>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"
#include "support/temporary_file.h"

namespace {

constexpr GstClockTime kFrame = GST_SECOND / 5;

/// How many frames the picture of a film of a minute has of six parts, of which it is shown what is
/// in these spans, in seconds.
int
frames_of(const std::vector<std::pair<GstClockTime, GstClockTime>> &shown)
{
  Strip strip(60 * GST_SECOND, 6);
  g_autoptr(GstCaps) caps
      = gst_caps_from_string("video/x-raw,format=RGB,width=16,height=16,framerate=5/1");
  for (const auto &[begin, end] : shown)
    for (GstClockTime time = begin * GST_SECOND; time < end * GST_SECOND; time += kFrame) {
      GstBuffer *frame = gst_buffer_new_allocate(nullptr, std::size_t{ 16 } * 16 * 3, nullptr);
      gst_buffer_memset(frame, 0, 0, static_cast<gsize>(-1));
      strip.offer(frame, caps, time);
      gst_buffer_unref(frame);
    }
  const TemporaryFile picture;
  fail_unless(strip.write(picture.path));
  // The header's width, of PNG: a margin of 6, and frames of 240 with one each.
  std::array<unsigned char, 24> header{};
  std::ifstream(picture.path, std::ios::binary)
      .read(reinterpret_cast<char *>(header.data()), header.size());
  const int width = header[16] << 24 | header[17] << 16 | header[18] << 8 | header[19];
  ck_assert_int_eq(width % 246, 6);
  return width / 246;
}

} // namespace

CHECK_TEST(test_whole_film)
{
  ck_assert_int_eq(frames_of({ { 0, 60 } }), 6);
  ck_assert_int_eq(frames_of({ { 0, 3 } }), 1); // ends before the first turn
}

/// Of each part that is shown there is one frame.
CHECK_TEST(test_seek)
{
  ck_assert_int_eq(frames_of({ { 0, 10 }, { 46, 54 } }), 2);
  ck_assert_int_eq(frames_of({ { 0, 10 }, { 56, 60 }, { 0, 20 } }), 2); // nothing twice
}

CHECK_MAIN(strip)
