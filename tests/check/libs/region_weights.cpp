// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/region_weights.h"

#include "support/tolerance.h"

#include <string>

#include "support/check_tests.h"

using saliency::RegionWeights;

namespace {

std::string
refusal(const std::string &text)
{
  const tl::expected<RegionWeights, std::string> weights = RegionWeights::parse(text);
  fail_if(weights.has_value(), "'%s' is accepted", text.c_str());
  return weights.error();
}

bool
has(const std::string &text, const char *part)
{
  return text.find(part) != std::string::npos;
}

} // namespace

CHECK_TEST(test_weights)
{
  const RegionWeights weights = *RegionWeights::parse("face=3,logo=0");
  fail_unless(weights.of("face") == 3 && weights.of("logo") == 0 && weights.of("car") == 1);
  fail_unless(weights.of("") == 1 && weights.of("fac") == 1 && weights.of("faces") == 1);
  fail_unless(weights.text() == "face=3,logo=0");

  const RegionWeights spaced = *RegionWeights::parse(" face = 0.25 ,\ttactile-target=1e1, *=.5 ");
  fail_unless(spaced.of("face") == 0.25 && spaced.of("tactile-target") == 10);
  fail_unless(spaced.of("anything") == 0.5 && spaced.of("") == 0.5);
  fail_unless(spaced.text() == " face = 0.25 ,\ttactile-target=1e1, *=.5 ");

  // A type may be any text.
  const RegionWeights odd = *RegionWeights::parse("a b=2,visage é=4,*=0,10=1");
  fail_unless(odd.of("a b") == 2 && odd.of("visage é") == 4 && odd.of("10") == 1);
  fail_unless(odd.of("a  b") == 0);

  for (const char *none : { "", "  ", "\n" })
    fail_unless(RegionWeights::parse(none)->of("face") == 1);
  fail_unless(RegionWeights().of("face") == 1);
}

/// Errors name what was expected and what was found.
CHECK_TEST(test_refusals)
{
  for (const char *text : { "face", "face=3,logo", ",", "face=3,", ",face=3", "face=3,,logo=0",
                            "=3", " =3", "face:3", "face=3;logo" }) {
    const std::string error = refusal(text);
    fail_unless(has(error, "expected type=weight") || has(error, "expected a weight"), "%s",
                error.c_str());
  }
  for (const char *number : { "", "-1", "-0.001", "10.001", "1e9", "nan", "inf", "0x1", "3a", "3 4",
                              "+3", "three", "=3", "1,5x" }) {
    const std::string error = refusal("face=" + std::string(number));
    fail_unless(has(error, "expected"), "%s", error.c_str());
  }
  fail_unless(has(refusal("face=11"), "0 to 10, got '11'"));
  fail_unless(has(refusal("face=1,face=1"), "'face' twice"));
  fail_unless(has(refusal("*=1, * =2"), "'*' twice"));

  std::string many;
  for (int i = 0; i < 64; ++i)
    many += (i ? ",t" : "t") + std::to_string(i) + "=2";
  fail_unless(RegionWeights::parse(many)->of("t63") == 2);
  fail_unless(has(refusal(many + ",one=2"), "at most 64"));
}

CHECK_MAIN(region_weights)
