// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_trace.h"

#include <clocale>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <random>
#include <string>
#include <vector>

#include "support/check_tests.h"
#include "support/temporary_file.h"
#include "support/unwrap.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

const std::string kHeader = "issued_ns,due_ns,effect_ns,tactor,volts\n";

/// A file in a folder of its own.
class TraceFile
{
public:
  const std::string &folder() const
  {
    return folder_.path;
  }
  std::string path() const
  {
    return folder_.file("commands.csv");
  }
  std::string read() const
  {
    std::ifstream file(path(), std::ios::binary);
    return { std::istreambuf_iterator<char>(file), {} };
  }
  void write(const std::string &text) const
  {
    std::ofstream(path(), std::ios::binary) << text;
  }

private:
  TemporaryFolder folder_;
};

IssuedCommand
issued(Time at, Time effect, Time lead, int tactor, double volts)
{
  return { .command = { .effect = effect, .lead = lead, .tactor = tactor, .volts = volts },
           .issued = at };
}

/// The error of read_command_trace() for a file that it must refuse.
std::string
complaint(const std::string &path)
{
  return refusal_of(read_command_trace(path));
}

bool
contains(const std::string &text, const std::string &part)
{
  return text.find(part) != std::string::npos;
}

/// Number formatting that must never get into a CSV file: 1.234.567,5.
class Commas : public std::numpunct<char>
{
  char do_decimal_point() const override
  {
    return ',';
  }
  char do_thousands_sep() const override
  {
    return '.';
  }
  std::string do_grouping() const override
  {
    return "\3";
  }
};

} // namespace

CHECK_TEST(test_exact_text)
{
  // In a German locale, where installed, and in a C++ locale with commas.
  setlocale(LC_ALL, "de_DE.UTF-8");
  const std::locale before = std::locale::global(std::locale(std::locale(), new Commas));
  const TraceFile file;
  {
    CommandTrace trace = unwrap(CommandTrace::create(file.path()));
    trace.write(issued(1'234'567'891ns, 1'300'000'000ns, 65'785'000ns, 0, 1.5));
    trace.write(issued(0s, 0s, 0s, 15, 0));
    trace.write(issued(-5ns, 10ns, 30ns, 4095, 2.9996));
    trace.write(issued(100h, 100h, 150ms, 3, 0.5124));
    trace.flush();
    fail_if(trace.failed());
  }
  const std::vector<IssuedCommand> read = unwrap(read_command_trace(file.path()));
  std::locale::global(before);
  setlocale(LC_ALL, "C");
  const std::string expected = kHeader
                               + "1234567891,1234215000,1300000000,0,1.500\n"
                                 "0,0,0,15,0.000\n"
                                 "-5,-20,10,4095,3.000\n"
                                 "360000000000000,359999850000000,360000000000000,3,0.512\n";
  fail_unless(file.read() == expected, "%s", file.read().c_str());
  fail_unless(read.size() == 4);
  fail_unless(read[0] == issued(1'234'567'891ns, 1'300'000'000ns, 65'785'000ns, 0, 1.5));
}

