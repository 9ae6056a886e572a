// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace follow {

/// Splits a stream into its lines. Not thread-safe.
class LineBuffer
{
public:
  static constexpr std::size_t kLongestLine = 65'536;

  /// False if a line is longer than kLongestLine: nothing more can be read.
  [[nodiscard]] bool add(std::string_view bytes);

  /// The next whole line, without its end.
  std::optional<std::string> next();

private:
  std::string bytes_;
};

} // namespace follow
