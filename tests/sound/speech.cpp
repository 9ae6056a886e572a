// SPDX-License-Identifier: LGPL-2.1-or-later
#include "speech.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

namespace judged {

Speech
read_speech(const char *name)
{
  std::ifstream file(name, std::ios::binary);
  const std::string bytes{ std::istreambuf_iterator<char>(file), {} };
  const std::size_t data = bytes.find("data");
  Speech speech;
  if (data == std::string::npos || data < 36)
    return speech;
  std::uint32_t rate = 0;
  std::memcpy(&rate, &bytes[24], sizeof rate);
  speech.rate = static_cast<int>(rate);
  double power = 0;
  for (std::size_t at = data + 8; at + 2 <= bytes.size(); at += 2) {
    std::int16_t sample = 0;
    std::memcpy(&sample, &bytes[at], sizeof sample);
    speech.samples.push_back(static_cast<float>(sample) / 32768);
    power
        += static_cast<double>(speech.samples.back()) * static_cast<double>(speech.samples.back());
  }
  const double factor = 0.1 / std::sqrt(power / static_cast<double>(speech.samples.size()));
  for (float &sample : speech.samples)
    sample *= static_cast<float>(factor);
  return speech;
}

} // namespace judged
