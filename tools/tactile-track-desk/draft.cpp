// SPDX-License-Identifier: LGPL-2.1-or-later
#include "draft.h"

#include <array>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <sys/prctl.h>
#include <unistd.h>
#include <vector>

namespace fs = std::filesystem;

namespace {

AnalysisSettings
analysis_of(const DraftSettings &settings)
{
  return { .rate = settings.rate, .rows = settings.rows, .columns = settings.columns };
}

/// The command that authors.
std::vector<std::string>
command(const DraftSettings &settings, const std::string &track)
{
  std::array<char, G_ASCII_DTOSTR_BUF_SIZE> rate{};
  g_ascii_dtostr(rate.data(), static_cast<gint>(rate.size()), settings.rate);
  return { settings.author,
           "author",
           fs::absolute(settings.film).string(),
           "-o",
           fs::absolute(track).string(),
           "--rows=" + std::to_string(settings.rows),
           "--columns=" + std::to_string(settings.columns),
           std::string("--rate=") + rate.data(),
           "--jobs=1" };
}

GSubprocess *
spawn(const DraftSettings &settings, const std::string &track, bool in_background)
{
  std::vector<std::string> words = command(settings, track);
  if (in_background)
    words.emplace_back("--quiet");
  std::vector<const gchar *> argv;
  for (const std::string &word : words)
    argv.push_back(word.c_str());
  argv.push_back(nullptr);
  g_autoptr(GSubprocessLauncher) launcher = g_subprocess_launcher_new(static_cast<GSubprocessFlags>(
      in_background ? G_SUBPROCESS_FLAGS_STDERR_SILENCE : G_SUBPROCESS_FLAGS_STDOUT_SILENCE));
  g_subprocess_launcher_set_child_setup(
      launcher,
      in_background ? +[](gpointer) {
        // It has a low priority, and ends with the desk.
        nice(15);
        prctl(PR_SET_PDEATHSIG, SIGTERM);
      } : +[](gpointer) { prctl(PR_SET_PDEATHSIG, SIGTERM); },
      nullptr, nullptr);
  g_autoptr(GError) error = nullptr;
  GSubprocess *process = g_subprocess_launcher_spawnv(launcher, argv.data(), &error);
  if (process == nullptr)
    throw std::runtime_error("'" + settings.author + "' cannot author a draft: " + error->message);
  return process;
}

} // namespace

FilmDraft::FilmDraft(DraftSettings settings, std::function<void()> changed)
    : settings_(std::move(settings)), changed_(std::move(changed)),
      cache_(DraftCache::usual_folder()), film_(library::file_version(settings_.film)),
      track_(cache_.find(settings_.film, analysis_of(settings_))), cancellable_(g_cancellable_new())
{
  if (track_)
    return;
  const std::string path = cache_.path(settings_.film, analysis_of(settings_));
  failed_ = path.empty();
  if (failed_)
    return;
  g_mkdir_with_parents(fs::path(path).parent_path().c_str(), 0700);
  std::error_code ignored;
  fs::remove(path, ignored); // author would keep an unreadable one
  try {
    process_ = spawn(settings_, path, true);
  } catch (const std::runtime_error &) {
    failed_ = true;
    return;
  }
  g_subprocess_wait_check_async(
      process_, cancellable_,
      +[](GObject *process, GAsyncResult *result, gpointer self) {
        g_autoptr(GError) error = nullptr;
        g_subprocess_wait_check_finish(G_SUBPROCESS(process), result, &error);
        if (!g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED)) {
          static_cast<FilmDraft *>(self)->read();
          static_cast<FilmDraft *>(self)->changed_();
        }
      },
      this);
}

FilmDraft::~FilmDraft()
{
  g_cancellable_cancel(cancellable_);
  g_object_unref(cancellable_);
  if (process_ == nullptr)
    return;
  g_subprocess_send_signal(process_, SIGTERM);
  g_object_unref(process_);
}

void
FilmDraft::read()
{
  const AnalysisSettings analysis = analysis_of(settings_);
  track_ = cache_.find(settings_.film, analysis);
  failed_ = !track_;
  if (track_)
    try { // as the user's alone, and bounded
      cache_.keep(*track_, settings_.film, film_, analysis);
    } catch (const std::exception &) { // the draft stays until the desk ends
    }
}

void
author_now(const DraftSettings &settings, const std::string &track)
{
  GSubprocess *process = spawn(settings, track, false);
  g_autoptr(GError) error = nullptr;
  const bool done = g_subprocess_wait_check(process, nullptr, &error);
  g_object_unref(process);
  if (!done)
    throw std::runtime_error("no draft could be authored: "
                             + std::string(error ? error->message : "unknown reason"));
}
