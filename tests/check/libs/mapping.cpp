// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/mapping.h"

#include "support/contains.h"

#include "support/check_tests.h"

using tactor::read_mapping;
using tactor::write_mapping;

CHECK_TEST(test_forms)
{
  const std::vector<int> mirrored{ 2, 1, 0, -1 };
  for (const char *text : { "2,1,0,-1", "<2,1,0,-1>", "< 2, 1, 0, -1 >", " 2 ,\t1,0,-1\n" })
    fail_unless(read_mapping(text, 3) == mirrored, "%s", text);
  for (const char *text : { "", " ", "<>", "< >" })
    fail_unless(read_mapping(text, 3) == std::vector<int>{}, "'%s'", text);
  assert_text(write_mapping(mirrored), "2,1,0,-1");
  assert_text(write_mapping({}), "");
}

CHECK_TEST(test_refused)
{
  const auto refused = [](const char *text, const char *word) {
    const auto mapping = read_mapping(text, 12);
    fail_if(mapping.has_value(), "%s", text);
    assert_contains(mapping.error().text, { word, "from 0 to 11", "-1", "commas", "2,1,0" });
  };
  refused("2;1;0", "number 1 is '2;1;0'");
  refused("2 1 0", "number 1 is '2 1 0'");
  refused("{2,1}", "number 1 is '{2'");
  refused("<2,1", "number 1 is '<2'");
  refused("2,1,", "number 3 is ''");
  refused("2,,1", "number 2 is ''");
  refused(",", "number 1 is ''");
  refused("0,12", "number 2 is '12'");
  refused("0,1,-2", "number 3 is '-2'");
  refused("1.5", "number 1 is '1.5'");
  refused("99999999999", "number 1 is '99999999999'");
  refused("left", "number 1 is 'left'");
}

CHECK_MAIN(mapping)
