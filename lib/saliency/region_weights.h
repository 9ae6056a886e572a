// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace saliency {

/// Weights of region types: saliency in regions of a type is multiplied by its weight; 0
/// suppresses, 1 changes nothing. Written as `face=3,logo=0,*=0.5`, where `*` is any other type.
class RegionWeights
{
public:
  static constexpr double kMax = 10;
  static constexpr std::size_t kMaxTypes = 64;
  static constexpr std::string_view kAnyOther = "*";

  /// All types weigh 1.
  RegionWeights() = default;

  /// Parses at most kMaxTypes pairs of a type, any characters but ',' and '=', and a decimal number
  /// in [0, kMax], each type once. Spaces around them are ignored; an empty text is no pairs. An
  /// error states what was expected and what was found.
  static tl::expected<RegionWeights, std::string> parse(std::string_view text);

  /// The weight of a type: its own, else that of `*`, else 1.
  double of(std::string_view type) const;

  /// The text that was parsed.
  const std::string &text() const
  {
    return text_;
  }

private:
  struct Weight
  {
    std::string type;
    double weight;
  };
  std::string text_;
  std::vector<Weight> weights_;
};

} // namespace saliency
