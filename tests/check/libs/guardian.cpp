// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How a guardian is started and told. A script stands for it; tests/usb/killed.cpp has the real
// one.
#include "tactor/drivers/guardian.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/contains.h"
#include "support/temporary_file.h"
#include "support/unwrap.h"

#include "support/check_tests.h"

using tactor::Guardian;

namespace {

/// Says into a pipe what it was given, then what comes on its standard input, as hexadecimal bytes.
class Script
{
public:
  Script()
  {
    // A shell would change signals.
    const std::string path = folder_.file("guardian", R"(#!/usr/bin/perl
$| = 1;
opendir(my $folder, "/proc/self/fd");
my $open = grep { (readlink("/proc/self/fd/$_") // "") =~ /^(pipe|socket):/ } readdir($folder);
open(STDOUT, ">", "$0.said");
open(my $stat, "/proc/self/stat");
my @stat = split(" ", <$stat>);
print "$ARGV[0]\n$$ $stat[5] $stat[6]\n$open\n";
open(my $status, "/proc/self/status");
/^Sig(?:Blk|Ign):\t(.*)/ and print "$1\n" for <$status>;
printf(" %02x\n", ord($byte)) if sysread(STDIN, $byte, 1);
)");
    fail_unless(chmod(path.c_str(), 0700) == 0);
    fail_unless(mkfifo((path + ".said").c_str(), 0600) == 0);
    setenv("VISUOTACTILE_GUARDIAN", path.c_str(), 1);
  }

  void open()
  {
    said_.open(folder_.file("guardian.said"));
  }
  std::string hear()
  {
    std::string line;
    std::getline(said_, line);
    return line;
  }

private:
  TemporaryFolder folder_;
  std::ifstream said_;
};

volatile std::sig_atomic_t children = 0;

} // namespace

/// It has a session of its own without a terminal, no file but the socket, default signals, and is
/// no child to wait for.
CHECK_TEST(test_started)
{
  int inherited[2];
  fail_unless(pipe(inherited) == 0); // as of an application that does not close on exec
  std::signal(SIGCHLD, [](int) { children = children + 1; });
  std::signal(SIGTERM, SIG_IGN);
  sigset_t blocked;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGINT);
  sigprocmask(SIG_BLOCK, &blocked, nullptr);
  Script script;
  Guardian guardian = unwrap(Guardian::start("1-2.3"));
  script.open();
  assert_text(script.hear(), "1-2.3");
  int pid = 0;
  int session = 0;
  int terminal = -1;
  fail_unless(std::sscanf(script.hear().c_str(), "%d %d %d", &pid, &session, &terminal) == 3);
  ck_assert_int_eq(session, pid);
  ck_assert_int_eq(terminal, 0);
  assert_text(script.hear(), "1");
  assert_text(script.hear(), "0000000000000000");
  // Perl's own, SIGFPE, and those of C's library, from 32 on, do not count.
  const unsigned long long ignored = std::stoull(script.hear(), nullptr, 16);
  fail_unless((ignored & 0x7fffff7f) == 0, "%llx", ignored);
  fail_unless(waitpid(-1, nullptr, __WALL | WNOHANG) == -1 && errno == ECHILD);
  ck_assert_int_eq(children, 0);
  guardian.dismiss();
  assert_text(script.hear(), " 00");
}

/// It hears the end of the socket when this process is gone without a word.
CHECK_TEST(test_left)
{
  Script script;
  std::optional<Guardian> guardian = unwrap(Guardian::start("1-2"));
  script.open();
  for (int line = 0; line < 5; line++)
    script.hear();
  guardian.reset();
  assert_text(script.hear(), "");
}

CHECK_TEST(test_cannot_be_started)
{
  setenv("VISUOTACTILE_GUARDIAN", "/nonexistent/guardian", 1);
  const auto none = Guardian::start("1-2");
  fail_if(none.has_value());
  assert_contains(none.error(), { "/nonexistent/guardian", "No such file" });
  fail_unless(waitpid(-1, nullptr, __WALL | WNOHANG) == -1 && errno == ECHILD);
}

CHECK_MAIN(guardian)
