// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/legible.h"

#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using tactor::legible;

namespace {

void
expect(const std::string &text, const std::string &wanted)
{
  const std::string got = legible(text);
  fail_unless_equals_string(got.c_str(), wanted.c_str());
}

std::string
times(int count, const std::string &text)
{
  std::string all;
  for (int i = 0; i < count; i++)
    all += text;
  return all;
}

} // namespace

CHECK_TEST(test_plain_names)
{
  expect("Arduino Uno", "Arduino Uno");
  expect("Grüße, 振動", "Grüße, 振動");
  expect(" \t Uno\n", "Uno");
  expect("", "");
  expect(" ", "");
}

CHECK_TEST(test_unprintable_characters)
{
  expect("a\033[2Jb", "a\ufffd[2Jb");
  expect("a\xc2\x9b"
         "b",
         "a\ufffd\ufffd"
         "b");                                  // a control character of two bytes
  expect("\xed\xa0\x80", "\ufffd\ufffd\ufffd"); // a single UTF-16 surrogate
  expect("\xf4\x90\x80\x80", "\ufffd\ufffd\ufffd\ufffd");
  expect("\xe6\x8c", "\ufffd\ufffd");
}

CHECK_TEST(test_long_names)
{
  expect(times(200, "ü"), times(126, "ü"));
  // A space that would come last after the cut is removed.
  expect(times(200, "a "), times(62, "a ") + "a");
}

CHECK_MAIN(legible)
