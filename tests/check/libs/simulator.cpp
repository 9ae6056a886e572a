// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/simulator.h"

#include "tactor/drivers/registry.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "support/check_tests.h"
#include "support/temporary_file.h"
#include "support/unwrap.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

std::string
read(const std::string &path)
{
  std::ifstream file(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(file), {} };
}

/// A write and its time.
struct Write
{
  Time time;
  std::vector<double> volts;
};

/// The CSV file that these writes must give: a line every 5 ms after a write, up to the next one
/// but for less than a second.
std::string
expected_csv(const std::vector<Write> &writes, std::size_t columns)
{
  std::string text = "time_ns";
  for (std::size_t i = 0; i < columns; i++)
    text += ",tactor_" + std::to_string(i);
  text += '\n';
  std::vector<MotorModel> motors(columns);
  const auto line = [&](Time time) {
    text += std::to_string(time.count());
    for (const MotorModel &motor : motors) {
      char field[32];
      std::snprintf(field, sizeof field, ",%.3f", motor.amplitude(time));
      text += field;
    }
    text += '\n';
  };
  for (std::size_t i = 0; i < writes.size(); i++) {
    const bool anew = i > 0 && writes[i].time < writes[i - 1].time;
    if (anew)
      std::ranges::fill(motors, MotorModel());
    for (int step = 1; i > 0 && !anew && step < 200; step++)
      if (const Time time = writes[i - 1].time + step * 5ms; time < writes[i].time)
        line(time);
    for (std::size_t j = 0; j < columns; j++)
      motors[j].set(writes[i].time, j < writes[i].volts.size() ? writes[i].volts[j] : 0.0);
    line(writes[i].time);
  }
  return text;
}

/// The error of opening the driver with settings that it must refuse.
DriverError
refusal(const DriverConfig &config)
{
  Simulator simulator;
  DriverError error = refusal_of(simulator.open(config));
  fail_unless(simulator.tactors() == 0);
  return error;
}

} // namespace

CHECK_TEST(test_capabilities)
{
  Simulator simulator;
  fail_unless(simulator.tactors() == 0);
  unwrap(simulator.open({}));
  fail_unless(simulator.tactors() == 4096);
  unwrap(simulator.open({ .device = "", .max_tactors = 16 }));
  fail_unless(simulator.tactors() == 16);
  fail_unless(simulator.resolution() == 0);
  fail_unless(simulator.transport_latency() == 0s);
  simulator.close();
  fail_unless(simulator.tactors() == 0);
  simulator.close();
}

CHECK_TEST(test_amplitudes_are_the_motors)
{
  constexpr std::size_t kTactors = 6;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> volts(0.0, 3.0);
  std::uniform_int_distribution<int> pause(0, 150);
  Simulator simulator;
  unwrap(simulator.open({ .device = "", .max_tactors = 6 }));
  std::vector<MotorModel> motors(kTactors);
  Time now = 0s;
  for (int i = 0; i < 500; i++) {
    std::vector<double> levels(kTactors);
    for (std::size_t j = 0; j < kTactors; j++) {
      levels[j] = volts(random);
      motors[j].set(now, levels[j]);
    }
    unwrap(simulator.write(levels, now));
    const Time next = now + pause(random) * 1ms;
    for (const Time time : { now, now + (next - now) / 2, next })
      for (std::size_t j = 0; j < kTactors; j++)
        fail_unless(simulator.amplitude(static_cast<int>(j), time) == motors[j].amplitude(time));
    now = next;
  }
  fail_unless(simulator.amplitude(6, now) == 0);
  fail_unless(simulator.amplitude(-1, now) == 0);
  fail_unless(simulator.amplitude(G_MAXINT, now) == 0);
}

CHECK_TEST(test_fewer_and_more_volts)
{
  Simulator simulator;
  unwrap(simulator.open({ .device = "", .max_tactors = 4 }));
  unwrap(simulator.write(std::vector<double>{ 3.0, 2.0 }, 0s));
  fail_unless(simulator.amplitude(1, 1s) > 1.9);
  fail_unless(simulator.amplitude(2, 1s) == 0);
  // Tactors without a voltage go to zero.
  unwrap(simulator.write(std::vector<double>{ 3.0 }, 1s));
  fail_unless(simulator.amplitude(0, 2s) > 2.9);
  fail_unless(simulator.amplitude(1, 2s) < 1e-9);
  unwrap(simulator.write(std::vector<double>{ 0, 0, 0, 2.0 }, 2s));
  fail_unless(simulator.amplitude(0, 3s) < 1e-9);
  fail_unless(simulator.amplitude(3, 3s) > 1.9);
  // Voltages beyond the board's tactors are ignored.
  unwrap(simulator.write(std::vector<double>{ 1, 1, 1, 1, 3, 3 }, 3s));
  fail_unless(simulator.amplitude(4, 4s) == 0);
}

CHECK_TEST(test_time_that_goes_back)
{
  Simulator simulator;
  unwrap(simulator.open({}));
  unwrap(simulator.write(std::vector<double>{ 3.0 }, 10s));
  fail_unless(simulator.amplitude(0, 11s) > 2.9);
  // Time went back, so motors start from rest.
  unwrap(simulator.write(std::vector<double>{ 2.0 }, 1s));
  MotorModel motor;
  motor.set(1s, 2.0);
  for (Time time = 1s; time < 2s; time += 10ms)
    fail_unless(simulator.amplitude(0, time) == motor.amplitude(time));
}

