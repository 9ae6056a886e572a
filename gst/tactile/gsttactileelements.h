// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

GST_ELEMENT_REGISTER_DECLARE(tactilecombiner);
GST_ELEMENT_REGISTER_DECLARE(tactileconverter);
GST_ELEMENT_REGISTER_DECLARE(tactileextractor);
GST_ELEMENT_REGISTER_DECLARE(tactileklvdec);
GST_ELEMENT_REGISTER_DECLARE(tactileoverlay);
GST_ELEMENT_REGISTER_DECLARE(tactilesubtitles);
GST_ELEMENT_REGISTER_DECLARE(tactiletestsrc);

G_END_DECLS
