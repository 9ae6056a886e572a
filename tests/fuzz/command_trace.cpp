// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes command traces: commands that parse survive a round trip and have valid voltages and
// times. Other input is refused with a std::runtime_error.
#include "tactor/command_trace.h"
#include "tools/film/or_throw.h"

#include "fuzz.h"

#include <vector>

using namespace tactor;

namespace {

void
check(const std::string &path)
{
  const std::vector<IssuedCommand> commands = or_throw(read_command_trace(path));
  const std::string name = "/dev/shm/trace-fuzz-" + std::to_string(getpid());
  {
    CommandTrace trace = or_throw(CommandTrace::create(name));
    for (const IssuedCommand &issued : commands) {
      expect(issued.command.tactor >= 0 && issued.command.tactor < 4096);
      expect(issued.command.volts >= 0 && issued.command.volts <= 1000);
      expect(issued.command.lead >= Time(0) && issued.command.due() <= issued.command.effect);
      trace.write(issued);
    }
    trace.flush();
    expect(!trace.failed());
  }
  const std::vector<IssuedCommand> again = or_throw(read_command_trace(name));
  unlink(name.c_str());
  expect(again.size() == commands.size());
  for (std::size_t i = 0; i < again.size(); i++)
    expect(again[i].issued == commands[i].issued
           && again[i].command.due() == commands[i].command.due()
           && again[i].command.effect == commands[i].command.effect
           && again[i].command.tactor == commands[i].command.tactor);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  read_or_refuse([&] { check(memory_file(data, size)); });
  return 0;
}
