/* SPDX-License-Identifier: LGPL-2.1-or-later */
#ifndef __GST_TACTILE_PRELUDE_H__
#define __GST_TACTILE_PRELUDE_H__

#include <gst/gst.h>

#ifndef GST_TACTILE_API
#ifdef BUILDING_GST_TACTILE
#define GST_TACTILE_API GST_API_EXPORT
#else
#define GST_TACTILE_API GST_API_IMPORT
#endif
#endif

#endif /* __GST_TACTILE_PRELUDE_H__ */
