// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_trace.h"

#include "files/regular_file.h"

#include <charconv>
#include <sstream>
#include <string_view>
#include <utility>

namespace tactor {

namespace {

constexpr std::string_view kHeader = "issued_ns,due_ns,effect_ns,tactor,volts";
constexpr std::size_t kMaxCommands = 10'000'000;
constexpr std::size_t kMaxBytes = std::size_t{ 1 } << 30;
constexpr int kLastTactor = 4095;
constexpr double kMostVolts = 1000; // fifty times the volts of any motor
constexpr std::streamsize kMaxLine = 200;

/// Takes the next field off a line. False if it is no number, or no comma follows; after the last
/// one, the end.
template <typename Number>
bool
take(std::string_view &line, Number &number, bool last = false)
{
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc())
    return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  if (last)
    return line.empty();
  if (line.empty() || line.front() != ',')
    return false;
  line.remove_prefix(1);
  return true;
}

bool
parse(std::string_view line, IssuedCommand &issued)
{
  std::int64_t at = 0;
  std::int64_t due = 0;
  std::int64_t effect = 0;
  if (!take(line, at) || !take(line, due) || !take(line, effect)
      || !take(line, issued.command.tactor) || !take(line, issued.command.volts, true))
    return false;
  constexpr std::int64_t kLongest = 1'000'000'000'000'000'000;
  const auto sane = [](std::int64_t time) {
    return time >= -kLongest && time <= kLongest;
  };
  if (!sane(at) || !sane(due) || !sane(effect) || due > effect || issued.command.tactor < 0
      || issued.command.tactor > kLastTactor
      || !(issued.command.volts >= 0 && issued.command.volts <= kMostVolts))
    return false;
  issued.issued = Time(at);
  issued.command.effect = Time(effect);
  issued.command.lead = Time(effect - due);
  return true;
}

} // namespace

tl::expected<CommandTrace, DriverError>
CommandTrace::create(const std::string &path)
{
  tl::expected<CsvWriter, DriverError> csv = CsvWriter::create(path);
  if (!csv)
    return tl::unexpected(csv.error());
  return CommandTrace(std::move(*csv));
}

CommandTrace::CommandTrace(CsvWriter csv) : csv_(std::move(csv))
{
  csv_.field(kHeader).end_line();
}

void
CommandTrace::write(const IssuedCommand &issued)
{
  csv_.field(issued.issued.count())
      .field(issued.command.due().count())
      .field(issued.command.effect.count())
      .field(std::int64_t{ issued.command.tactor })
      .field(issued.command.volts)
      .end_line();
}

void
CommandTrace::flush()
{
  csv_.flush();
}

bool
CommandTrace::failed() const
{
  return csv_.failed();
}

tl::expected<std::vector<IssuedCommand>, std::string>
read_command_trace(const std::string &path)
{
  tl::expected<std::string, files::Error> text = files::read(path, kMaxBytes);
  if (!text)
    return tl::unexpected("cannot read '" + path + "': " + text.error().reason);

  std::istringstream file(*std::move(text));
  std::vector<IssuedCommand> commands;
  std::vector<char> buffer(static_cast<std::size_t>(kMaxLine));
  for (std::size_t number = 1;; number++) {
    file.getline(buffer.data(), kMaxLine);
    const std::streamsize length = file.gcount() - (file.eof() ? 0 : 1);
    const auto failure = [&](const std::string &why) {
      return tl::unexpected(path + ", line " + std::to_string(number) + ": " + why);
    };
    if (number > 1 && file.eof() && length == 0)
      return commands;
    if (file.eof())
      return failure("it ends in the middle of a line");
    if (!file)
      return failure("longer than a command can be");
    const std::string_view line(buffer.data(), static_cast<std::size_t>(length));
    if (number == 1) {
      if (line != kHeader)
        return failure("expected the header '" + std::string(kHeader) + "'");
      continue;
    }
    IssuedCommand issued;
    if (!parse(line, issued))
      return failure("expected " + std::string(kHeader) + " with due not after effect, got '"
                     + std::string(line.data()) + "'");
    if (commands.size() == kMaxCommands)
      return failure("more commands than the " + std::to_string(kMaxCommands) + " that are read");
    commands.push_back(issued);
  }
}

} // namespace tactor
