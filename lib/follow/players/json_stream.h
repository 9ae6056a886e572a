// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace follow {

/// Splits a stream into its JSON objects, with nothing between them. Only braces are counted: an
/// object may be invalid inside. Not thread-safe.
class JsonStream
{
public:
  static constexpr std::size_t kLongest = 65'536; ///< bytes of an object

  /// False if another thing than an object comes, or a longer object: the stream cannot be read on.
  [[nodiscard]] bool add(std::string_view bytes);

  /// The next whole object.
  std::optional<std::string> next();

private:
  /// Whether the object is complete with this character.
  bool ends(char c);

  std::string bytes_;     ///< from the beginning of an object on
  std::size_t known_ = 0; ///< number of bytes that were read
  std::size_t depth_ = 0; ///< open braces
  bool in_string_ = false;
  bool is_escaped_ = false; ///< the next character is escaped
};

} // namespace follow
