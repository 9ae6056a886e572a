// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_port.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tactor {

/// Adapters behind which a tactor board has answered, and which may be asked again without being
/// named. Known by serial number, or by socket if there is none. A file with lines like
/// "0403:6001 serial A50285BI" and "1a86:7523 at 1-2"; other lines are ignored, and errors of the
/// file, too. Not thread-safe.
class KnownBoards
{
public:
  /// Least recently used ones beyond this many are dropped.
  static constexpr std::size_t kMost = 64;

  /// An empty path: nothing is remembered.
  explicit KnownBoards(std::filesystem::path file);

  /// $XDG_STATE_HOME/visuotactile/boards, by default in ~/.local/state; empty without either.
  static std::filesystem::path default_file();

  bool has(const SerialDevice &device) const;
  void add(const SerialDevice &device);
  void remove(const SerialDevice &device);

private:
  std::vector<std::string> read() const;
  void write(const std::vector<std::string> &lines) const;

  const std::filesystem::path file_;
};

} // namespace tactor
