// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Two devices that play one stream.
#include "support/two_devices.h"

/// Two chairs with different motors.
GST_START_TEST(test_two_chairs)
{
  TwoDevices devices("driver=simulator", "driver=simulator");
  devices.play();
  devices.expect_one_film();
}
GST_END_TEST;

static Suite *
tactorsink_two_suite(void)
{
  Suite *suite = suite_create("tactorsink_two");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_two_chairs);
  return suite;
}

GST_CHECK_MAIN(tactorsink_two);
