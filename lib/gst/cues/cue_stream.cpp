// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cue_stream.h"

#include "tracks/klv.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

using tactile::Cue;
using tactile::FormatError;

/// Field of a GAP event that holds the packet.
constexpr const char *kPacket = "tactile-packet";

tl::unexpected<FormatError>
refused(const char *reason)
{
  return tl::unexpected(FormatError{ .place = {}, .reason = reason });
}

tl::expected<Cue, FormatError>
read_map(GstBuffer *buffer, const tactile::Grid &grid)
{
  g_autofree gfloat *levels = nullptr;
  gsize count = 0;
  if (!gst_tactile_map_buffer_get_levels(buffer, static_cast<guint>(grid.rows),
                                         static_cast<guint>(grid.columns), &levels, &count))
    return refused("the map has another size than its caps say");
  Cue cue{ .map = tactile::TactileMap(grid.rows, grid.columns) };
  std::copy(levels, levels + count, cue.map.levels.begin());
  cue.map.frequency = gst_buffer_get_tactile_frequency(buffer);
  return cue;
}

tl::expected<Cue, FormatError>
read_text(std::string_view text, const std::optional<tactile::Grid> &grid)
{
  tl::expected<tactile::TactileMap, FormatError> map = tactile::read_text_cue(text, grid);
  if (!map && grid) // retry with the text's own grid
    map = tactile::read_text_cue(text, std::nullopt);
  return std::move(map).map([](tactile::TactileMap own) { return Cue{ .map = std::move(own) }; });
}

} // namespace

GstCaps *
cue_caps_new(CueForm form)
{
  return gst_caps_from_string(form == CueForm::map    ? GST_TACTILE_MAP_CAPS
                              : form == CueForm::text ? CUE_TEXT_CAPS
                                                      : CUE_KLV_CAPS);
}

std::optional<CueForm>
cue_form_of(const GstCaps *caps)
{
  if (caps == nullptr || gst_caps_get_size(caps) == 0)
    return std::nullopt;
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  const std::string_view name = gst_structure_get_name(structure);
  if (name == GST_TACTILE_MAP_MEDIA_TYPE)
    return CueForm::map;
  if (name == "text/x-raw")
    return CueForm::text;
  if (name == "meta/x-klv")
    return CueForm::klv;
  if (name == CUE_WEBVTT_CAPS)
    return gst_structure_has_field(structure, "codec_data") ? CueForm::text : CueForm::block;
  return std::nullopt;
}

std::string_view
cue_text(std::string_view bytes, CueForm form)
{
  std::string_view text = bytes.substr(0, bytes.find('\0'));
  for (int line = 0; form == CueForm::block && line < 2; line++)
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text;
}

GstBuffer *
cue_buffer_new(const tactile::Cue &cue, CueForm form)
{
  GstBuffer *buffer = nullptr;
  if (form == CueForm::map) {
    buffer = gst_tactile_map_buffer_new(cue.map.levels.data(), cue.map.levels.size());
    gst_buffer_set_tactile_frequency(buffer, cue.map.frequency);
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

GstEvent *
cue_gap_new(GstBuffer *packet)
{
  GstEvent *gap = gst_event_new_gap(GST_BUFFER_PTS(packet), GST_CLOCK_TIME_NONE);
  gst_structure_set(gst_event_writable_structure(gap), kPacket, GST_TYPE_BUFFER, packet, nullptr);
  return gap;
}

GstBuffer *
cue_gap_get_packet(GstEvent *gap)
{
  GstBuffer *packet = nullptr;
  gst_structure_get(gst_event_get_structure(gap), kPacket, GST_TYPE_BUFFER, &packet, nullptr);
  return packet;
}

tl::expected<Cue, FormatError>
cue_from_buffer(GstBuffer *buffer, CueForm form, const std::optional<tactile::Grid> &grid)
{
  if (form == CueForm::map)
    return read_map(buffer, *grid);
  GstMapInfo info;
  if (!gst_buffer_map(buffer, &info, GST_MAP_READ))
    return refused("the buffer cannot be read");
  const std::string_view text(reinterpret_cast<const char *>(info.data), info.size);
  tl::expected<Cue, FormatError> cue = form == CueForm::klv
                                           ? tactile::read_klv({ info.data, info.size })
                                           : read_text(cue_text(text, form), grid);
  gst_buffer_unmap(buffer, &info);
  return cue;
}

bool
cue_is_remark(GstBuffer *buffer, CueForm form)
{
  GstMapInfo info;
  if ((form != CueForm::text && form != CueForm::block)
      || !gst_buffer_map(buffer, &info, GST_MAP_READ))
    return false;
  const std::string_view words(reinterpret_cast<const char *>(info.data), info.size);
  const bool is_remark = tactile::is_remark(cue_text(words, form));
  gst_buffer_unmap(buffer, &info);
  return is_remark;
}