CHECK_TEST(test_close_leaves_zero)
{
  Simulator simulator;
  unwrap(simulator.open({ .device = "", .max_tactors = 9 }));
  unwrap(simulator.write(std::vector<double>(9, 3.0), 0s));
  simulator.close();
  for (int tactor = 0; tactor < 9; tactor++)
    for (const Time time : { 0s, 1s })
      fail_unless(simulator.amplitude(tactor, time) == 0);
  // Reopening leaves zeros, too.
  unwrap(simulator.open({ .device = "", .max_tactors = 9 }));
  unwrap(simulator.write(std::vector<double>(9, 3.0), 0s));
  unwrap(simulator.open({ .device = "", .max_tactors = 9 }));
  fail_unless(simulator.amplitude(0, 1s) == 0);
}

CHECK_TEST(test_amplitude_file)
{
  const std::vector<Write> writes{ { 0ms, { 3.0, 0, 0.7 } },    { 3ms, { 3.0, 1.0, 0.7 } },
                                   { 3ms, { 2.0, 1.0, 0.7 } },  { 8ms, { 2.0, 1.0, 0.7 } },
                                   { 20ms, { 0, 2.9 } },        { 133'333'333ns, { 0, 0, 0 } },
                                   { 1s, { 1, 1, 1 } },         { 2s, { 1, 1, 2 } },
                                   { 4s, { 0, 3.0, 0 } },       { 500ms, { 1.5 } },
                                   { 600ms, { 1.5, 1.5, 3.0 } } };
  for (const std::size_t tactors : { std::size_t{ 3 }, std::size_t{ 12 } }) {
    const TemporaryFolder folder;
    const std::string path = folder.file("amplitude.csv");
    std::vector<Write> padded = writes;
    // The first write sets the number of columns, which is at least nine.
    padded[0].volts.resize(tactors, 0.0);
    Simulator simulator;
    unwrap(simulator.open({ .device = path, .max_tactors = 64 }));
    for (const Write &write : padded)
      unwrap(simulator.write(write.volts, write.time));
    simulator.close();
    const std::string got = read(path);
    const std::string expected = expected_csv(padded, std::max<std::size_t>(tactors, 9));
    const auto difference = std::ranges::mismatch(got, expected).in1 - got.begin();
    fail_unless(got == expected, "differs from character %d: %s", static_cast<int>(difference),
                got.substr(static_cast<std::size_t>(difference), 80).c_str());
  }
}

CHECK_TEST(test_amplitude_file_without_writes)
{
  const TemporaryFolder folder;
  const std::string path = folder.file("amplitude.csv");
  Simulator simulator;
  unwrap(simulator.open({ .device = path, .max_tactors = 9 }));
  simulator.close();
  fail_unless(std::filesystem::exists(path));
  fail_unless(read(path).empty());
}

CHECK_TEST(test_file_that_cannot_be_written)
{
  const TemporaryFolder folder;
  for (const std::string &path : { folder.file("no/such/folder.csv"), folder.file(".") }) {
    const DriverError error = refusal({ .device = path, .max_tactors = 9 });
    const std::string what = error.text;
    fail_unless(error.kind == DriverError::Kind::settings);
    fail_unless(what.find(path) != std::string::npos, "%s", what.c_str());
    fail_unless(what.find('\n') == std::string::npos);
  }
}

CHECK_TEST(test_full_disk)
{
  if (!std::filesystem::exists("/dev/full"))
    return;
  Simulator simulator;
  unwrap(simulator.open({ .device = "/dev/full", .max_tactors = 9 }));
  // More than any buffer holds
  tl::expected<void, DriverError> written;
  for (int i = 0; i < 100'000 && written; i++)
    written = simulator.write(std::vector<double>(9, 1.0), i * 1ms);
  fail_unless(refusal_of(written).kind == DriverError::Kind::failed);
}

CHECK_TEST(test_number_of_tactors)
{
  for (const int tactors : { 0, -1, 4097, G_MAXINT, G_MININT }) {
    const DriverError error = refusal({ .device = "", .max_tactors = tactors });
    fail_unless(error.kind == DriverError::Kind::settings);
    fail_unless(std::string(error.text).find(std::to_string(tactors)) != std::string::npos);
  }
  // A refused call touches no file.
  const TemporaryFolder folder;
  refusal({ .device = folder.file("untouched.csv"), .max_tactors = 0 });
  fail_if(std::filesystem::exists(folder.file("untouched.csv")));
}

CHECK_TEST(test_list_of_drivers)
{
  fail_unless(!drivers().empty());
  fail_unless(drivers()[0].name == "auto");
  for (const DriverInfo &info : drivers()) {
    fail_unless(!info.description.empty());
    const auto driver = unwrap(make_driver(info.name));
    fail_unless(driver != nullptr);
    fail_unless(driver->tactors() == 0);
  }
  fail_unless(dynamic_cast<Simulator *>(unwrap(make_driver("simulator")).get()) != nullptr);

  for (const char *name : { "pianola", "", "Simulator" }) {
    const auto &[kind, what] = refusal_of(make_driver(name));
    fail_unless(kind == DriverError::Kind::not_found);
    fail_unless(what.find(std::string("\"") + name + "\"") != std::string::npos);
    for (const DriverInfo &info : drivers())
      fail_unless(what.find(std::string(info.name)) != std::string::npos);
  }
}

CHECK_MAIN(simulator)
