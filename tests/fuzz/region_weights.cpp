// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes weights of regions (saliencytactile's roi-weights): weights that parse are 0 to 10 for
// every region. Other input is refused with a reason.
#include "saliency/region_weights.h"

#include "fuzz.h"

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const std::string_view text(reinterpret_cast<const char *>(data), size);
  const auto weights = saliency::RegionWeights::parse(text);
  if (!weights) {
    expect(!weights.error().empty());
    return 0;
  }
  expect(weights->text() == text);
  for (const std::string_view type : { text.substr(0, text.find('=')), text, {} }) {
    const double weight = weights->of(type);
    expect(weight >= 0 && weight <= saliency::RegionWeights::kMax);
  }
  return 0;
}
