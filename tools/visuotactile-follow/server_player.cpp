// SPDX-License-Identifier: LGPL-2.1-or-later
#include "server_player.h"

#include "library/web.h"

#include <utility>

using follow::local_time;
using follow::MediaServer;

namespace {

constexpr std::size_t kMostBytes = std::size_t{ 8 } << 20;
constexpr follow::Time kIdleEvery = std::chrono::seconds(1); ///< while no film is open

library::Query
query_of(const ServerSettings &settings, GCancellable *stop)
{
  MediaServer::Query query = MediaServer::query(settings.kind, settings.token);
  const char *slash = settings.address.ends_with('/') ? "" : "/";
  return { .address = settings.address + slash + query.path,
           .most = kMostBytes,
           .stop = stop,
           .headers = std::move(query.headers),
           .advice = "is it the address of the server, and is its token valid?" };
}

} // namespace

ServerPlayer::ServerPlayer(ServerSettings settings, follow::PlayerEvents events,
                           std::function<void(const std::string &)> said)
    : name_(std::string(name_of(settings.kind)) + " at " + settings.address),
      settings_(std::move(settings)), events_(std::move(events)), said_(std::move(said)),
      server_(settings_.kind, settings_.device), context_(g_main_context_ref_thread_default()),
      stop_(g_cancellable_new())
{
  thread_ = std::thread([this] { query(); });
}

ServerPlayer::~ServerPlayer()
{
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  g_cancellable_cancel(stop_);
  wake_.notify_all();
  thread_.join();
  if (source_ != nullptr) {
    g_source_destroy(source_);
    g_source_unref(source_);
  }
  g_object_unref(stop_);
  g_main_context_unref(context_);
}

/// Ends with the first error.
void
ServerPlayer::query()
{
  const library::Query query = query_of(settings_, stop_);
  std::unique_lock lock(mutex_);
  while (!stops_) {
    lock.unlock();
    const follow::Time asked = local_time();
    auto body = library::fetch(query);
    auto answer = std::make_unique<Answer>(std::move(body), asked, local_time());
    const bool failed = !answer->body;
    lock.lock();
    if (stops_)
      return;
    answer_ = std::move(answer);
    source_ = g_idle_source_new();
    g_source_set_priority(source_, G_PRIORITY_DEFAULT);
    g_source_set_callback(
        source_,
        +[](gpointer data) -> gboolean {
          auto *self = static_cast<ServerPlayer *>(data);
          std::unique_ptr<Answer> taken;
          {
            const std::lock_guard taking(self->mutex_);
            g_clear_pointer(&self->source_, g_source_unref);
            taken = std::move(self->answer_);
          }
          self->wake_.notify_all();
          self->take(*taken);
          return G_SOURCE_REMOVE;
        },
        this, nullptr);
    g_source_attach(source_, context_);
    if (failed)
      return;
    wake_.wait(lock, [this] { return stops_ || source_ == nullptr; });
    const follow::Time next = asked + (plays_ ? MediaServer::kAskEvery : kIdleEvery);
    wake_.wait_for(lock, next - local_time(), [this] { return stops_; });
  }
}

void
ServerPlayer::take(const Answer &answer)
{
  const auto report = answer.body.and_then([&](const std::string &body) {
    return server_.received(body, answer.asked, answer.received);
  });
  if (!report) {
    events_.gone(report.error());
    return;
  }
  if (!std::exchange(is_there_, true))
    said_(name_ + " is there");
  {
    const std::lock_guard lock(mutex_);
    plays_ = report->doing != follow::Doing::stopped;
  }
  events_.reported(*report);
}
