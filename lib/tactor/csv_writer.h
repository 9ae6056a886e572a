// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"

#include <tl/expected.hpp>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace tactor {

/// Writes a CSV file, in the same form in every locale. Buffered until flush().
class CsvWriter
{
public:
  /// Creates or truncates the file. The error (settings) names it and the reason.
  [[nodiscard]] static tl::expected<CsvWriter, DriverError> create(const std::string &path);

  CsvWriter &field(std::int64_t value);
  /// With three decimals.
  CsvWriter &field(double value);
  CsvWriter &field(std::string_view text);
  void end_line();

  void flush();
  /// Whether a write failed, as on a full disk.
  bool failed() const;

private:
  struct Close
  {
    void operator()(std::FILE *file) const
    {
      std::fclose(file);
    }
  };

  explicit CsvWriter(std::FILE *file);

  std::unique_ptr<std::FILE, Close> file_;
  std::string line_;
  bool failed_ = false;
};

} // namespace tactor
