// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A fake RealtimeKit on a private bus. It makes threads real-time as the real one does.
#pragma once

#include "support/realtime.h"

#include <gio/gio.h>

#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <thread>

inline constexpr guint64 kMostTime = 200000; // µs: RealtimeKit's default

inline rlimit
time_limit()
{
  rlimit limit{};
  getrlimit(RLIMIT_RTTIME, &limit);
  return limit;
}

/// A private bus, with a fake RealtimeKit on a thread of its own or without one.
class Bus
{
public:
  enum class Service
  {
    none,
    grants,
    refuses,
    silent, ///< answers property queries, but not requests
  };

  explicit Bus(Service service) : service_(service), bus_(g_test_dbus_new(G_TEST_DBUS_NONE))
  {
    g_test_dbus_up(bus_);
    g_unsetenv("DBUS_SESSION_BUS_ADDRESS");
    g_setenv("DBUS_SYSTEM_BUS_ADDRESS", g_test_dbus_get_bus_address(bus_), TRUE);
    std::unique_lock lock(mutex_);
    thread_ = std::thread([this] { serve(); });
    changed_.wait(lock, [this] { return loop_; });
  }
  ~Bus()
  {
    g_main_context_invoke(
        context_,
        [](gpointer loop) -> gboolean {
          return g_main_loop_quit(static_cast<GMainLoop *>(loop)), FALSE;
        },
        loop_);
    thread_.join();
    g_test_dbus_stop(bus_);
    g_object_unref(bus_);
  }
  Bus(const Bus &) = delete;
  Bus &operator=(const Bus &) = delete;
  /// Waits for a request and returns the thread that it names.
  pid_t asked()
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return asked_ != 0; });
    return asked_;
  }

private:
  static void called(GDBusConnection *, const gchar *, const gchar *, const gchar *, const gchar *,
                     GVariant *parameters, GDBusMethodInvocation *invocation, gpointer self)
  {
    static_cast<Bus *>(self)->make_realtime(parameters, invocation);
  }

  void make_realtime(GVariant *parameters, GDBusMethodInvocation *invocation)
  {
    guint64 process = 0;
    guint64 thread = 0;
    guint32 priority = 0;
    g_variant_get(parameters, "(ttu)", &process, &thread, &priority);
    const auto id = static_cast<pid_t>(thread);
    const sched_param granted{ .sched_priority = static_cast<int>(priority) };
    // As in verify_process_rttime() of rtkit-daemon.c.
    if (service_ == Service::refuses || process != static_cast<guint64>(getpid()) || priority > 20
        || time_limit().rlim_max > kMostTime)
      g_dbus_method_invocation_return_dbus_error(
          invocation, "org.freedesktop.DBus.Error.AccessDenied", "not for you");
    else if (service_ == Service::grants
             && sched_setscheduler(id, SCHED_RR | SCHED_RESET_ON_FORK, &granted) == 0)
      g_dbus_method_invocation_return_value(invocation, nullptr);
    else
      g_object_unref(invocation);
    std::lock_guard lock(mutex_);
    asked_ = id;
    changed_.notify_all();
  }

  static GVariant *property(GDBusConnection *, const gchar *, const gchar *, const gchar *,
                            const gchar *name, GError **, gpointer)
  {
    return g_str_equal(name, "RTTimeUSecMax") ? g_variant_new_int64(kMostTime)
                                              : g_variant_new_int32(20);
  }

  /// The real one implements only `Get`.
  static GDBusMessage *refuse_get_all(GDBusConnection *, GDBusMessage *message, gboolean incoming,
                                      gpointer)
  {
    if (incoming && !g_strcmp0(g_dbus_message_get_member(message), "GetAll")) {
      g_autoptr(GDBusMessage) copy = g_dbus_message_copy(message, nullptr);
      g_dbus_message_set_member(copy, "Unknown");
      g_object_unref(message);
      return static_cast<GDBusMessage *>(g_steal_pointer(&copy));
    }
    return message;
  }

  void serve()
  {
    context_ = g_main_context_new();
    g_main_context_push_thread_default(context_);
    GMainLoop *loop = g_main_loop_new(context_, FALSE);
    GDBusConnection *connection = g_dbus_connection_new_for_address_sync(
        g_test_dbus_get_bus_address(bus_),
        static_cast<GDBusConnectionFlags>(G_DBUS_CONNECTION_FLAGS_AUTHENTICATION_CLIENT
                                          | G_DBUS_CONNECTION_FLAGS_MESSAGE_BUS_CONNECTION),
        nullptr, nullptr, nullptr);
    GDBusNodeInfo *node = g_dbus_node_info_new_for_xml(
        "<node><interface name='org.freedesktop.RealtimeKit1'><method "
        "name='MakeThreadRealtimeWithPID'>"
        "<arg type='t' direction='in'/><arg type='t' direction='in'/><arg type='u' "
        "direction='in'/></method>"
        "<property name='RTTimeUSecMax' type='x' access='read'/><property "
        "name='MaxRealtimePriority' type='i' access='read'/>"
        "</interface></node>",
        nullptr);
    const GDBusInterfaceVTable calls{ called, property, nullptr, {} };
    g_dbus_connection_add_filter(connection, refuse_get_all, nullptr, nullptr);
    if (service_ != Service::none) {
      g_dbus_connection_register_object(connection, "/org/freedesktop/RealtimeKit1",
                                        node->interfaces[0], &calls, this, nullptr, nullptr);
      GVariant *reply = g_dbus_connection_call_sync(
          connection, "org.freedesktop.DBus", "/org/freedesktop/DBus", "org.freedesktop.DBus",
          "RequestName", g_variant_new("(su)", "org.freedesktop.RealtimeKit1", 0u), nullptr,
          G_DBUS_CALL_FLAGS_NONE, -1, nullptr, nullptr);
      g_variant_unref(reply);
    }
    {
      std::lock_guard lock(mutex_);
      loop_ = loop;
      changed_.notify_all();
    }
    g_main_loop_run(loop);
    g_dbus_node_info_unref(node);
    g_object_unref(connection);
    g_main_loop_unref(loop);
    g_main_context_pop_thread_default(context_);
    g_main_context_unref(context_);
  }

  const Service service_;
  GTestDBus *bus_;
  std::mutex mutex_;
  std::condition_variable changed_;
  GMainContext *context_ = nullptr;
  GMainLoop *loop_ = nullptr;
  pid_t asked_ = 0;
  std::thread thread_;
};
