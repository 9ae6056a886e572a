// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/channel_cells.h"

#include <gst/audio/audio.h>

#include <optional>
#include <string>

#define SYNTH_CAPS                                                                                 \
  "audio/x-raw, format = (string) " GST_AUDIO_NE(F32) ", layout = (string) interleaved, rate = "   \
                                                      "(int) [ 8000, 192000 ], channels = (int) "  \
                                                      "[ 1, 64 ]"

/// The format that downstream accepts, nearest to 48 kHz and so many channels. More than two have
/// no positions unless downstream names them. None if it accepts nothing of SYNTH_CAPS.
std::optional<GstAudioInfo> synth_negotiate(GstPad *pad, gint channels);

/// The cells of each channel, by its position if it has one.
synth::ChannelCells synth_cells(const GstAudioInfo &info, guint rows, guint columns);

/// A line for users: which cells a channel plays.
std::string synth_describe(const synth::ChannelCells &cells);
