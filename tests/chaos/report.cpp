// SPDX-License-Identifier: LGPL-2.1-or-later
#include "report.h"

#include <cstdio>
#include <cstdlib>
#include <gst/gst.h>

void
Log::begin(std::uint64_t seed, const std::string &kind, bool verbose)
{
  std::lock_guard lock(mutex_);
  seed_ = seed;
  kind_ = kind;
  verbose_ = verbose;
  lines_.clear();
}

void
Log::add(const std::string &line)
{
  std::lock_guard lock(mutex_);
  lines_.push_back(line);
  if (verbose_)
    std::fprintf(stderr, "%4zu %s\n", lines_.size(), line.c_str());
}

void
Log::print(const std::string &fault)
{
  std::lock_guard lock(mutex_);
  if (!verbose_)
    for (std::size_t i = 0; i < lines_.size(); i++)
      std::fprintf(stderr, "%4zu %s\n", i + 1, lines_[i].c_str());
  std::fprintf(stderr, "FAULT: %s\nagain: chaos --kind=%s --seed=%llu --steps=%zu\n", fault.c_str(),
               kind_.c_str(), static_cast<unsigned long long>(seed_), lines_.size());
}

Log &
steps()
{
  static Log the;
  return the;
}

void
accuse(const std::string &fault)
{
  steps().print(fault);
  print_gstreamer_log();
  std::_Exit(1);
}

void
keep_gstreamer_log()
{
  if (!g_getenv("GST_DEBUG"))
    return;
  gst_debug_remove_log_function(gst_debug_log_default);
  gst_debug_add_ring_buffer_logger(1 << 20, 0);
}

void
print_gstreamer_log()
{
  if (!g_getenv("GST_DEBUG"))
    return;
  g_auto(GStrv) logs = gst_debug_ring_buffer_logger_get_logs();
  for (gchar **log = logs; log && *log; log++)
    std::fprintf(stderr, "==== log of a thread\n%s", *log);
}
