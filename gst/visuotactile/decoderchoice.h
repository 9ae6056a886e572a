// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// The input caps of all video decoders but visuotactiledecoder, also behind a parser. Computed
/// once for each state of the registry. Transfer full.
GstCaps *decodable_caps();

/// The video decoder of the highest rank that accepts such a stream and reaches READY: the choice
/// of decodebin without visuotactiledecoder. If none accepts it as it is, a bin of a parser and a
/// decoder. Back in NULL, so that its requests on the way to READY reach the application. With the
/// pads `sink` and `src`; floating. NULL if there is none.
GstElement *choose_decoder(GstCaps *caps);
