/* SPDX-License-Identifier: LGPL-2.1-or-later */
#ifndef __GST_TACTILE_H__
#define __GST_TACTILE_H__

#include <gst/tactile/gstsaliencymeta.h>
#include <gst/tactile/gsttactilecaps.h>
#include <gst/tactile/gsttactilemeta.h>
#include <gst/tactile/tactile-prelude.h>

#endif /* __GST_TACTILE_H__ */
