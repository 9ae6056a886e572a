// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/csv_writer.h"

#include "files/regular_file.h"

#include <array>
#include <charconv>
#include <unistd.h>

namespace tactor {

CsvWriter::CsvWriter(std::FILE *file) : file_(file)
{
}

tl::expected<CsvWriter, DriverError>
CsvWriter::create(const std::string &path)
{
  tl::expected<files::File, files::Error> file = files::create(path);
  if (!file)
    return tl::unexpected(DriverError{ DriverError::Kind::settings,
                                       "cannot write to '" + path + "': " + file.error().reason });
  const int fd = file->release();
  std::FILE *stream = fdopen(fd, "w");
  if (stream == nullptr) {
    close(fd);
    return tl::unexpected(DriverError{ DriverError::Kind::settings,
                                       "cannot write to '" + path + "': out of memory" });
  }
  return CsvWriter(stream);
}

CsvWriter &
CsvWriter::field(std::string_view text)
{
  if (!line_.empty())
    line_ += ',';
  line_ += text;
  return *this;
}

CsvWriter &
CsvWriter::field(std::int64_t value)
{
  std::array<char, 24> text;
  const auto end = std::to_chars(text.begin(), text.end(), value).ptr;
  return field(std::string_view(text.begin(), end));
}

CsvWriter &
CsvWriter::field(double value)
{
  std::array<char, 400> text;
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed, 3).ptr;
  return field(std::string_view(text.begin(), end));
}

void
CsvWriter::end_line()
{
  line_ += '\n';
  failed_ |= std::fwrite(line_.data(), 1, line_.size(), file_.get()) != line_.size();
  line_.clear();
}

void
CsvWriter::flush()
{
  failed_ |= std::fflush(file_.get()) != 0;
}

bool
CsvWriter::failed() const
{
  return failed_;
}

} // namespace tactor
