// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_scores.h"

#include <string>
#include <vector>

namespace quality {

/// The tuned profile with one choice made otherwise.
struct Choice
{
  std::string parameter; ///< of saliency::Profile or tactile::MappingSettings
  std::string value;     ///< instead of the tuned one
  ModelMaker model;
};

/// The tuned profile itself first, then the parameters of the film's analysis, each at the paper's
/// value, or off where the paper has nothing like it, and at values to either side.
std::vector<Choice> choices();

} // namespace quality
