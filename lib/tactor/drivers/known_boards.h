// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_port.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tactor {

/// Devices that have answered as tactor boards, and may be probed again without being named; and
/// those that failed a probe. Known by serial number, or by socket if there is none. A
/// file with lines like "0403:6001 serial A50285BI", "1a86:7523 at 1-2" and "not 2341:0042 at 1-3";
/// other lines are ignored, and errors of the file, too. Not thread-safe.
class KnownBoards
{
public:
  /// Least recently used ones beyond this many are dropped.
  static constexpr std::size_t kMost = 64;

  /// An empty path: nothing is stored.
  explicit KnownBoards(std::filesystem::path file);

  /// $XDG_STATE_HOME/visuotactile/boards, by default in ~/.local/state; empty without either.
  static std::filesystem::path default_file();

  bool has(const SerialDevice &device) const;
  bool has_refused(const SerialDevice &device) const;
  void add(const SerialDevice &device);
  void refuse(const SerialDevice &device);

private:
  bool has_line(const std::string &line) const;
  void put(const std::string &line, const std::string &instead);
  std::vector<std::string> read() const;
  void write(const std::vector<std::string> &lines) const;

  const std::filesystem::path file_;
};

} // namespace tactor
