// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/cue_builder.h"
#include "tracks/format_error.h"
#include "tracks/text_cue.h"

#include <gst/gst.h>

#include <optional>
#include <string_view>

/// Representation of cues in a GStreamer stream.
enum class CueForm
{
  map,  ///< application/x-tactile-map
  text, ///< tracks/text_cue.h
  klv,  ///< tracks/klv.h
  block ///< WebVTT as WebM has it: a line with the cue's name, one with its settings, then the text
};

#define CUE_TEXT_CAPS "text/x-raw, format = (string) utf8"
#define CUE_KLV_CAPS "meta/x-klv, parsed = (boolean) true"
/// WebVTT in Matroska (mkvmerge, with its header as codec_data) and WebM (FFmpeg, without):
/// matroskademux has no name for it.
#define CUE_WEBVTT_CAPS "application/x-subtitle-unknown"

/// Template caps of this form, but for blocks; for text and KLV they are fixed. Transfer full.
GstCaps *cue_caps_new(CueForm form);

/// The form of cues in a stream with these caps; none if it has other data.
std::optional<CueForm> cue_form_of(const GstCaps *caps);

/// The text of a cue in one of the forms of text.
std::string_view cue_text(std::string_view bytes, CueForm form);

/// A buffer with the cue's map, timestamp and duration, of any form but a block. Transfer full.
GstBuffer *cue_buffer_new(const tactile::Cue &cue, CueForm form);

/// A GAP event at the packet's time that carries the KLV packet, so that a subtitle renderer draws
/// nothing. Transfer full.
GstEvent *cue_gap_new(GstBuffer *packet);

/// The KLV packet in a GAP event, or nullptr. Transfer full.
GstBuffer *cue_gap_get_packet(GstEvent *gap);

/// Parses a buffer into a cue that begins at 0; its end is 0 if the bytes give no duration. A map
/// requires `grid`. A text is read with `grid` if possible, otherwise with a grid of its own.
tl::expected<tactile::Cue, tactile::FormatError>
cue_from_buffer(GstBuffer *buffer, CueForm form, const std::optional<tactile::Grid> &grid);

/// Whether a buffer is a remark among the maps of a track (tactile::is_remark()).
bool cue_is_remark(GstBuffer *buffer, CueForm form);
