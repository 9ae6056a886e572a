// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/base/gstpushsrc.h>

G_BEGIN_DECLS

#define GST_TYPE_TACTILE_SOUND_TEST_SRC (gst_tactile_sound_test_src_get_type())
G_DECLARE_FINAL_TYPE(GstTactileSoundTestSrc, gst_tactile_sound_test_src, GST,
                     TACTILE_SOUND_TEST_SRC, GstPushSrc)

G_END_DECLS
