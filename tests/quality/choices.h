// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_scores.h"

#include <string>
#include <vector>

namespace quality {

/// The tuned profile with one parameter changed.
struct Choice
{
  std::string parameter; ///< of saliency::Profile or tactile::MappingSettings
  std::string value;     ///< instead of the tuned one
  ModelMaker model;
};

/// The tuned profile, then each parameter of the analysis at the paper's value (or off if the paper
/// has none) and at values above and below.
std::vector<Choice> choices();

} // namespace quality
