// SPDX-License-Identifier: LGPL-2.1-or-later
//
// followrecord (mpv SOCKET | mpris NAME | kodi HOST:PORT): prints each report of a player as a line
// "report,RECEIVED,ASKED,POSITION,DOING,RATE,SOUGHT", times in ns, what is unknown empty. Until it
// is killed or the player is gone.
#include "follow/players/kodi_player.h"
#include "follow/players/mpris_bus.h"
#include "follow/players/mpris_player.h"
#include "follow/players/mpv_player.h"

#include <cstdio>
#include <optional>
#include <string>

using namespace follow;

namespace {

std::string
text(const std::optional<Time> &time)
{
  return time ? std::to_string(time->count()) : std::string();
}

void
print(const Report &report)
{
  std::printf("report,%s,%s,%s,%d,%g,%d\n", text(report.received).c_str(),
              text(report.asked).c_str(), text(report.position).c_str(),
              static_cast<int>(report.doing), report.rate, report.sought ? 1 : 0);
  std::fflush(stdout);
}

} // namespace

int
main(int argc, char **argv)
{
  if (argc != 3)
    return 2;
  const std::string kind = argv[1];
  GMainLoop *loop = g_main_loop_new(nullptr, FALSE);
  const PlayerEvents events{ .reported = print, .gone = [loop](const std::string &) {
                              g_main_loop_quit(loop);
                            } };
  std::unique_ptr<Player> player;
  std::unique_ptr<KodiSearch> search;
  if (kind == "mpv") {
    auto opened = open_mpv(argv[2], events);
    if (!opened)
      return 1;
    player = *std::move(opened);
  } else if (kind == "mpris") {
    player = open_mpris(g_bus_get_sync(G_BUS_TYPE_SESSION, nullptr, nullptr),
                        kMprisPrefix + std::string(argv[2]), events);
  } else {
    search = std::make_unique<KodiSearch>(
        argv[2], KodiSearch::Events{ .found = [&](auto *line) { player = open_kodi(line, events); },
                                     .missed =
                                         [loop](const std::string &, bool) {
                                           g_main_loop_quit(loop);
                                         } });
    search->look();
  }
  g_main_loop_run(loop);
  player.reset();
  search.reset();
  g_main_loop_unref(loop);
}
