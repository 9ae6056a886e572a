// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/mapping.h"

#include "text.h"

namespace tactor {

using visuotactile::trimmed;

tl::expected<std::vector<int>, DriverError>
read_mapping(std::string_view text, int tactors)
{
  std::string_view rest = trimmed(text);
  if (rest.starts_with('<') && rest.ends_with('>') && rest.size() >= 2)
    rest = trimmed(rest.substr(1, rest.size() - 2));
  std::vector<int> mapping;
  while (!rest.empty() || !mapping.empty()) {
    const std::size_t comma = rest.find(',');
    const std::string_view word = trimmed(rest.substr(0, comma));
    const auto tactor = visuotactile::read_number<int>(word);
    if (!tactor || *tactor < -1 || *tactor >= tactors)
      return tl::unexpected(DriverError{
          DriverError::Kind::settings,
          "number " + std::to_string(mapping.size() + 1) + " is '" + std::string(word)
              + "'; expected a tactor for each cell, row by row, from 0 to "
              + std::to_string(tactors - 1) + ", or -1 for none, with commas, as in 2,1,0" });
    mapping.push_back(*tactor);
    if (comma == std::string_view::npos)
      break;
    rest = rest.substr(comma + 1);
  }
  return mapping;
}

std::string
write_mapping(std::span<const int> mapping)
{
  std::string text;
  for (const int tactor : mapping)
    text += (text.empty() ? "" : ",") + std::to_string(tactor);
  return text;
}

} // namespace tactor
