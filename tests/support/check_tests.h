// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/check/gstcheck.h>

#include <vector>

/// Tests that register themselves with libcheck: CHECK_TEST(test_name) { … }, and CHECK_MAIN(name)
/// once.
namespace check_tests {

struct Test
{
  const char *name;
  TFun run;
  int begin; ///< the test runs with each __i__ in [begin, end)
  int end;
};

inline std::vector<Test> &
all()
{
  static std::vector<Test> tests;
  return tests;
}

inline bool
add(const Test &test)
{
  all().push_back(test);
  return true;
}

/// Runs the tests of `file`, each for `timeout` s at most; 0: for ever, -1: as long as libcheck
/// allows. Requires gst_check_init(). Returns the number of failures.
inline int
run(const char *name, const char *file, int timeout = -1)
{
  Suite *suite = suite_create(name);
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  if (timeout >= 0)
    tcase_set_timeout(cases, timeout);
  for (const Test &test : all())
    _tcase_add_test(cases, test.run, test.name, 0, 0, test.begin, test.end);
  return gst_check_run_suite(suite, name, file);
}

} // namespace check_tests

/// A test that runs once for each __i__ from `from` up to `to`, not included.
#define CHECK_LOOP_TEST(name, from, to)                                                            \
  static void G_PASTE(name, _body)(int);                                                           \
  static void name(int i)                                                                          \
  {                                                                                                \
    GST_DO_CHECK_TEST_ENVIRONMENT;                                                                 \
    tcase_fn_start(#name, __FILE__, __LINE__);                                                     \
    G_PASTE(name, _body)(i);                                                                       \
    gst_task_cleanup_all();                                                                        \
  }                                                                                                \
  static const bool G_PASTE(name, _is_added)                                                       \
      = check_tests::add({ #name, name, static_cast<int>(from), static_cast<int>(to) });           \
  static void G_PASTE(name, _body)(G_GNUC_UNUSED int __i__)

#define CHECK_TEST(name) CHECK_LOOP_TEST(name, 0, 1)

/// The program: a statement, then run().
#define CHECK_MAIN_AFTER(name, timeout, statement)                                                 \
  int main(int argc, char **argv)                                                                  \
  {                                                                                                \
    gst_check_init(&argc, &argv);                                                                  \
    statement;                                                                                     \
    return check_tests::run(#name, __FILE__, timeout);                                             \
  }
#define CHECK_MAIN_TIMEOUT(name, timeout) CHECK_MAIN_AFTER(name, timeout, )
#define CHECK_MAIN(name) CHECK_MAIN_TIMEOUT(name, -1)
