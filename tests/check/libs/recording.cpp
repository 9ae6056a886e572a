// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/recording.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "support/temporary_file.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace tactor;

namespace {

void
expect_refusal(const std::string &text, const std::string &says)
{
  const TemporaryFile file(text);
  const tl::expected<Recording, std::string> read = read_csv_recording(file.path);
  const std::string got = read ? "nothing" : read.error();
  fail_unless(got.find(says) != std::string::npos, "'%s' instead of '%s'", got.c_str(),
              says.c_str());
}

} // namespace

CHECK_TEST(exports_are_read)
{
  for (const char *text :
       { "time_s,left,right\n-0.5,1,2\n0,3,4\n0.5,5,6\n1,7,8\n",
         "Vibrometer "
         "export\r\n\"Time\"\t\"a\"\t\"b\"\r\n-0.5\t1\t2\r\n0\t3\t4\r\n0.5\t5\t6\r\n1\t7\t8\r\n",
         "-0.5; +1; 2\n0; 3; 4\n\n0.5; 5; 6\n1; 7; 8" }) {
    const TemporaryFile file(text);
    const Recording recording = *read_csv_recording(file.path);
    fail_unless_near(recording.rate, 2, 1e-9);
    fail_unless(recording.start == std::chrono::milliseconds(-500));
    fail_unless(recording.channels.size() == 2 && recording.size() == 4);
    for (int i = 0; i < 4; i++) {
      fail_unless_near(recording.channels[0][static_cast<std::size_t>(i)], 1 + 2 * i, 1e-9);
      fail_unless_near(recording.channels[1][static_cast<std::size_t>(i)], 2 + 2 * i, 1e-9);
    }
  }
}

// The rate of a phone's accelerometer varies. On a ramp the value is the time.
CHECK_TEST(uneven_times_become_even)
{
  std::string text;
  for (int i = 0; i <= 100; i++) {
    const double time = 0.01 * i + (i > 0 && i < 100 ? 0.004 * std::sin(i) : 0);
    text += std::to_string(time) + "," + std::to_string(5 * time) + "\n";
  }
  const TemporaryFile file(text);
  const Recording recording = *read_csv_recording(file.path);
  fail_unless_near(recording.rate, 100, 1e-6);
  for (std::size_t i = 0; i <= 100; i++)
    fail_unless_near(recording.channels[0][i], 0.05 * static_cast<double>(i), 1e-4);
}

CHECK_TEST(damaged_files_are_refused_with_the_line)
{
  expect_refusal("", "found 0");
  expect_refusal("0,1\n", "found 1");
  expect_refusal("0\n1\n", "line 1");
  expect_refusal("0,1\n1\n", "line 2");
  expect_refusal("0,1\n1,2,3\n", "line 2");
  expect_refusal("0,1\n1,x\n", "'x'");
  expect_refusal("0,1\n1,nan\n", "'nan'");
  expect_refusal("nan,1\n0,1\n1,2\n", "line 1: expected a number, got 'nan'");
  expect_refusal("time,a\n-inf,1\n1,2\n", "'-inf'");
  expect_refusal("0,1\n1e999,2\n1,2\n", "'1e999'");
  expect_refusal("0,1\n0,2\n", "expected a time after");
  expect_refusal("0,1\n1e6,2\n", "expected a time within");
  expect_refusal("0,1\n1e-300,2\n", "samples a second");
  expect_refusal("0,1\n1,1e300\n", "'1e300'");
  expect_refusal("0,1\n" + std::string(100'000, '1') + "\n", "line 2: expected a line of at most");
}

CHECK_TEST(channels_go_to_tactors_where_there_are_enough)
{
  Recording recording{ .channels = { {}, {}, {} } };
  fail_unless(recording.channel_of(2, 3) == 2);
  fail_unless(recording.channel_of(2, 4) == 0);
  fail_unless(recording.channel_of(0, 1) == 0);
}

CHECK_MAIN(recording)
