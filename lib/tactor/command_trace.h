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

/// The commands of a play as a CSV file: a header line, then a line for each command with
/// `issued_ns,due_ns,effect_ns,tactor,volts`. Running times are in nanoseconds, due is effect −
/// lead, volts have three decimals. Not thread-safe.
class CommandTrace
{
public:
  /// Creates the file. The error (settings) names it and the reason.
  [[nodiscard]] static tl::expected<CommandTrace, DriverError> create(const std::string &path);

  void write(const IssuedCommand &issued);
  void flush();
  /// Whether a write failed, as on a full disk.
  bool failed() const;

private:
  explicit CommandTrace(CsvWriter csv);

  CsvWriter csv_;
};

/// Reads what CommandTrace wrote. The error names file and line and what was expected there; more
/// than 10 million commands are an error.
[[nodiscard]] tl::expected<std::vector<IssuedCommand>, std::string>
read_command_trace(const std::string &path);

} // namespace tactor
