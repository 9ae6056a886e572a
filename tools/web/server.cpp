// SPDX-License-Identifier: LGPL-2.1-or-later
#include "server.h"

#include "soup.h"

#include <glib-unix.h>

#include <csignal>
#include <vector>

namespace {

/// The key under which on_headers() stores the path after the token for on_request().
constexpr const char *kPath = "site-path";

/// Answers at once and ends the connection, whatever else arrives.
void
cut_off(SoupServerMessage *message, goffset most)
{
  const std::string body = "{\"error\": \"expected at most " + std::to_string(most) + " bytes\"}";
  const std::string text = "HTTP/1.1 413 Payload Too Large\r\nConnection: close\r\n"
                           "Content-Type: application/json\r\nContent-Length: "
                           + std::to_string(body.size()) + "\r\n\r\n" + body;
  GSocket *socket = soup_server_message_get_socket(message);
  if (socket == nullptr)
    return;
  g_socket_set_blocking(socket, FALSE);
  g_socket_send(socket, text.data(), text.size(), nullptr,
                nullptr);          // as much as fits, which is all
  g_socket_close(socket, nullptr); // the next read of it fails, which ends the message
}

/// Counts the bytes of a body, whose length may be unknown.
struct Counted
{
  goffset left;
  goffset most;
};

void
watch_body(SoupServerMessage *message, goffset most)
{
  g_signal_connect_data(
      message, "got-chunk", G_CALLBACK(+[](SoupServerMessage *of, GBytes *chunk, gpointer data) {
        auto *counted = static_cast<Counted *>(data);
        const bool was_within = counted->left >= 0;
        counted->left -= static_cast<goffset>(g_bytes_get_size(chunk));
        if (counted->left >= 0 || !was_within)
          return;
        soup_message_body_set_accumulate(soup_server_message_get_request_body(of), FALSE);
        cut_off(of, counted->most);
      }),
      new Counted{ .left = most, .most = most },
      +[](gpointer data, GClosure *) { delete static_cast<Counted *>(data); }, G_CONNECT_DEFAULT);
}

} // namespace

guint16
usual_port(const std::string &file)
{
  constexpr guint kFirst = 61000;
  return static_cast<guint16>(kFirst + g_str_hash(file.c_str()) % (65536 - kFirst));
}

void
run_until_signal()
{
  const std::unique_ptr<GMainLoop, void (*)(GMainLoop *)> loop(g_main_loop_new(nullptr, FALSE),
                                                               g_main_loop_unref);
  std::vector<guint> sources;
  for (const int number : { SIGINT, SIGTERM, SIGHUP })
    sources.push_back(g_unix_signal_add(
        number,
        +[](gpointer of) -> gboolean {
          g_main_loop_quit(static_cast<GMainLoop *>(of));
          return G_SOURCE_CONTINUE;
        },
        loop.get()));
  g_main_loop_run(loop.get());
  for (const guint source : sources)
    g_source_remove(source);
}

Server::Server(const Settings &settings, Site &site)
    : site_(site), inline_styles_(settings.inline_styles),
      server_(soup_server_new("server-header", "visuotactile", nullptr))
{
  try {
    connections_ = std::make_unique<Connections>(server_, settings.port, settings.usual);
    guard_ = std::make_unique<Guard>(connections_->port(),
                                     settings.token.empty() ? random_token() : settings.token,
                                     settings.program);
  } catch (...) {
    g_object_unref(server_);
    throw;
  }
  soup_server_add_early_handler(
      server_, nullptr,
      +[](SoupServer *, SoupServerMessage *message, const char *, GHashTable *, gpointer self) {
        static_cast<Server *>(self)->on_headers(message);
      },
      this, nullptr);
  soup_server_add_handler(
      server_, nullptr,
      +[](SoupServer *, SoupServerMessage *message, const char *, GHashTable *, gpointer self) {
        static_cast<Server *>(self)->on_request(message);
      },
      this, nullptr);
}

Server::~Server()
{
  soup_server_disconnect(server_);
  connections_.reset();
  g_object_unref(server_);
}

void
Server::on_headers(SoupServerMessage *message)
{
  add_common_headers(message, inline_styles_);
  const auto path = guard_->admit(message);
  if (!path) {
    soup_message_body_set_accumulate(soup_server_message_get_request_body(message), FALSE);
    watch_body(message, Site::kLargestBody);
    return;
  }
  connections_->admit(message);
  const std::string methods = site_.methods(*path);
  const std::string method = soup_server_message_get_method(message);
  const goffset most = site_.largest_body(*path);
  const goffset length
      = soup_message_headers_get_content_length(soup_server_message_get_request_headers(message));
  if ((", " + methods + ",").find(" " + method + ",") == std::string::npos) {
    soup_message_headers_replace(soup_server_message_get_response_headers(message), "Allow",
                                 methods.c_str());
    answer_error(message, 405, "expected the method " + methods);
  } else if (length > most) {
    soup_message_body_set_accumulate(soup_server_message_get_request_body(message), FALSE);
    soup_server_message_set_status(message, 413, nullptr); // no handler
    return cut_off(message, most);
  }
  watch_body(message, most);
  g_object_set_data_full(G_OBJECT(message), kPath, g_strdup(path->c_str()), g_free);
}

void
Server::on_request(SoupServerMessage *message)
{
  const auto *path = static_cast<const char *>(g_object_get_data(G_OBJECT(message), kPath));
  if (path == nullptr || soup_server_message_get_status(message) != SOUP_STATUS_NONE)
    return;
  try {
    site_.answer(message, path);
  } catch (const std::exception &error) { // the motors would stay as they are
    answer_error(message, 500, error.what());
  }
}
