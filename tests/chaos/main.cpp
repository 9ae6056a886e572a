// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chaos.h"
#include "report.h"

#include "gst/tactor/gsttactorsink.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace {

constexpr int kPatience = 30; ///< s, for one step
/// For grids of up to 3 × 3. The second mirrors the columns.
const std::vector<std::vector<int>> kMappings{ {}, { 2, 1, 0, 5, 4, 3, 8, 7, 6 } };

GLogWriterOutput
on_glib_log(GLogLevelFlags level, const GLogField *fields, gsize count, gpointer)
{
  if (!(level & (G_LOG_LEVEL_ERROR | G_LOG_LEVEL_CRITICAL | G_LOG_LEVEL_WARNING)))
    return G_LOG_WRITER_HANDLED;
  g_autofree char *text = g_log_writer_format_fields(level, fields, count, FALSE);
  print_own_stack(0);
  accuse(std::string("GLib warns: ") + text);
}

const std::vector<std::pair<std::string, Stage::Kind>> kKinds{
  { "file", Stage::Kind::file },       { "live", Stage::Kind::live },
  { "network", Stage::Kind::network }, { "playbin", Stage::Kind::playbin },
  { "decoder", Stage::Kind::decoder },
};

std::vector<std::string>
split(const char *list)
{
  g_auto(GStrv) words = g_strsplit(list ? list : "", ",", -1);
  return { words, words + g_strv_length(words) };
}

} // namespace

int
main(int argc, char **argv)
{
  gint count = 50;
  gint64 seed = 1;
  gint runs = 1;
  gchar *kind = nullptr;
  gchar *only = nullptr;
  gboolean verbose = FALSE;
  const GOptionEntry entries[] = {
    { "steps", 0, 0, G_OPTION_ARG_INT, &count, "Steps of a run (50)", "N" },
    { "seed", 0, 0, G_OPTION_ARG_INT64, &seed, "Seed of the first run (1)", "N" },
    { "runs", 0, 0, G_OPTION_ARG_INT, &runs, "Runs of each kind, each its own seed (1)", "N" },
    { "kind", 0, 0, G_OPTION_ARG_STRING, &kind, "file, live, network, playbin or decoder (all)",
      "KIND" },
    { "only", 0, 0, G_OPTION_ARG_STRING, &only, "Steps to draw from, with commas between (all)",
      "STEP,STEP" },
    { "verbose", 'v', 0, G_OPTION_ARG_NONE, &verbose, "Print each step as it is taken", nullptr },
    {}
  };
  GOptionContext *context = g_option_context_new("- does at random what can be done to a film");
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  GError *error = nullptr;
  const bool parsed = g_option_context_parse(context, &argc, &argv, &error);
  g_option_context_free(context);
  const bool known
      = !kind || std::ranges::any_of(kKinds, [&](const auto &each) { return each.first == kind; });
  const std::vector<std::string> drawn = split(only);
  const bool drawable = std::ranges::all_of(drawn, Chaos::is_step);
  if (!parsed || !known || !drawable || count < 1 || runs < 1) {
    std::fprintf(stderr, "chaos: %s; see chaos --help\n",
                 error       ? error->message
                 : !known    ? "expected --kind=file, live, network, playbin or decoder"
                 : !drawable ? "expected --only=STEP,STEP, names as --verbose prints them"
                             : "expected at least one step and one run");
    return 2;
  }

  g_log_set_writer_func(on_glib_log, nullptr, nullptr);
  keep_gstreamer_log();
  GST_ELEMENT_REGISTER(tactorsink, nullptr);
  witness().accuse = accuse;
  witness().set_mappings(kMappings);

  // An unnamed file, so that none is left when the process ends in any way.
  const int fd = memfd_create("film", MFD_CLOEXEC);
  if (fd < 0) {
    std::perror("chaos");
    return 2;
  }
  const std::string film = "/proc/self/fd/" + std::to_string(fd);
  make_film(film);

  Chaos *running = nullptr;
  {
    Watchdog watchdog(kPatience, [&] {
      const std::string waiting = running ? running->waiting_for() : "";
      steps().print(waiting.empty() ? "a step does not end" : "stays so: " + waiting);
      if (running)
        running->print_states();
      print_gstreamer_log();
    });
    for (const auto &[text, each] : kKinds) {
      if (kind && text != kind)
        continue;
      for (int run = 0; run < runs; run++) {
        const auto own = static_cast<std::uint64_t>(seed + run);
        steps().begin(own, text, verbose);
        const guint64 maps = witness().maps();
        const guint64 vibrations = witness().vibrations();
        const guint64 flushes = witness().flushes();
        try {
          Chaos chaos(each, film, own, drawn, watchdog);
          running = &chaos;
          chaos.run(count);
          running = nullptr;
        } catch (const std::invalid_argument &e) {
          std::fprintf(stderr, "chaos: %s, %s\n", text.c_str(), e.what());
          return 2;
        }
        std::printf("%s, seed %" G_GUINT64_FORMAT ": %d steps, %" G_GUINT64_FORMAT
                    " maps, %" G_GUINT64_FORMAT " vibrations, %" G_GUINT64_FORMAT " flushes\n",
                    text.c_str(), own, count, witness().maps() - maps,
                    witness().vibrations() - vibrations, witness().flushes() - flushes);
        std::fflush(stdout);
      }
    }
  }
  close(fd);
  g_free(kind);
  g_free(only);
  return 0;
}
