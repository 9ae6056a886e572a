// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/wave_file.h"

#include "support/contains.h"
#include "support/tolerance.h"
#include "support/unwrap.h"

#include <cstdint>
#include <random>
#include <vector>

#include "support/check_tests.h"

using namespace synth;

namespace {

using Data = std::vector<std::byte>;

void
put(Data &data, std::uint32_t value, int size)
{
  for (int i = 0; i < size; i++)
    data.push_back(static_cast<std::byte>(value >> (8 * i)));
}

void
put(Data &data, const char *name)
{
  for (; *name; name++)
    data.push_back(static_cast<std::byte>(*name));
}

/// As the RIFF WAVE specification has it, with a chunk before the sound that is not read.
Data
wave_file(unsigned kind, unsigned channels, std::uint32_t rate, unsigned bits,
          const std::vector<std::uint32_t> &samples)
{
  Data data;
  put(data, "RIFF");
  put(data, 0, 4);
  put(data, "WAVEfmt ");
  put(data, 16, 4);
  put(data, kind, 2);
  put(data, channels, 2);
  put(data, rate, 4);
  put(data, rate * channels * bits / 8, 4);
  put(data, channels * bits / 8, 2);
  put(data, bits, 2);
  put(data, "LIST");
  put(data, 3, 4);
  put(data, 0x00abcdef, 4); // padded
  put(data, "data");
  put(data, static_cast<std::uint32_t>(samples.size()) * bits / 8, 4);
  for (const std::uint32_t sample : samples)
    put(data, sample, static_cast<int>(bits / 8));
  return data;
}

std::string
refusal(const Data &data)
{
  return refusal_of(parse_wave_file(data));
}

} // namespace

CHECK_TEST(test_integers)
{
  const auto wave
      = unwrap(parse_wave_file(wave_file(1, 1, 8000, 16, { 0, 0x4000, 0x8000, 0xc000 })));
  fail_unless((wave->samples == std::vector<float>{ 0, 0.5F, -1, -0.5F, 0 }));
  fail_unless_near(wave->frequency, 2000, 1e-9);
}

CHECK_TEST(test_floats)
{
  // 0.25, 2 and no number
  const auto wave
      = unwrap(parse_wave_file(wave_file(3, 1, 48000, 32, { 0x3e800000, 0x40000000, 0x7fc00000 })));
  fail_unless((wave->samples == std::vector<float>{ 0.25F, 1, 0, 0.25F }));
  fail_unless_near(wave->frequency, 16000, 1e-9);
}

CHECK_TEST(test_refused)
{
  const std::vector<std::uint32_t> few = { 1, 2, 3, 4 };
  assert_contains(refusal({}), { "expected a RIFF WAVE file" });
  assert_contains(refusal(wave_file(1, 2, 8000, 16, few)), { "expected one channel, got 2" });
  assert_contains(refusal(wave_file(1, 1, 8000, 24, few)), { "got 24 bits of format 1" });
  assert_contains(refusal(wave_file(3, 1, 8000, 16, few)), { "got 16 bits of format 3" });
  assert_contains(refusal(wave_file(1, 1, 999, 16, few)), { "1000 to 192000 Hz, got 999" });
  assert_contains(refusal(wave_file(1, 1, 8000, 16, { 1 })), { "2 to 80000 samples, got 1" });
  assert_contains(refusal(wave_file(1, 1, 1000, 16, std::vector<std::uint32_t>(10001))),
                  { "2 to 10000 samples, got 10001" });
  Data no_sound = wave_file(1, 1, 8000, 16, few);
  no_sound.resize(no_sound.size() - 16);
  assert_contains(refusal(no_sound), { "'fmt ' and 'data'" });
}

CHECK_TEST(test_hostile)
{
  // Cut off anywhere, and with any byte changed: an error or a wave, and no sample beyond 1.
  const Data whole = wave_file(1, 1, 8000, 16, { 0, 0x4000, 0x8000, 0xc000 });
  for (std::size_t size = 0; size < whole.size(); size++)
    (void)parse_wave_file(std::span(whole).first(size));
  std::mt19937 any(1);
  for (int i = 0; i < 100000; i++) {
    Data data = whole;
    for (int times = 0; times < 3; times++)
      data[any() % data.size()] = static_cast<std::byte>(any());
    if (const auto wave = parse_wave_file(data))
      for (const float sample : (*wave)->samples)
        fail_unless(sample >= -1 && sample <= 1);
  }
}

CHECK_TEST(test_files)
{
  assert_contains(refusal_of(read_wave_file("/nonexistent/loop.wav")),
                  { "cannot read the loop '/nonexistent/loop.wav': No such file" });
  assert_contains(refusal_of(read_wave_file("/")),
                  { "cannot read the loop '/': expected a regular file, got a folder" });
  assert_contains(refusal_of(read_wave_file("/dev/zero")), { "got a device" });
}

CHECK_MAIN(wave_file)
