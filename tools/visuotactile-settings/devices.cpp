// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"

#include "film/command_line.h"
#include "film/device_list.h"
#include "house/missing.h"
#include "house/switches.h"
#include "translation.h"

#include <cstdio>

namespace {

void
parse(int argc, char **argv, CommonOptions &common, const char *summary)
{
  const GOptionEntry none[] = { {} };
  parse_options(argc, argv, none, common,
                { .arguments = "", .summary = summary, .least = 0, .most = 0 });
}

} // namespace

int
devices(int argc, char **argv)
{
  CommonOptions common;
  parse(
      argc, argv, common,
      N_("Prints the connected devices, each as arguments of 'use', and the reason if one cannot\n"
         "be felt. Exit status 1: something is missing. Opens none."));
  gst_init(nullptr, nullptr);
  std::vector<FoundDevice> found = found_devices();
  const std::vector<std::string> lines = missing(found);
  if (const std::optional<FoundDevice> absent = absent_device(found, waiting_servers()))
    found.insert(found.begin(), *absent);
  for (const FoundDevice &device : found) {
    g_autofree gchar *argument = g_shell_quote(("device=" + device.device).c_str());
    if (!common.quiet)
      std::printf("driver=%s %s  %s\n", device.driver.c_str(),
                  device.device.empty() ? "" : argument,
                  device.driver == kAudio ? _("shakers at a sound card") : device.name.c_str());
  }
  for (const std::string &server : waiting_servers())
    if (!common.quiet)
      std::printf(_("driver=%s  its server runs here; name a device\n"), server.c_str());
  for (const std::string &line : lines)
    print_error("visuotactile-settings", line);
  return lines.empty() ? 0 : 1;
}

int
players(int argc, char **argv)
{
  CommonOptions common;
  parse(
      argc, argv, common,
      N_("Prints the players that 'on' and 'off' know, whether each is installed, and its state."));
  for (const Switch &player : switches())
    if (!common.quiet)
      std::printf("%-28s %-14s %s\n", player.name.c_str(),
                  !player.is_there ? _("not installed")
                  : player.is_on   ? _("on")
                                   : _("off"),
                  player.title.c_str());
  return 0;
}
