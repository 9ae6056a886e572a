// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// What all video decoders but visuotactiledecoder take, also those behind a parser. Computed once
/// for each state of the registry. Transfer full.
GstCaps *decodable_caps();

/// The video decoder of the highest rank that takes such a stream and reaches READY: what decodebin
/// would take without visuotactiledecoder. Where none takes it as it is, a bin of a parser and a
/// decoder. Back in NULL, so that what it asks the application for on its way to READY reaches the
/// application. With the pads `sink` and `src`; floating. NULL if there is none.
GstElement *choose_decoder(GstCaps *caps);
