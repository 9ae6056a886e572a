// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command.h"
#include "tactor/csv_writer.h"

#include <string>
#include <vector>

namespace tactor {

/// A command and when it was handed to the driver.
struct IssuedCommand
{
  Command command;
  Time issued{ 0 }; ///< running time

  bool operator==(const IssuedCommand &) const = default;
};

/// The commands of a play as a CSV file: a header line, then
/// `issued_ns,due_ns,effect_ns,tactor,volts` a command, running times in nanoseconds, due = effect
/// − lead, volts with three decimals. Not thread-safe: its owner guards it.
class CommandTrace
{
public:
  /// Creates the file. DriverError (settings) has its name and the reason.
  [[nodiscard]] static tl::expected<CommandTrace, DriverError> create(const std::string &path);

  void write(const IssuedCommand &issued);
  void flush();
  /// Whether anything could not be written, as on a full disk.
  bool failed() const;

private:
  explicit CommandTrace(CsvWriter csv);

  CsvWriter csv_;
};

/// Reads what CommandTrace wrote, or says with file and line what was expected and what came; a
/// file of more than 10 million commands is refused.
[[nodiscard]] tl::expected<std::vector<IssuedCommand>, std::string>
read_command_trace(const std::string &path);

} // namespace tactor
