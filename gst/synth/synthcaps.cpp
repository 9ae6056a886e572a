// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synthcaps.h"

#include <vector>

namespace {

constexpr gint kRate = 48000;

synth::Place
place_of(GstAudioChannelPosition position)
{
  using synth::Place;
  switch (position) {
  case GST_AUDIO_CHANNEL_POSITION_MONO:
  case GST_AUDIO_CHANNEL_POSITION_FRONT_CENTER:
    return Place::front_center;
  case GST_AUDIO_CHANNEL_POSITION_FRONT_LEFT:
    return Place::front_left;
  case GST_AUDIO_CHANNEL_POSITION_FRONT_RIGHT:
    return Place::front_right;
  case GST_AUDIO_CHANNEL_POSITION_REAR_LEFT:
  case GST_AUDIO_CHANNEL_POSITION_SURROUND_LEFT:
    return Place::back_left;
  case GST_AUDIO_CHANNEL_POSITION_REAR_RIGHT:
  case GST_AUDIO_CHANNEL_POSITION_SURROUND_RIGHT:
    return Place::back_right;
  case GST_AUDIO_CHANNEL_POSITION_REAR_CENTER:
    return Place::back_center;
  case GST_AUDIO_CHANNEL_POSITION_SIDE_LEFT:
    return Place::side_left;
  case GST_AUDIO_CHANNEL_POSITION_SIDE_RIGHT:
    return Place::side_right;
  case GST_AUDIO_CHANNEL_POSITION_LFE1:
  case GST_AUDIO_CHANNEL_POSITION_LFE2:
    return Place::low;
  default:
    return Place::other;
  }
}

} // namespace

std::optional<GstAudioInfo>
synth_negotiate(GstPad *pad, gint channels)
{
  g_autoptr(GstCaps) own = gst_pad_get_pad_template_caps(pad);
  g_autoptr(GstCaps) caps = gst_pad_peer_query_caps(pad, own);
  if (gst_caps_is_empty(caps))
    return std::nullopt;
  caps = gst_caps_truncate(gst_caps_make_writable(caps));
  GstStructure *structure = gst_caps_get_structure(caps, 0);
  gst_structure_fixate_field_nearest_int(structure, "rate", kRate);
  gst_structure_fixate_field_nearest_int(structure, "channels", channels);
  gst_structure_get_int(structure, "channels", &channels);
  if (channels > 2 && !gst_structure_has_field(structure, "channel-mask"))
    gst_structure_set(structure, "channel-mask", GST_TYPE_BITMASK, G_GUINT64_CONSTANT(0), nullptr);
  caps = gst_caps_fixate(caps);
  GstAudioInfo info;
  if (!gst_audio_info_from_caps(&info, caps))
    return std::nullopt;
  return info;
}

synth::ChannelCells
synth_cells(const GstAudioInfo &info, guint rows, guint columns)
{
  const auto grid_rows = static_cast<int>(rows);
  const auto grid_columns = static_cast<int>(columns);
  if (GST_AUDIO_INFO_IS_UNPOSITIONED(&info))
    return synth::plain_cells(grid_rows, grid_columns, GST_AUDIO_INFO_CHANNELS(&info));
  std::vector<synth::Place> places;
  for (gint i = 0; i < GST_AUDIO_INFO_CHANNELS(&info); i++)
    places.push_back(place_of(GST_AUDIO_INFO_POSITION(&info, i)));
  return synth::placed_cells(grid_rows, grid_columns, places);
}

std::string
synth_describe(const synth::ChannelCells &cells)
{
  std::string text;
  for (std::size_t channel = 0; channel < cells.size(); channel++) {
    text.append(channel > 0 ? "; " : "").append("channel ").append(std::to_string(channel));
    if (cells[channel].empty())
      text.append(" is silent");
    for (std::size_t i = 0; i < cells[channel].size(); i++)
      text.append(i > 0 ? "," : ": ").append(std::to_string(cells[channel][i]));
  }
  return text;
}
