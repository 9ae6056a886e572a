// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/soup_socket.h"

#include <libsoup/soup.h>

#include <atomic>
#include <deque>
#include <utility>

namespace tactor {

namespace {

/// How long the destructor waits until the server has taken what was sent.
constexpr Time kFarewell = std::chrono::milliseconds(250);
/// Messages that wait for wait(). More end the connection.
constexpr std::size_t kMostWaiting = 256;
constexpr std::size_t kMostBytesWaiting = 4 * kLargestMessage;

Time
steady_now()
{
  return std::chrono::steady_clock::now().time_since_epoch();
}

class SoupSocket final : public MessageSocket
{
public:
  explicit SoupSocket(const std::string &uri)
      : context_(g_main_context_new()), cancellable_(g_cancellable_new())
  {
    g_main_context_push_thread_default(context_);
    alarm_ = g_source_new(&kAlarm, sizeof(GSource));
    g_source_set_callback(
        alarm_, [](gpointer) -> gboolean { return TRUE; }, nullptr, nullptr);
    g_source_attach(alarm_, context_);
    session_ = soup_session_new_with_options("proxy-resolver", nullptr, nullptr);
    soup_session_remove_feature_by_type(session_, SOUP_TYPE_WEBSOCKET_EXTENSION_MANAGER);
    soup_session_remove_feature_by_type(session_, SOUP_TYPE_CONTENT_DECODER);
    SoupMessage *request = soup_message_new("GET", uri.c_str());
    if (request == nullptr) {
      end("'" + uri + "' is no address");
      return;
    }
    soup_message_add_flags(request, SOUP_MESSAGE_NO_REDIRECT);
    is_connecting_ = true;
    soup_session_websocket_connect_async(session_, request, nullptr, nullptr, G_PRIORITY_DEFAULT,
                                         cancellable_, on_connected, this);
    g_object_unref(request);
  }

  ~SoupSocket() override
  {
    g_cancellable_cancel(cancellable_);
    while (is_connecting_)
      g_main_context_iteration(context_, TRUE);
    if (connection_ != nullptr) {
      if (is_open())
        soup_websocket_connection_close(connection_, SOUP_WEBSOCKET_CLOSE_NORMAL, nullptr);
      is_leaving_ = true;
      const Time until = steady_now() + kFarewell;
      set_alarm(until);
      while (!is_ended_ && steady_now() < until)
        g_main_context_iteration(context_, TRUE);
      g_signal_handlers_disconnect_by_data(connection_, this);
      g_io_stream_close(soup_websocket_connection_get_io_stream(connection_), nullptr, nullptr);
      g_object_unref(connection_);
    }
    soup_session_abort(session_);
    g_object_unref(session_);
    g_object_unref(cancellable_);
    g_source_destroy(alarm_);
    g_source_unref(alarm_);
    while (g_main_context_iteration(context_, FALSE))
      continue;
    g_main_context_pop_thread_default(context_);
    g_main_context_unref(context_);
  }

  SoupSocket(const SoupSocket &) = delete;
  SoupSocket &operator=(const SoupSocket &) = delete;

  void send(const std::string &text) override
  {
    if (!is_open() || is_ended_)
      return;
    GSocket *const socket = base_socket();
    if (socket != nullptr && g_socket_condition_check(socket, G_IO_OUT) == 0) {
      // libsoup would keep all that is sent.
      end("it does not read what is sent");
      g_socket_close(socket, nullptr);
      return;
    }
    soup_websocket_connection_send_text(connection_, text.c_str());
  }

  SocketEvent wait(Time until) override
  {
    set_alarm(until);
    g_main_context_iteration(context_, FALSE); // what has come, even if it is late
    while (events_.empty() && steady_now() < until && !woken_.exchange(false))
      g_main_context_iteration(context_, TRUE);
    if (events_.empty())
      return {};
    SocketEvent event = std::move(events_.front());
    events_.pop_front();
    bytes_ -= event.text.size();
    return event;
  }

  void wake() override
  {
    woken_ = true;
    g_main_context_wakeup(context_);
  }

private:
  static gboolean dispatch_alarm(GSource *source, GSourceFunc, gpointer)
  {
    g_source_set_ready_time(source, -1);
    return G_SOURCE_CONTINUE;
  }
  inline static GSourceFuncs kAlarm{ nullptr, nullptr, dispatch_alarm, nullptr, nullptr, nullptr };

