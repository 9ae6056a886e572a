// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/priority_mutex.h"
#include "tactorgrid.h"
#include "tactoropening.h"
#include "tactorscheduler.h"
#include "tactorsettings.h"
#include "tactorstream.h"
#include "tactortiming.h"

#include <gst/base/gstbasesink.h>

#include <atomic>
#include <optional>

/// The output of tactorsink from READY to READY: board, trace and the scheduler, opened anew for
/// each play. Their events are posted on the sink's bus.
class TactorSession
{
public:
  /// The sink is not owned: the session is a part of it.
  explicit TactorSession(GstBaseSink *sink);

  /// Begins to open board and trace and sets the sink's render-delay. False after an error message
  /// if the settings are wrong. Faults of the board are posted as error messages later.
  bool open(const TactorSettings &settings);
  /// All motors are at zero and the board is released. Harmless when not open.
  void close();

  /// Waits until the board is open. On the streaming thread with the preroll lock held. It is
  /// released meanwhile, as in the base class: pause, flush and stop need it.
  GstFlowReturn wait_until_open();
  /// Streaming thread only, when the board is open.
  OpenTactors &tactors();
  /// Whether a map of a live play was over before the board was open. If a map continues, `shown`
  /// becomes the rest. Always false from the first such map on, and where the board was open before
  /// the play began. Streaming thread only.
  bool is_missed(TactorStream::Span &shown);

  /// Posts a message, at most every 5 s, if commands were late since the last call. Streaming
  /// thread only.
  void tell_short_lead();

  TactorTiming read_timing() const;
  /// Vibration is this much later.
  void set_delay(tactor::Time delay);
  /// To be called when latency or ts-offset has changed.
  void timing_changed();

  const TactorGrid &grid() const;

  TactorScheduler &scheduler();

private:
  TactorTiming glance_at_timing() const;
  bool agree_on_lead();
  std::optional<GstClockTime> opening_time();
  void device_event(const tactor::DriverEvent &event);

  GstBaseSink *sink_;
  GstElement *element_; ///< the sink
  /// Set by the scheduler's thread when the board is open, then used by the streaming thread.
  std::optional<OpenTactors> tactors_;
  /// Clock time at which the board became open; in a live play until a frame is shown.
  std::optional<GstClockTime> opened_;
  // The timing as read last, by any thread.
  mutable std::atomic<guint64> readings_{ 0 };
  mutable tactor::PriorityMutex
      timing_mutex_; ///< guards these three, and is held for no other lock
  mutable guint64 reading_ = 0;
  mutable TactorTiming timing_{ nullptr, 0 };
  mutable GstClockTimeDiff delay_ = 0; ///< latency + ts-offset + the user's
  std::atomic<GstClockTimeDiff> users_delay_{ 0 };
  TactorGrid grid_;
  std::optional<tactor::Time> last_lead_short_; ///< streaming thread only
  TactorScheduler scheduler_; ///< last: its thread, which uses the others, ends first
};
