// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Signals that stop what runs other programs.
#include "film/program.h"

#include <csignal>

#include "support/check_tests.h"

namespace {

const auto kNoLine = [](std::string_view) {
};

bool
is_stopped()
{
  try {
    signals_stop_here();
    return false;
  } catch (const Stopped &) {
    return true;
  }
}

} // namespace

/// Also between two programs, and the next one does not start.
CHECK_TEST(test_stop)
{
  {
    const SignalsStop signals_stop;
    fail_unless(run_program({ "true" }, "coreutils", kNoLine).status == 0);
    fail_unless(!is_stopped());
    raise(SIGTERM);
    fail_unless(is_stopped());
    bool was_thrown = false;
    try {
      run_program({ "true" }, "coreutils", kNoLine);
    } catch (const Stopped &) {
      was_thrown = true;
    }
    fail_unless(was_thrown);
  }
  const SignalsStop again;
  fail_unless(!is_stopped());
}

/// As nohup sets it: in the other program, too.
CHECK_TEST(test_ignored)
{
  const auto before = signal(SIGHUP, SIG_IGN);
  {
    const SignalsStop signals_stop;
    raise(SIGHUP);
    fail_unless(!is_stopped());
    std::string said;
    const ProgramEnd end = run_program({ "sh", "-c", "kill -HUP $$; echo lives" }, "dash",
                                       [&said](std::string_view line) { said.append(line); });
    fail_unless(end.status == 0 && said == "lives");
  }
  fail_unless(signal(SIGHUP, before) == SIG_IGN);
}

CHECK_MAIN(program)
