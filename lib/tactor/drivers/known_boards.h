// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_port.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tactor {

/// Adapters behind which a tactor board has answered: which of the many things that have such a
/// chip may be asked again without being named. By serial number, or by socket where there is none.
/// A file of lines as "0403:6001 serial A50285BI" and "1a86:7523 at 1-2"; what else is in it is
/// ignored, and where it cannot be read or written, nothing is remembered. Not thread-safe.
class KnownBoards
{
public:
  /// The last so many are remembered.
  static constexpr std::size_t kMost = 64;

  /// An empty path: nothing is remembered.
  explicit KnownBoards(std::filesystem::path file);

  /// $XDG_STATE_HOME/visuotactile/boards, by default in ~/.local/state; empty where there is
  /// neither.
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
