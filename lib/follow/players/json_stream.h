// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace follow {

/// Bytes of a stream → its JSON objects, between which nothing has to lie. Braces alone separate
/// them: an object may still be wrong inside. Not thread-safe.
class JsonStream
{
public:
  static constexpr std::size_t kLongest = 65'536; ///< bytes of an object

  /// False if there is something else than an object, or a longer one: nothing more can be read.
  [[nodiscard]] bool add(std::string_view bytes);

  /// The next whole object.
  std::optional<std::string> next();

private:
  /// Whether the object is whole with this character.
  bool ends(char c);

  std::string bytes_;     ///< from the beginning of an object on
  std::size_t known_ = 0; ///< so many of them are looked at
  std::size_t depth_ = 0; ///< open braces
  bool in_string_ = false;
  bool is_escaped_ = false; ///< the next character means nothing
};

} // namespace follow
