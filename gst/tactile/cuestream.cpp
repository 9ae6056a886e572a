// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cuestream.h"

#include "tactile/klv.h"
#include "tactile/track.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace {

tactile::TactileMap
map_of(GstBuffer *buffer, const tactile::Grid &grid)
{
  gfloat *levels = nullptr;
  gsize count = 0;
  if (!gst_tactile_map_buffer_get_levels(buffer, static_cast<guint>(grid.rows),
                                         static_cast<guint>(grid.columns), &levels, &count))
    throw tactile::FormatError("the map has another size than its caps say");
  tactile::TactileMap map(grid.rows, grid.columns);
  std::copy(levels, levels + count, map.levels.begin());
  g_free(levels);
  return map;
}

std::string
bytes_of(GstBuffer *buffer)
{
  GstMapInfo info;
  if (!gst_buffer_map(buffer, &info, GST_MAP_READ))
    throw tactile::FormatError("the buffer cannot be read");
  std::string bytes(reinterpret_cast<const char *>(info.data), info.size);
  gst_buffer_unmap(buffer, &info);
  return bytes;
}

tactile::TactileMap
read_text(std::string_view text, const std::optional<tactile::Grid> &grid)
{
  if (grid) {
    try {
      return tactile::read_text_cue(text, grid);
    } catch (const tactile::FormatError &) {
      // Of a grid of its own, then.
    }
  }
  return tactile::read_text_cue(text, std::nullopt);
}

} // namespace

GstCaps *
cue_caps_new(CueForm form)
{
  return gst_caps_from_string(form == CueForm::map    ? GST_TACTILE_MAP_CAPS
                              : form == CueForm::text ? CUE_TEXT_CAPS
                                                      : CUE_KLV_CAPS);
}

CueForm
cue_form_of(const GstCaps *caps)
{
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  if (gst_structure_has_name(structure, GST_TACTILE_MAP_MEDIA_TYPE))
    return CueForm::map;
  return gst_structure_has_name(structure, "meta/x-klv") ? CueForm::klv : CueForm::text;
}

GstBuffer *
cue_buffer_new(const tactile::Cue &cue, CueForm form)
{
  GstBuffer *buffer = nullptr;
  if (form == CueForm::map) {
    buffer = gst_tactile_map_buffer_new(cue.map.levels.data(), cue.map.levels.size());
  } else if (form == CueForm::text) {
    const std::string text = tactile::write_text_cue(cue.map);
    buffer = gst_buffer_new_memdup(text.data(), text.size());
  } else {
    const std::vector<std::uint8_t> bytes = tactile::write_klv(cue.map, cue.end - cue.begin);
    buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
  }
  GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(cue.begin.count());
  GST_BUFFER_DURATION(buffer) = static_cast<GstClockTime>((cue.end - cue.begin).count());
  return buffer;
}

tactile::Cue
cue_from_buffer(GstBuffer *buffer, CueForm form, const std::optional<tactile::Grid> &grid)
{
  tactile::Cue cue;
  if (form == CueForm::map) {
    cue.map = map_of(buffer, grid.value());
    return cue;
  }
  const std::string bytes = bytes_of(buffer);
  if (form == CueForm::klv)
    return tactile::read_klv(
        { reinterpret_cast<const std::uint8_t *>(bytes.data()), bytes.size() });
  cue.map = read_text({ bytes.data(), std::min(bytes.find('\0'), bytes.size()) }, grid);
  return cue;
}
