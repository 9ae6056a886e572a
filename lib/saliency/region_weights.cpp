// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/region_weights.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace saliency {

namespace {

std::string_view
trimmed(std::string_view text)
{
  constexpr std::string_view kSpace = " \t\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos)
    return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

double
parse_weight(std::string_view text)
{
  double weight = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), weight);
  // Not a number is not within either.
  if (error != std::errc() || end != text.data() + text.size()
      || !(weight >= 0 && weight <= RegionWeights::kMax))
    throw std::invalid_argument("expected a weight from 0 to 10, got '" + std::string(text) + "'");
  return weight;
}

} // namespace

RegionWeights::RegionWeights(std::string_view text) : text_(text)
{
  if (trimmed(text).empty())
    return;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    const std::string_view item = trimmed(text.substr(0, comma));
    more = comma != std::string_view::npos;
    text = more ? text.substr(comma + 1) : std::string_view();

    const std::size_t equals = item.find('=');
    const std::string type(trimmed(item.substr(0, equals)));
    if (equals == std::string_view::npos || type.empty())
      throw std::invalid_argument("expected type=weight, got '" + std::string(item) + "'");
    if (std::ranges::find(weights_, type, &Weight::type) != weights_.end())
      throw std::invalid_argument("expected each type once, got '" + type + "' twice");
    if (weights_.size() == kMaxTypes)
      throw std::invalid_argument("expected at most 64 types, got more");
    weights_.push_back({ type, parse_weight(trimmed(item.substr(equals + 1))) });
  }
}

double
RegionWeights::of(std::string_view type) const
{
  auto found = std::ranges::find(weights_, type, &Weight::type);
  if (found == weights_.end())
    found = std::ranges::find(weights_, kAnyOther, &Weight::type);
  return found == weights_.end() ? 1.0 : found->weight;
}

} // namespace saliency
