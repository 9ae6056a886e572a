// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes measurements. SESSION: a session.ini that parses has a plan that can be played. Otherwise
// a sound file that GStreamer decodes: its samples are evenly spaced and finite. Other input is
// refused with a reason.
#include "fuzz.h"

#ifdef SESSION
#include "tools/tactor-calibrate/session.h"
#else
#include "tools/tactor-calibrate/audio_file.h"
#endif

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace {

#ifdef SESSION
/// A folder in memory with the file as session.ini.
std::filesystem::path
folder_of(const std::string &file)
{
  const std::filesystem::path folder = "/dev/shm/session-fuzz-" + std::to_string(getpid());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  std::filesystem::create_symlink(file, folder / "session.ini");
  return folder;
}

void
check(const std::string &file)
{
  static const struct Folder
  {
    ~Folder()
    {
      std::filesystem::remove_all(path);
    }
    std::filesystem::path path;
  } folder{ folder_of(file) };
  const Session session = Session::open(folder.path);
  expect(session.runs() > 0);
  for (const int run : { 0, session.runs() - 1 }) {
    expect(!session.is_done(run, false));
    tactor::Time at{ 0 };
    for (const Frame &frame : session.frames(run)) {
      expect(frame.begin >= at && frame.duration > tactor::Time(0));
      at = frame.begin + frame.duration;
      expect(std::ranges::all_of(frame.levels, [](float v) { return v >= 0 && v <= 1; }));
    }
  }
}
#else
void
check(const std::string &file)
{
  static const bool initialized = gst_init_check(nullptr, nullptr, nullptr);
  expect(initialized);
  const tactor::Recording recording = read_recording(file, GST_SECOND / 4);
  expect(recording.size() > 0 && recording.rate > 0);
  for (const std::vector<double> &channel : recording.channels)
    expect(channel.size() == recording.size()
           && std::ranges::all_of(channel, [](double value) { return std::isfinite(value); }));
}
#endif

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  read_or_refuse([&] { check(memory_file(data, size)); });
  return 0;
}
