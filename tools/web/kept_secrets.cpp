// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kept_secrets.h"

#include "guard.h"

#include "files/whole_file.h"

#include <filesystem>
#include <stdexcept>
#include <sys/stat.h>

namespace fs = std::filesystem;

std::string
write_private_file(const std::string &path, const std::string &text)
{
  const mode_t mask = umask(077);
  auto written = files::replace_file(path, text);
  umask(mask);
  if (!written)
    throw std::runtime_error(std::move(written).error());
  return *std::move(written);
}

std::vector<std::string>
kept_secrets(const std::string &file, std::size_t count)
{
  constexpr std::size_t kDigits = 32;
  const std::size_t bytes = count * (kDigits + 1) - 1; // with line breaks between them
  std::vector<std::string> secrets;
  const auto kept = files::read_whole(file, bytes);
  std::error_code error;
  const bool is_private
      = (fs::status(file, error).permissions() & (fs::perms::group_all | fs::perms::others_all))
        == fs::perms::none;
  if (kept && kept->size() == bytes && is_private && !error)
    for (std::size_t i = 0; i < count; i++) {
      const std::string secret = kept->substr(i * (kDigits + 1), kDigits);
      if (secret.find_first_not_of("0123456789abcdef") == std::string::npos)
        secrets.push_back(secret);
    }
  if (secrets.size() == count)
    return secrets;
  fs::remove(file, error); // a new file has new permissions
  std::string text;
  secrets.clear();
  for (std::size_t i = 0; i < count; i++) {
    secrets.push_back(random_token());
    text += secrets.back() + (i + 1 < count ? "\n" : "");
  }
  write_private_file(file, text);
  return secrets;
}
