// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output.h"

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <unistd.h>

namespace fs = std::filesystem;

Output::Output(const fs::path &directory, const std::string &name)
    : final_(directory / name),
      part_(directory / ("." + name + "." + std::to_string(getpid()) + ".part"))
{
  std::error_code error;
  if (fs::is_directory(final_, error))
    throw std::runtime_error("'" + final_.string()
                             + "' is a folder; move it away or give another --output");
}

Output::~Output()
{
  std::error_code ignored;
  fs::remove(part_, ignored);
}

bool
Output::commit()
{
  std::error_code error;
  if (fs::file_size(part_, error) == 0 || error)
    return false;
  fs::rename(part_, final_, error);
  if (error)
    throw std::runtime_error("cannot write '" + final_.string() + "': " + error.message());
  return true;
}

void
prepare_directory(const fs::path &directory)
{
  std::error_code error;
  fs::create_directories(directory, error);
  if (error)
    throw std::runtime_error("cannot make the folder '" + directory.string()
                             + "': " + error.message());
  if (!fs::is_directory(directory, error))
    throw std::runtime_error("'" + directory.string()
                             + "' is not a folder; expected one for --output");
  if (access(directory.c_str(), W_OK) != 0)
    throw std::runtime_error("cannot write to the folder '" + directory.string()
                             + "': " + std::generic_category().message(errno));
}
