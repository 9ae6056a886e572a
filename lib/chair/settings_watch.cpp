// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair/settings_watch.h"

#include "chair/settings_file.h"

#include <semaphore>
#include <utility>

#include <gio/gio.h>

namespace chair {

constexpr guint kReplaced = 500; ///< ms

struct SettingsWatch::Impl
{
  std::function<void()> changed;
  GMainContext *context = g_main_context_new();
  GMainLoop *loop = g_main_loop_new(context, FALSE);
  std::binary_semaphore watching{ 0 };
  GThread *thread = nullptr;

  static void on_changed(GFileMonitor *, GFile *, GFile *, GFileMonitorEvent event, gpointer data)
  {
    auto *self = static_cast<Impl *>(data);
    // The last event of a file that is written in place or replaces another one.
    if (event == G_FILE_MONITOR_EVENT_CHANGES_DONE_HINT)
      self->changed();
    if (event != G_FILE_MONITOR_EVENT_DELETED)
      return;
    // Editors rename the file before they write it.
    GSource *later = g_timeout_source_new(kReplaced);
    g_source_set_callback(
        later,
        [](gpointer impl) -> gboolean {
          static_cast<Impl *>(impl)->changed();
          return G_SOURCE_REMOVE;
        },
        self, nullptr);
    g_source_attach(later, self->context);
    g_source_unref(later);
  }

  void run()
  {
    g_main_context_push_thread_default(context);
    g_autoptr(GFile) file = g_file_new_for_path(settings_path().c_str());
    g_autoptr(GFileMonitor) monitor
        = g_file_monitor_file(file, G_FILE_MONITOR_NONE, nullptr, nullptr);
    if (monitor)
      g_signal_connect(monitor, "changed", G_CALLBACK(on_changed), this);
    watching.release();
    g_main_loop_run(loop);
    g_clear_object(&monitor);
    g_main_context_pop_thread_default(context);
  }
};

SettingsWatch::SettingsWatch(std::function<void()> changed)
    : impl_(new Impl{ .changed = std::move(changed) })
{
  const auto run = [](gpointer impl) -> gpointer {
    static_cast<Impl *>(impl)->run();
    return nullptr;
  };
  impl_->thread = g_thread_try_new("chair-settings", run, impl_.get(), nullptr);
  if (impl_->thread)
    impl_->watching.acquire();
}

bool
SettingsWatch::watches() const
{
  return impl_->thread != nullptr;
}

static gboolean
quit(gpointer loop)
{
  g_main_loop_quit(static_cast<GMainLoop *>(loop));
  return G_SOURCE_REMOVE;
}

SettingsWatch::~SettingsWatch()
{
  // From within: a loop that has not begun to run would ignore g_main_loop_quit().
  if (impl_->thread) {
    g_main_context_invoke_full(impl_->context, G_PRIORITY_HIGH, quit, impl_->loop, nullptr);
    g_thread_join(impl_->thread);
  }
  g_main_loop_unref(impl_->loop);
  g_main_context_unref(impl_->context);
}

} // namespace chair
