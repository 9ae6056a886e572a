// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorurihandler.h"

#include <gst/gst.h>

namespace {

constexpr const gchar *kProtocol = "tactor";

GstURIType
get_type(GType)
{
  return GST_URI_SINK;
}

const gchar *const *
get_protocols(GType)
{
  static const gchar *const protocols[] = { kProtocol, nullptr };
  return protocols;
}

/// NULL for drivers that have no boards.
gchar *
get_uri(GstURIHandler *handler)
{
  g_autofree gchar *driver = nullptr;
  g_autofree gchar *device = nullptr;
  g_object_get(handler, "driver", &driver, "device", &device, nullptr);
  return g_strcmp0(driver, "firmata") == 0 ? gst_uri_construct(kProtocol, device ? device : "")
                                           : nullptr;
}

gboolean
set_uri(GstURIHandler *handler, const gchar *uri, GError **error)
{
  if (GST_STATE(handler) > GST_STATE_READY || GST_STATE_NEXT(handler) > GST_STATE_READY) {
    g_set_error(error, GST_URI_ERROR, GST_URI_ERROR_BAD_STATE,
                "the board cannot be changed while it is played on; expected READY or NULL");
    return FALSE;
  }
  g_autofree gchar *device = gst_uri_get_location(uri);
  // Not driver=auto, which stands for "a board or none".
  g_object_set(handler, "driver", "firmata", "device", device && *device ? device : nullptr,
               nullptr);
  return TRUE;
}

} // namespace

void
tactor_uri_handler_init(gpointer interface, gpointer)
{
  auto *handler = static_cast<GstURIHandlerInterface *>(interface);
  handler->get_type = get_type;
  handler->get_protocols = get_protocols;
  handler->get_uri = get_uri;
  handler->set_uri = set_uri;
}