CHECK_TEST(test_round_trip)
{
  std::mt19937_64 random(1);
  std::uniform_int_distribution<Time::rep> time(-Time(1min).count(), Time(24h).count());
  std::uniform_int_distribution<Time::rep> lead(0, Time(180ms).count());
  std::uniform_int_distribution<int> tactor(0, 4095);
  std::uniform_int_distribution<int> millivolts(0, 30000);
  std::vector<IssuedCommand> commands;
  for (int i = 0; i < 20'000; i++)
    commands.push_back(issued(Time(time(random)), Time(time(random)), Time(lead(random)),
                              tactor(random), millivolts(random) / 1000.0));
  const TraceFile file;
  CommandTrace trace = unwrap(CommandTrace::create(file.path()));
  for (const IssuedCommand &command : commands)
    trace.write(command);
  trace.flush();
  fail_if(trace.failed());
  fail_unless(unwrap(read_command_trace(file.path())) == commands);
}

CHECK_TEST(test_no_commands)
{
  const TraceFile file;
  file.write("something else");
  unwrap(CommandTrace::create(file.path())).flush();
  fail_unless(file.read() == kHeader);
  fail_unless(unwrap(read_command_trace(file.path())).empty());
}

CHECK_TEST(test_missing_file)
{
  const TraceFile file;
  const std::string what = complaint(file.path());
  fail_unless(contains(what, file.path()), "%s", what.c_str());
  // A folder is refused.
  fail_unless(contains(complaint(file.folder()), file.folder()));
}

CHECK_TEST(test_hostile_files)
{
  struct Case
  {
    std::string text;
    int line;
  };
  const std::string good = "1,2,3,4,0.5\n";
  const Case cases[] = {
    { "", 1 },
    { "\n", 1 },
    { good, 1 },
    { "issued_ns,due_ns,effect_ns,tactor\n" + good, 1 },
    { "issued_ns,due_ns,effect_ns,tactor,volts,more\n" + good, 1 },
    { "issued_ns,due_ns,effect_ns,tactor,volts\r\n" + good, 1 },
    { "issued_ns,due_ns,effect_ns,tactor,volts", 1 }, // truncated
    { std::string(1000, 'x'), 1 },
    { std::string(10'000'000, '1') + "\n", 1 },
    { std::string("\0\0\0", 3), 1 },
    { kHeader + "\n", 2 },
    { kHeader + "1,2,3,4\n", 2 },
    { kHeader + good + "1,2,3\n", 3 },
    { kHeader + good + good + "1,2,3,4,\n", 4 },
    { kHeader + "1,2,3,4,0.5,6\n", 2 },
    { kHeader + "1,2,3,4,0.5 \n", 2 },
    { kHeader + " 1,2,3,4,0.5\n", 2 },
    { kHeader + "1,2,3,4,0,5\n", 2 },
    { kHeader + "1;2;3;4;0.5\n", 2 },
    { kHeader + "1,2,3,x,0.5\n", 2 },
    { kHeader + "one,2,3,4,0.5\n", 2 },
    { kHeader + "1,2,3,4,volts\n", 2 },
    { kHeader + "1.5,2,3,4,0.5\n", 2 },
    { kHeader + "1,2,3,4,0.5\r\n", 2 },
    { kHeader + std::string("1,2,3,4,0.5\0,and more\n", 22), 2 },
    { kHeader + good + "1,2,3,4," + std::string(10'000'000, '1') + "\n", 3 },
    { kHeader + "1,2,3,-1,0.5\n", 2 },
    { kHeader + "1,2,3,4096,0.5\n", 2 },
    { kHeader + "1,2,3,99999999999,0.5\n", 2 },
    { kHeader + "1,4,3,4,0.5\n", 2 }, // due after effect
    { kHeader + "1,2,3,4,nan\n", 2 },
    { kHeader + "1,2,3,4,inf\n", 2 },
    { kHeader + "1,2,3,4,1e999\n", 2 },
    { kHeader + "1,2,3,4,-0.5\n", 2 },
    { kHeader + "nan,2,3,4,0.5\n", 2 },
    { kHeader + "10000000000000000000,2,3,4,0.5\n", 2 }, // 10¹⁹
    { kHeader + "1,2,10000000000000000000,4,0.5\n", 2 },
    { kHeader + "1,-9223372036854775808,9223372036854775807,4,0.5\n", 2 },
    { kHeader + good + "1,2,3,4,0.5", 3 }, // truncated
  };
  const TraceFile file;
  for (const Case &c : cases) {
    file.write(c.text);
    const std::string what = complaint(file.path());
    fail_unless(contains(what, file.path() + ", line " + std::to_string(c.line) + ":"), "'%s': %s",
                c.text.substr(0, 100).c_str(), what.c_str());
    fail_unless(what.size() < file.path().size() + 400 && !contains(what, "\n"));
  }
}

CHECK_TEST(test_file_that_cannot_be_written)
{
  const TraceFile file;
  for (const std::string &path : { file.folder() + "/no/such/commands.csv", file.folder() }) {
    const DriverError error = refusal_of(CommandTrace::create(path));
    fail_unless(error.kind == DriverError::Kind::settings);
    fail_unless(contains(error.text, path), "%s", error.text.c_str());
  }
}

CHECK_TEST(test_full_disk)
{
  if (!std::filesystem::exists("/dev/full"))
    return;
  CommandTrace trace = unwrap(CommandTrace::create("/dev/full"));
  trace.write(issued(1ns, 2ns, 1ns, 0, 1));
  trace.flush();
  fail_unless(trace.failed());
  // The error persists, and commands are still accepted.
  for (int i = 0; i < 10'000; i++)
    trace.write(issued(1ns, 2ns, 1ns, 0, 1));
  fail_unless(trace.failed());
  // Without flush() the error shows once the buffer is full.
  CommandTrace unflushed = unwrap(CommandTrace::create("/dev/full"));
  for (int i = 0; i < 10'000; i++)
    unflushed.write(issued(1ns, 2ns, 1ns, 0, 1));
  fail_unless(unflushed.failed());
}

CHECK_MAIN(command_trace)
