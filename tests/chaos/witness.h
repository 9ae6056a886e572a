// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What the chair was asked for and what it did, seen from both ends of tactorsink: maps as it takes
// them, voltages as they reach the driver. The drivers of a program with this file are the real
// ones, on boards in memory, each in the hands of the witness.
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
  /// Called with what is wrong; the process is not to go on afterwards.
  std::function<void(const std::string &)> accuse;

  /// Watches a tactorsink from its READY state on, at most one at a time.
  void watch(GstElement *tactors);

  /// Tactors that cells may be mapped to, in any of the mappings of the run; empty: only cell i to
  /// tactor i.
  void set_mappings(std::vector<std::vector<int>> mappings);

  /// Every motor is at zero, as far as the driver was told, now.
  void expect_silence(const std::string &when);

  /// Whether what the motors were told is what the maps in force at this running time ask for, or
  /// zero; `reason` says why not.
  bool agrees_with_film(gint64 running, std::string &reason);

  /// Whether the boards' motors are what the driver was told, or stand; `reason` says why not.
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

  // Of the driver in use, on its caller's thread.
  void opened();
  void closed();
  void wrote(std::span<const double> volts, tactor::Time now);

  // Of the sink, on the streaming thread.
  void arrived(GstBaseSink *sink, GstBuffer *buffer);
  void flushed();
  void took_caps(const GstCaps *caps);

private:
  /// A map that came since the last flush.
  struct Map
  {
    gint64 start; ///< running time
    gint64 end;
    std::vector<bool> on; ///< of each cell
  };

  bool is_asked_for(const Map &map, std::size_t tactor) const;

  mutable std::mutex mutex_;
  std::vector<std::vector<int>> mappings_;
  std::deque<Map> maps_;
  gsize cells_ = 9;
  bool is_open_ = false;
  std::vector<double> volts_;
  static constexpr gint64 kNever = G_MININT64;
  gint64 latest_ = kNever; ///< running time of a write since the last flush
  guint64 map_count_ = 0;
  guint64 write_count_ = 0;
  guint64 vibration_count_ = 0;
  guint64 flush_count_ = 0;
};

/// The witness of this process.
Witness &witness();
