// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Observes both ends of tactorsink: the maps that it receives, and the voltages that reach the
// driver. Programs with this file have the real drivers, on boards in memory, each wrapped by the
// witness.
#pragma once

#include "support/boards/memory_bus.h"

#include <gst/base/gstbasesink.h>

#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

class Witness
{
public:
  /// Called with a fault. It must not return.
  std::function<void(const std::string &)> accuse;

  /// Watches a tactorsink from READY on. At most one at a time.
  void watch(GstElement *tactors);

  /// The tactors of each cell, for every mapping of the run. If empty, cell i is tactor i.
  void set_mappings(std::vector<std::vector<int>> mappings);

  /// Fails unless the driver's last voltages are zero.
  void expect_silence(const std::string &when);

  /// Whether the voltages are those of the maps in force at this running time, or zero. If not,
  /// sets `reason`.
  bool agrees_with_film(gint64 running, std::string &reason);

  /// Whether the boards' motors have the driver's voltages, or are off. If not, sets `reason`.
  bool boards_agree(std::string &reason);

  guint64 maps() const;
  guint64 writes() const;
  guint64 vibrations() const; ///< writes with a motor on
  guint64 flushes() const;

  Sockets sockets;
  MemoryBoard mega{ { .serial = "mega", .bus_path = "1-1", .name = "Mega", .transport = "memory" },
                    kMega };
  MemoryBoard seat{ { .serial = "seat", .bus_path = "1-2", .name = "Seat", .transport = "memory" },
                    kMega,
                    true };

  // Called by the driver, from its caller's thread.
  void opened();
  void closed();
  void wrote(std::span<const double> volts, tactor::Time now);

  // Called by the sink, from the streaming thread.
  void arrived(GstBaseSink *sink, GstBuffer *buffer);
  void flushed();
  void took_caps(const GstCaps *caps);

private:
  /// A map since the last flush.
  struct Map
  {
    gint64 start; ///< running time
    gint64 end;
    std::vector<bool> on; ///< by cell
  };

  bool is_asked_for(const Map &map, std::size_t tactor) const;

  mutable std::mutex mutex_;
  std::vector<std::vector<int>> mappings_;
  std::deque<Map> maps_;
  gsize cells_ = 9;
  bool is_open_ = false;
  std::vector<double> volts_;
  static constexpr gint64 kNever = G_MININT64;
  gint64 latest_ = kNever; ///< running time of the last write since the last flush
  guint64 map_count_ = 0;
  guint64 write_count_ = 0;
  guint64 vibration_count_ = 0;
  guint64 flush_count_ = 0;
};

/// The witness of this process.
Witness &witness();
