// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/cue_builder.h"
#include "tracks/format_error.h"
#include "tracks/text_cue.h"

#include <gst/gst.h>

#include <optional>

/// How cues travel in a GStreamer stream.
enum class CueForm
{
  map,  ///< application/x-tactile-map
  text, ///< tracks/text_cue.h
  klv,  ///< tracks/klv.h
};

#define CUE_TEXT_CAPS "text/x-raw, format = (string) utf8"
#define CUE_KLV_CAPS "meta/x-klv, parsed = (boolean) true"

/// All that a stream of this form may be; for text and KLV that is what it is. Transfer full.
GstCaps *cue_caps_new(CueForm form);

/// The form of a stream with these caps, which are of one of them.
CueForm cue_form_of(const GstCaps *caps);

/// A buffer with the cue's map and its times. Transfer full.
GstBuffer *cue_buffer_new(const tactile::Cue &cue, CueForm form);

/// A GAP event at the packet's time that carries the KLV packet: in subtitles, a cue that nobody
/// can draw. Transfer full.
GstEvent *cue_gap_new(GstBuffer *packet);

/// The KLV packet that a GAP event carries, or nullptr. Transfer full.
GstBuffer *cue_gap_get_packet(GstEvent *gap);

/// The cue that a buffer is, which begins at 0 and has no end if the bytes say none. A map has the
/// grid that is given, which it needs; a text is read in it if it can be, and else in one of its
/// own.
tl::expected<tactile::Cue, tactile::FormatError>
cue_from_buffer(GstBuffer *buffer, CueForm form, const std::optional<tactile::Grid> &grid);
