// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes caps and buffers of a tactile stream, as a network peer may send them: an accepted map has
// as many levels as its caps. Input: a line of caps, then the bytes of a buffer.
#include "fuzz.h"

#include <gst/tactile/tactile.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace {

void
check(const std::string &line, const std::string &bytes)
{
  GstCaps *caps = gst_caps_from_string(line.c_str());
  if (!caps)
    return;
  guint rows = 0;
  guint columns = 0;
  gint numerator = -1;
  gint denominator = 0;
  if (gst_caps_is_fixed(caps)
      && gst_tactile_map_caps_parse(caps, &rows, &columns, &numerator, &denominator)) {
    expect(rows >= 1 && rows <= 64 && columns >= 1 && columns <= 64);
    expect(numerator >= 0 && denominator > 0);
    GstBuffer *buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
    gfloat *levels = nullptr;
    gsize count = 0;
    if (gst_tactile_map_buffer_get_levels(buffer, rows, columns, &levels, &count)) {
      expect(count == static_cast<gsize>(rows) * columns);
      // Each level can be read.
      for (gsize i = 0; i < count; i++)
        expect(std::isnan(levels[i]) || levels[i] <= std::numeric_limits<gfloat>::infinity());
    }
    g_free(levels);
    gst_buffer_unref(buffer);
  }
  gst_caps_unref(caps);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  static const bool initialized = [] {
    gst_init(nullptr, nullptr);
    return true;
  }();
  (void)initialized;
  const std::string text(reinterpret_cast<const char *>(data), size);
  const std::size_t end = text.find('\n');
  check(text.substr(0, end), end == std::string::npos ? "" : text.substr(end + 1));
  return 0;
}
