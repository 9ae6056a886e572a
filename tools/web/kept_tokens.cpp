// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kept_tokens.h"

#include "guard.h"

#include "files/whole_file.h"
#include "translation.h"

#include <sys/stat.h>
#include <unistd.h>

namespace {

constexpr std::size_t kDigits = 32;

/// Whether others than the user can neither read nor have written it.
bool
is_private(const files::File &file)
{
  struct stat status = {};
  return fstat(file.descriptor(), &status) == 0 && status.st_uid == geteuid()
         && (status.st_mode & (S_IRWXG | S_IRWXO)) == 0;
}

/// Lines of hexadecimal digits; empty: the file is another one.
std::vector<std::string>
tokens_of(const std::string &path, std::size_t count)
{
  const auto file = files::open_regular(path);
  if (!file || !is_private(*file))
    return {};
  auto text = files::read_whole(*file, path, count * (kDigits + 1));
  if (text && text->size() == count * (kDigits + 1) - 1)
    *text += '\n'; // of an earlier version
  if (!text || text->size() != count * (kDigits + 1))
    return {};
  std::vector<std::string> tokens;
  for (std::size_t at = 0; at < text->size(); at += kDigits + 1) {
    tokens.push_back(text->substr(at, kDigits));
    if (tokens.back().find_first_not_of("0123456789abcdef") != std::string::npos
        || (*text)[at + kDigits] != '\n')
      return {};
  }
  return tokens;
}

} // namespace

tl::expected<std::vector<std::string>, std::string>
kept_tokens(const std::string &file, std::size_t count)
{
  std::vector<std::string> tokens = tokens_of(file, count);
  if (!tokens.empty())
    return tokens;
  std::string text;
  for (std::size_t i = 0; i < count; i++)
    text += tokens.emplace_back(random_token()) + "\n";
  if (const auto written = files::replace_file(file, text, files::Readers::user); !written)
    return tl::unexpected(written.error());
  if (const auto own = files::open_regular(file); own && is_private(*own))
    return tokens;
  unlink(file.c_str());
  return tl::unexpected(
      in_text("others can read '{}', as its file system has no permissions", file));
}
