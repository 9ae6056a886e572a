// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What is told of a run in which something is wrong.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

/// What was done, for whoever has to find out. Any thread.
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

/// Of this process.
Log &steps();

/// Ends the process with what is wrong and the steps that led there.
[[noreturn]] void accuse(const std::string &fault);

/// With GST_DEBUG: the last of what each thread logged is kept, and printed at a fault. All of it
/// would be gigabytes.
void keep_gstreamer_log();
void print_gstreamer_log();
