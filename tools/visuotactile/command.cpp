// SPDX-License-Identifier: LGPL-2.1-or-later
#include "command.h"

#include <gio/gio.h>

#include <csignal>
#include <filesystem>
#include <sys/prctl.h>
#include <utility>

namespace {

/// A child of the program may keep its output open, such as a browser.
constexpr guint kRest = 1000; ///< ms

} // namespace

struct Command::Run
{
  Calls calls;
  GSubprocess *process = nullptr;
  std::string complaint{}; ///< the last line of standard error
  bool worked = false;
  bool was_killed = false; ///< its last line is no complaint
  int parts = 3;           ///< not ended: the process and its two streams
  guint rest = 0;          ///< timeout after the process' end

  ~Run()
  {
    g_clear_object(&process);
  }
};

void
Command::end(Run &run)
{
  if (const Calls calls = std::exchange(run.calls, {}); calls.ended)
    calls.ended(run.worked ? "" : run.was_killed || run.complaint.empty() ? "?" : run.complaint);
}

void
Command::part_ended(const std::shared_ptr<Run> &run)
{
  if (--run->parts > 0)
    return;
  if (const guint rest = std::exchange(run->rest, 0))
    g_source_remove(rest);
  end(*run);
}

namespace {

std::string
path_of(const std::string &program)
{
  g_autofree gchar *self = g_file_read_link("/proc/self/exe", nullptr);
  const auto beside = std::filesystem::path(self ? self : "").parent_path() / program;
  return g_file_test(beside.c_str(), G_FILE_TEST_IS_EXECUTABLE) ? beside.string() : program;
}

/// Reads the lines of a stream to its end.
struct Lines
{
  std::function<void(const std::string &)> call;
  std::function<void()> ended;

  static void read(GInputStream *stream, Lines calls)
  {
    GDataInputStream *lines = g_data_input_stream_new(stream);
    next(lines, new Lines(std::move(calls)));
    g_object_unref(lines); // the read has a reference
  }

  static void next(GDataInputStream *lines, Lines *self)
  {
    g_data_input_stream_read_line_async(lines, G_PRIORITY_DEFAULT, nullptr, on_line, self);
  }

  static void on_line(GObject *source, GAsyncResult *result, gpointer data)
  {
    auto *self = static_cast<Lines *>(data);
    auto *lines = G_DATA_INPUT_STREAM(source);
    g_autofree gchar *line = g_data_input_stream_read_line_finish(lines, result, nullptr, nullptr);
    if (line == nullptr) {
      self->ended();
      delete self;
      return;
    }
    g_autofree gchar *text = g_utf8_make_valid(line, -1);
    self->call(text);
    next(lines, self);
  }
};

} // namespace

std::shared_ptr<Command>
Command::start(std::vector<std::string> arguments, Calls calls)
{
  arguments.front() = path_of(arguments.front());
  std::vector<const gchar *> argv;
  for (const std::string &argument : arguments)
    argv.push_back(argument.c_str());
  argv.push_back(nullptr);
  auto command = std::make_shared<Command>();
  command->run_ = std::make_shared<Run>(Run{ .calls = std::move(calls), .complaint = {} });
  const std::shared_ptr<Run> run = command->run_;
  g_autoptr(GError) error = nullptr;
  g_autoptr(GSubprocessLauncher) launcher = g_subprocess_launcher_new(static_cast<GSubprocessFlags>(
      G_SUBPROCESS_FLAGS_STDOUT_PIPE | G_SUBPROCESS_FLAGS_STDERR_PIPE));
  if (run->calls.ends_with_window)
    g_subprocess_launcher_set_child_setup(
        launcher, +[](gpointer) { prctl(PR_SET_PDEATHSIG, SIGTERM); }, nullptr, nullptr);
  run->process = g_subprocess_launcher_spawnv(launcher, argv.data(), &error);
  if (run->process == nullptr) {
    run->complaint = error->message;
    g_idle_add_full(
        G_PRIORITY_DEFAULT,
        +[](gpointer data) -> gboolean {
          end(**static_cast<std::shared_ptr<Run> *>(data));
          return G_SOURCE_REMOVE;
        },
        new std::shared_ptr<Run>(run),
        +[](gpointer data) { delete static_cast<std::shared_ptr<Run> *>(data); });
    return command;
  }
  const auto ended = [run] {
    part_ended(run);
  };
  Lines::read(g_subprocess_get_stdout_pipe(run->process), { [run](const std::string &line) {
                                                             if (const auto call = run->calls.line)
                                                               call(line);
                                                           },
                                                            ended });
  Lines::read(g_subprocess_get_stderr_pipe(run->process), { [run](const std::string &line) {
                                                             run->complaint = line;
                                                             if (const auto call = run->calls.told)
                                                               call(line);
                                                           },
                                                            ended });
  g_subprocess_wait_async(
      run->process, nullptr,
      +[](GObject *process, GAsyncResult *result, gpointer data) {
        const std::unique_ptr<std::shared_ptr<Run>> own(static_cast<std::shared_ptr<Run> *>(data));
        g_subprocess_wait_finish(G_SUBPROCESS(process), result, nullptr);
        (*own)->worked = g_subprocess_get_successful(G_SUBPROCESS(process));
        (*own)->was_killed = g_subprocess_get_if_signaled(G_SUBPROCESS(process));
        (*own)->rest = g_timeout_add_full(
            G_PRIORITY_DEFAULT, kRest,
            +[](gpointer run) -> gboolean {
              const auto ended = *static_cast<std::shared_ptr<Run> *>(run);
              ended->rest = 0;
              end(*ended);
              return G_SOURCE_REMOVE;
            },
            new std::shared_ptr<Run>(*own),
            +[](gpointer run) { delete static_cast<std::shared_ptr<Run> *>(run); });
        part_ended(*own);
      },
      new std::shared_ptr<Run>(run));
  return command;
}

void
Command::stop()
{
  if (run_->process != nullptr)
    g_subprocess_send_signal(run_->process, SIGTERM);
}

void
Command::forget()
{
  run_->calls = {};
}
