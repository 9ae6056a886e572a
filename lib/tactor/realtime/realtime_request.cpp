// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/realtime/realtime_request.h"

#include <tl/expected.hpp>

#include <gio/gio.h>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

namespace tactor {

namespace {

/// Timeout of each step. Long, as starting a service may be slow, and no thread waits for it.
constexpr guint kPatience = 5; // s

/// A service that may grant it.
struct Service
{
  Scheduling scheduling;
  const char *title;
  GBusType bus;
  const char *name;
  const char *path;
  const char *interface;
};

constexpr Service kRealtimeKit{ Scheduling::realtime_kit,
                                "RealtimeKit",
                                G_BUS_TYPE_SYSTEM,
                                "org.freedesktop.RealtimeKit1",
                                "/org/freedesktop/RealtimeKit1",
                                "org.freedesktop.RealtimeKit1" };
constexpr Service kPortal{ Scheduling::portal,
                           "the desktop portal",
                           G_BUS_TYPE_SESSION,
                           "org.freedesktop.portal.Desktop",
                           "/org/freedesktop/portal/desktop",
                           "org.freedesktop.portal.Realtime" };

/// Limits of a service.
struct Terms
{
  int priority = 0; ///< at most
  rlim_t time = 0;  ///< RLIMIT_RTTIME at most, in µs
};

/// The reason of a failure, in one line.
using Why = std::string;
template <typename T> using Result = tl::expected<T, Why>;

tl::unexpected<Why>
unexpected(GError *error)
{
  g_dbus_error_strip_remote_error(error);
  return tl::unexpected(Why(error->message));
}

/// A connection to a bus. g_bus_get_sync() shares a connection that ends the process with the bus.
/// G_DBUS_CONNECTION_FLAGS_MESSAGE_BUS_CONNECTION waits 25 s for a silent bus and cannot be
/// canceled.
class BusConnection
{
public:
  static Result<BusConnection> open(GBusType bus, GCancellable *cancellable);

  /// Consumes the parameters.
  Result<GVariant *> call(const char *name, const char *path, const char *interface,
                          const char *method, GVariant *parameters) const;

private:
  BusConnection(GDBusConnection *connection, GCancellable *cancellable)
      : connection_(connection, g_object_unref), cancellable_(cancellable)
  {
  }

