// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The report of a failed run.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

/// A log of the steps. Thread-safe.
class Log
{
public:
  void begin(std::uint64_t seed, const std::string &kind, bool verbose);
  void add(const std::string &line);
  void print(const std::string &fault);

private:
  std::mutex mutex_;
  std::uint64_t seed_ = 0;
  std::string kind_;
  bool verbose_ = false;
  std::vector<std::string> lines_;
};

/// The log of this process.
Log &steps();

/// Prints the fault and the steps before it, and ends the process.
[[noreturn]] void accuse(const std::string &fault);

/// With GST_DEBUG, keeps the last lines of each thread and prints them at a fault. All lines would
/// be gigabytes.
void keep_gstreamer_log();
void print_gstreamer_log();
