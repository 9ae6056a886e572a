// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/region_weights.h"

#include "text.h"

#include <algorithm>

namespace saliency {

using visuotactile::trimmed;

namespace {

using Error = tl::unexpected<std::string>;

tl::expected<double, std::string>
parse_weight(std::string_view text)
{
  const auto weight = visuotactile::read_number<double>(text);
  if (!weight || !(*weight >= 0 && *weight <= RegionWeights::kMax)) // also rejects NaN
    return Error("expected a weight from 0 to 10, got '" + std::string(text) + "'");
  return *weight;
}

} // namespace

tl::expected<RegionWeights, std::string>
RegionWeights::parse(std::string_view text)
{
  RegionWeights result;
  result.text_ = text;
  if (trimmed(text).empty())
    return result;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    const std::string_view item = trimmed(text.substr(0, comma));
    more = comma != std::string_view::npos;
    text = more ? text.substr(comma + 1) : std::string_view();

    const std::size_t equals = item.find('=');
    const std::string type(trimmed(item.substr(0, equals)));
    if (equals == std::string_view::npos || type.empty())
      return Error("expected type=weight, got '" + std::string(item) + "'");
    if (std::ranges::find(result.weights_, type, &Weight::type) != result.weights_.end())
      return Error("expected each type once, got '" + type + "' twice");
    if (result.weights_.size() == kMaxTypes)
      return Error("expected at most 64 types, got more");
    const tl::expected<double, std::string> weight = parse_weight(trimmed(item.substr(equals + 1)));
    if (!weight)
      return Error(weight.error());
    result.weights_.push_back({ type, *weight });
  }
  return result;
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
