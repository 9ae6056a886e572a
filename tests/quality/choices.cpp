// SPDX-License-Identifier: LGPL-2.1-or-later
#include "choices.h"

#include "saliency/profile.h"
#include "tactile/tactile_mapping.h"

namespace quality {

namespace {

using saliency::Profile;
using tactile::MappingSettings;

template <typename Change>
Choice
choice(std::string parameter, std::string value, Change change)
{
  Profile profile = Profile::tuned();
  MappingSettings mapping = MappingSettings::tuned();
  change(profile, mapping);
  return { parameter, value, [=] {
            return std::make_unique<AnalyzerModel>(parameter + " " + value, profile, mapping);
          } };
}

} // namespace

std::vector<Choice>
choices()
{
  using P = Profile;
  using M = MappingSettings;
  std::vector<Choice> all;
  const auto add = [&](const char *parameter, const char *value, auto change) {
    all.push_back(choice(parameter, value, change));
  };
  add("tuned", "", [](P &, M &) {});
  add("reference_width", "110", [](P &p, M &) { p.reference_width = 110; });
  add("reference_width", "440", [](P &p, M &) { p.reference_width = 440; });
  add("chroma_weight", "1", [](P &p, M &) { p.chroma_weight = 1; });
  add("chroma_octaves", "0", [](P &p, M &) { p.chroma_octaves = 0; });
  add("saliency_level", "3", [](P &p, M &) { p.saliency_level = 3; });
  add("saliency_level", "5", [](P &p, M &) { p.saliency_level = 5; });
  add("cut_share", "1 (never)", [](P &p, M &) { p.cut_share = 1; });
  add("cut_share", "0.3", [](P &p, M &) { p.cut_share = 0.3; });
  add("floor", "0.4", [](P &, M &m) { m.floor = 0.4; });
  add("floor", "1.6", [](P &, M &m) { m.floor = 1.6; });
  add("center_weight", "0", [](P &, M &m) { m.center_weight = 0; });
  add("threshold", "0", [](P &, M &m) { m.threshold = 0; });
  add("order", "threshold_first", [](P &, M &m) { m.order = tactile::Order::threshold_first; });
  add("order, binary", "threshold_first, on", [](P &, M &m) {
    m.order = tactile::Order::threshold_first;
    m.binary = true;
  });
  add("prefilter_sigma", "1/3 cell", [](P &, M &m) { m.prefilter_sigma = 1.0 / 3; });
  return all;
}

} // namespace quality
