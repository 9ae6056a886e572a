// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"

#include "../visuotactile-play/launch_line.h"

#include "film/command_line.h"
#include "film/or_throw.h"
#include "film/output.h"
#include "film/pipeline.h"
#include "study/folder.h"
#include "translation.h"

#include <cstdio>
#include <filesystem>

namespace {

constexpr int kSide = 1000; // pixels, as in the paper
constexpr int kRate = 30;
constexpr int kPracticeSeconds = 15;

/// A film of tactiletestsrc as a file.
void
make_film(const std::filesystem::path &folder, const std::string &name, const char *pattern,
          int seconds, int seed, int side)
{
  Output output(folder, name);
  const std::string size = std::to_string(side);
  const Pipeline pipeline = make_pipeline(
      std::string("tactiletestsrc pattern=") + pattern + " seed=" + std::to_string(seed)
      + " num-buffers=" + std::to_string(seconds * kRate) + " ! video/x-raw,width=" + size
      + ",height=" + size + ",framerate=" + std::to_string(kRate) + "/1 ! videoconvert ! "
      + video_encoder() + " ! matroskamux ! filesink name=file");
  g_object_set(element(pipeline, "file").get(), "location", output.part_path().c_str(), nullptr);
  const Owned<GstBus> bus(gst_element_get_bus(pipeline.get()));
  if (gst_element_set_state(pipeline.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE)
    throw std::runtime_error(start_error(bus.get()));
  const std::unique_ptr<GstMessage, void (*)(GstMessage *)> last(
      gst_bus_timed_pop_filtered(bus.get(), GST_CLOCK_TIME_NONE,
                                 static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR)),
      gst_message_unref);
  if (GST_MESSAGE_TYPE(last.get()) == GST_MESSAGE_ERROR) {
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(last.get(), &error, nullptr);
    throw std::runtime_error(in_text("cannot make '{}': {}", name, error->message));
  }
  gst_element_set_state(pipeline.get(), GST_STATE_NULL);
  output.commit();
}

} // namespace

int
make_new(int argc, char **argv)
{
  CommonOptions common;
  TextOption film;
  gint seconds = 60;
  gint side = kSide;
  const GOptionEntry entries[] = {
    { "film", 'f', 0, G_OPTION_ARG_FILENAME, &film.value,
      N_("The third film, of the real world (default: FOLDER/films/real-world.mkv, which you "
         "provide)"),
      "FILE" },
    { "length", 'l', 0, G_OPTION_ARG_INT, &seconds,
      N_("Length of the synthetic films in s, 1 to 600 (default: 60)"), "S" },
    { "side", 0, 0, G_OPTION_ARG_INT, &side,
      N_("Width and height of the synthetic films, 64 to 2160 pixels (default: 1000)"), "PIXELS" },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary = N_("Makes the folder of a study: study.ini, which you edit, films of "
                      "tactiletestsrc, and the\npaper's results. Without edits, the study is that "
                      "of Kim, Lee, Choi 2012, Section 5.\nExisting files are never replaced."),
        .least = 1,
        .most = 1 });
  expect_range("--length", seconds, 1, 600);
  expect_range("--side", side, 64, 2160);
  gst_init(nullptr, nullptr);
  std::string third = "films/real-world.mkv";
  if (film.is_set()) {
    std::error_code error;
    third = std::filesystem::absolute(film.text(), error).string();
  }
  const std::string &folder = arguments[0];
  or_throw(study::Folder::make(folder, third));
  const std::filesystem::path films = std::filesystem::path(folder) / "films";
  make_film(films, "static-motion.mkv", "static-motion", seconds, 1, side);
  make_film(films, "dynamic-motion.mkv", "dynamic-motion", seconds, 1, side);
  make_film(films, "practice.mkv", "static-motion", std::min(seconds, kPracticeSeconds), 2, side);
  if (!common.quiet)
    std::printf(_("written: %s/study.ini\n%sEdit it, then start: visuotactile-study run %s\n"),
                folder.c_str(),
                film.is_set() ? ""
                              : ("The third film is yours: " + folder + "/" + third + "\n").c_str(),
                folder.c_str());
  return 0;
}
