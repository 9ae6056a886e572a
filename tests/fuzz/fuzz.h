// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

/// Aborts if the condition is false, which the fuzzer reports.
inline void
expect(bool holds)
{
  if (!holds)
    std::abort();
}

/// Accepts std::runtime_error with a reason. Any other exception ends the process.
template <typename Read>
void
read_or_refuse(const Read &read)
{
  try {
    read();
  } catch (const std::runtime_error &error) {
    expect(error.what()[0] != '\0');
  }
}

/// Writes the bytes to a memfd and returns its path, for readers that open files. All calls share
/// one file, because creating one takes longer than reading it.
inline const std::string &
memory_file(const std::uint8_t *data, std::size_t size)
{
  static const int file = memfd_create("fuzz", MFD_CLOEXEC);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  expect(file >= 0 && ftruncate(file, 0) == 0
         && pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  return path;
}