  /// Ends an iteration of the context at this time. Steady time is GLib's monotonic time.
  void set_alarm(Time until)
  {
    const auto us = std::chrono::ceil<std::chrono::microseconds>(until).count();
    g_source_set_ready_time(alarm_, us < 0 ? 0 : us);
  }

  bool is_open() const
  {
    return connection_ != nullptr
           && soup_websocket_connection_get_state(connection_) == SOUP_WEBSOCKET_STATE_OPEN;
  }

  void add(SocketEvent event)
  {
    if (is_ended_ || is_leaving_)
      return;
    if (events_.size() >= kMostWaiting || bytes_ + event.text.size() > kMostBytesWaiting) {
      end("it sends more than can be read");
      stop_reading();
      return;
    }
    bytes_ += event.text.size();
    events_.push_back(std::move(event));
  }

  /// Owned by the connection. Null if it is none of a kind that is known.
  GSocket *base_socket() const
  {
    g_autoptr(GIOStream) base = nullptr;
    g_object_get(soup_websocket_connection_get_io_stream(connection_), "base-iostream", &base,
                 nullptr);
    return base != nullptr && G_IS_SOCKET_CONNECTION(base)
               ? g_socket_connection_get_socket(G_SOCKET_CONNECTION(base))
               : nullptr;
  }

  /// libsoup reads on for as long as there is something to read, which a server that floods may
  /// keep up for ever. It reads nothing from a closed socket.
  void stop_reading()
  {
    if (GSocket *const socket = base_socket())
      g_socket_close(socket, nullptr);
  }

  void end(const std::string &why)
  {
    if (std::exchange(is_ended_, true))
      return;
    bytes_ += why.size();
    events_.push_back({ SocketEvent::Kind::closed, why });
  }

  static void on_connected(GObject *session, GAsyncResult *result, gpointer data)
  {
    auto *self = static_cast<SoupSocket *>(data);
    g_autoptr(GError) error = nullptr;
    self->is_connecting_ = false;
    self->connection_
        = soup_session_websocket_connect_finish(SOUP_SESSION(session), result, &error);
    if (self->connection_ == nullptr) {
      self->end(error->message);
      return;
    }
    soup_websocket_connection_set_max_incoming_payload_size(self->connection_, kLargestMessage);
    g_signal_connect(self->connection_, "message", G_CALLBACK(on_message), self);
    g_signal_connect(self->connection_, "error", G_CALLBACK(on_error), self);
    g_signal_connect(self->connection_, "closed", G_CALLBACK(on_closed), self);
    self->add({ SocketEvent::Kind::opened });
  }

  static void on_message(SoupWebsocketConnection *, int type, GBytes *bytes, gpointer data)
  {
    gsize size = 0;
    const auto *text = static_cast<const char *>(g_bytes_get_data(bytes, &size));
    if (type == SOUP_WEBSOCKET_DATA_TEXT)
      static_cast<SoupSocket *>(data)->add({ SocketEvent::Kind::message, std::string(text, size) });
  }

  /// The connection is closed afterwards.
  static void on_error(SoupWebsocketConnection *, GError *error, gpointer data)
  {
    static_cast<SoupSocket *>(data)->reason_ = error->message;
  }

  static void on_closed(SoupWebsocketConnection *connection, gpointer data)
  {
    auto *self = static_cast<SoupSocket *>(data);
    const int code = soup_websocket_connection_get_close_code(connection);
    const std::string why = !self->reason_.empty() ? self->reason_
                            : code != 0            ? "it said goodbye, code " + std::to_string(code)
                                                   : "it hung up";
    self->end(why);
  }

  GMainContext *const context_;
  GCancellable *const cancellable_;
  GSource *alarm_ = nullptr;
  SoupSession *session_ = nullptr;
  SoupWebsocketConnection *connection_ = nullptr;
  std::deque<SocketEvent> events_;
  std::size_t bytes_ = 0; ///< of texts in events_
  std::string reason_;    ///< of an error
  std::atomic<bool> woken_ = false;
  bool is_connecting_ = false;
  bool is_ended_ = false;   ///< the last event was added
  bool is_leaving_ = false; ///< events are no longer read
};

} // namespace

std::unique_ptr<MessageSocket>
open_soup_socket(const std::string &uri)
{
  return std::make_unique<SoupSocket>(uri);
}

} // namespace tactor