  std::unique_ptr<GDBusConnection, decltype(&g_object_unref)> connection_;
  GCancellable *cancellable_;
};

Result<BusConnection>
BusConnection::open(GBusType bus, GCancellable *cancellable)
{
  g_autoptr(GError) error = nullptr;
  g_autofree gchar *address = g_dbus_address_get_for_bus_sync(bus, cancellable, &error);
  if (!address)
    return unexpected(error);
  g_autoptr(GIOStream) stream
      = g_dbus_address_get_stream_sync(address, nullptr, cancellable, &error);
  if (!stream)
    return unexpected(error);
  // For the authentication only; calls have timeouts of their own.
  GSocket *socket = G_IS_SOCKET_CONNECTION(stream)
                        ? g_socket_connection_get_socket(G_SOCKET_CONNECTION(stream))
                        : nullptr;
  if (socket)
    g_socket_set_timeout(socket, kPatience);
  GDBusConnection *made = g_dbus_connection_new_sync(
      stream, nullptr, G_DBUS_CONNECTION_FLAGS_AUTHENTICATION_CLIENT, nullptr, cancellable, &error);
  if (!made)
    return unexpected(error);
  if (socket)
    g_socket_set_timeout(socket, 0);
  BusConnection connection(made, cancellable);
  const Result<GVariant *> hello = connection.call("org.freedesktop.DBus", "/org/freedesktop/DBus",
                                                   "org.freedesktop.DBus", "Hello", nullptr);
  if (!hello)
    return tl::unexpected(hello.error());
  g_variant_unref(*hello);
  return connection;
}

Result<GVariant *>
BusConnection::call(const char *name, const char *path, const char *interface, const char *method,
                    GVariant *parameters) const
{
  g_autoptr(GError) error = nullptr;
  GVariant *reply = g_dbus_connection_call_sync(
      connection_.get(), name, path, interface, method, parameters, nullptr, G_DBUS_CALL_FLAGS_NONE,
      static_cast<gint>(kPatience) * 1000, cancellable_, &error);
  if (!reply)
    return unexpected(error);
  return reply;
}

/// Single properties: RealtimeKit has no GetAll.
Result<gint64>
read_property(const BusConnection &connection, const Service &service, const char *name)
{
  const Result<GVariant *> reply
      = connection.call(service.name, service.path, "org.freedesktop.DBus.Properties", "Get",
                        g_variant_new("(ss)", service.interface, name));
  if (!reply)
    return tl::unexpected(reply.error());
  g_autoptr(GVariant) tuple = *reply;
  g_autoptr(GVariant) value = nullptr;
  if (g_variant_is_of_type(tuple, G_VARIANT_TYPE("(v)")))
    g_variant_get(tuple, "(v)", &value);
  gint64 number = 0;
  if (value && g_variant_is_of_type(value, G_VARIANT_TYPE_INT64))
    number = g_variant_get_int64(value);
  else if (value && g_variant_is_of_type(value, G_VARIANT_TYPE_INT32))
    number = g_variant_get_int32(value);
  if (number < 1)
    return tl::unexpected("it does not say what it grants: " + std::string(name));
  return number;
}

Result<Terms>
read_terms(const BusConnection &connection, const Service &service)
{
  const Result<gint64> priority = read_property(connection, service, "MaxRealtimePriority");
  if (!priority)
    return tl::unexpected(priority.error());
  const Result<gint64> time = read_property(connection, service, "RTTimeUSecMax");
  if (!time)
    return tl::unexpected(time.error());
  return Terms{ static_cast<int>(std::min<gint64>(*priority, 99)), static_cast<rlim_t>(*time) };
}

bool
is_realtime(pid_t thread)
{
  const int policy = sched_getscheduler(thread) & ~SCHED_RESET_ON_FORK;
  return policy == SCHED_FIFO || policy == SCHED_RR;
}

bool
has_realtime_threads()
{
  g_autoptr(GDir) threads = g_dir_open("/proc/self/task", 0, nullptr);
  if (!threads)
    return false;
  while (const gchar *thread = g_dir_read_name(threads))
    if (is_realtime(static_cast<pid_t>(g_ascii_strtoll(thread, nullptr, 10))))
      return true;
  return false;
}

/// Lowers RLIMIT_RTTIME to what the service requires.
Result<void>
limit_time(rlim_t most)
{
  rlimit limit{};
  getrlimit(RLIMIT_RTTIME, &limit);
  if (limit.rlim_max <= most)
    return {};
  // The limit is the process's, and others may rely on having none.
  if (has_realtime_threads())
    return tl::unexpected(
        Why("other threads of this process are real-time and have no limit on their CPU time"));
  limit.rlim_max = most;
  limit.rlim_cur = std::min(limit.rlim_cur, most);
  if (setrlimit(RLIMIT_RTTIME, &limit) != 0)
    return tl::unexpected(Why("the CPU time of real-time threads cannot be limited: ")
                          + std::strerror(errno));
  return {};
}

/// Requests real-time priority from a service. Returns the service and its terms, in words.
Result<std::string>
request(const Service &service, GCancellable *cancellable, pid_t thread, int priority)
{
  const Result<BusConnection> connection = BusConnection::open(service.bus, cancellable);
  if (!connection)
    return tl::unexpected(connection.error());
  const Result<Terms> terms = read_terms(*connection, service);
  if (!terms)
    return tl::unexpected(terms.error());
  if (const Result<void> limited = limit_time(terms->time); !limited)
    return tl::unexpected(limited.error());
  const Result<GVariant *> reply = connection->call(
      service.name, service.path, service.interface, "MakeThreadRealtimeWithPID",
      g_variant_new("(ttu)", static_cast<guint64>(getpid()), static_cast<guint64>(thread),
                    static_cast<guint32>(std::min(priority, terms->priority))));
  if (!reply)
    return tl::unexpected(reply.error());
  g_variant_unref(*reply);
  return "by " + std::string(service.title) + ", at most " + std::to_string(terms->time / 1000)
         + " ms of CPU time at once";
}

} // namespace

struct RealtimeRequest::State
{
  pid_t thread;
  int priority;
  Answer answer;
  std::unique_ptr<GCancellable, decltype(&g_object_unref)> cancellable{ g_cancellable_new(),
                                                                        g_object_unref };
  GThread *worker = nullptr;

  void run() const;
};

RealtimeRequest::RealtimeRequest(pid_t thread, int priority, Answer answer)
    : state_(new State{ thread, priority, std::move(answer) })
{
  const auto run = [](gpointer state) -> gpointer {
    static_cast<const State *>(state)->run();
    return nullptr;
  };
  g_autoptr(GError) error = nullptr;
  state_->worker = g_thread_try_new("tactor-rtkit", run, state_.get(), &error);
  if (!state_->worker)
    state_->answer(Scheduling::normal, error->message);
}

RealtimeRequest::~RealtimeRequest()
{
  g_cancellable_cancel(state_->cancellable.get());
  if (state_->worker)
    g_thread_join(state_->worker);
}

void
RealtimeRequest::State::run() const
{
  std::string why;
  for (const Service &service : { kRealtimeKit, kPortal }) {
    // Without an address GIO would start a bus daemon.
    if (service.bus == G_BUS_TYPE_SESSION && !g_getenv("DBUS_SESSION_BUS_ADDRESS"))
      continue;
    const Result<std::string> got = request(service, cancellable.get(), thread, priority);
    if (g_cancellable_is_cancelled(cancellable.get()))
      return;
    if (got) {
      answer(service.scheduling, *got);
      return;
    }
    why += (why.empty() ? "" : "; ") + std::string(service.title) + ": " + got.error();
  }
  answer(Scheduling::normal, why);
}

} // namespace tactor
