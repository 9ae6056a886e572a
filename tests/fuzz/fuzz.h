// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

/// Ends the process, which is how a fuzzer is told that something broke.
inline void
expect(bool holds)
{
  if (!holds)
    std::abort();
}

/// What is not read is refused with a reason, as a std::runtime_error; whatever else is thrown ends
/// the process.
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

/// The path of a file in memory with these bytes, for readers that open files. It is the same file
/// at every call: making one for each run takes longer than to read it.
inline const std::string &
memory_file(const std::uint8_t *data, std::size_t size)
{
  static const int file = memfd_create("fuzz", MFD_CLOEXEC);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  expect(file >= 0 && ftruncate(file, 0) == 0
         && pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  return path;
}
