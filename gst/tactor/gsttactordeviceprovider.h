// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/gamepads.h"
#include "tactor/serial/serial_port.h"

#include <gst/gst.h>

#include <functional>
#include <vector>

G_BEGIN_DECLS

/// start() and stop() run on the application's thread, under GstDeviceProvider's start lock. While
/// started, a thread of the provider has the bus.
#define GST_TYPE_TACTOR_DEVICE_PROVIDER (gst_tactor_device_provider_get_type())
G_DECLARE_FINAL_TYPE(GstTactorDeviceProvider, gst_tactor_device_provider, GST,
                     TACTOR_DEVICE_PROVIDER, GstDeviceProvider)

GST_DEVICE_PROVIDER_REGISTER_DECLARE(tactordeviceprovider);

G_END_DECLS

using ListGamepads = std::function<std::vector<tactor::Gamepad>()>;

/// A provider with another bus and other gamepads than those of the computer, for tests. It looks
/// for gamepads every `look_again`.
GstDeviceProvider *gst_tactor_device_provider_new(tactor::MakeSerialBus make_bus,
                                                  ListGamepads list_gamepads = {},
                                                  tactor::Time look_again = {});
