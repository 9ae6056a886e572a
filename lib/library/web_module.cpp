// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The module visuotactile-web: one GET request, by libsoup.
#include "library/web.h"

#include <gmodule.h>
#include <libsoup/soup.h>

#include <array>
#include <memory>

namespace {

struct Unref
{
  void operator()(gpointer object) const
  {
    g_object_unref(object);
  }
};
template <typename Object> using Owned = std::unique_ptr<Object, Unref>;

/// One request in a main context of its own, so that a timer can end it at any step.
class Request
{
public:
  Request(const library::Query &query, std::string &body)
      : query_(query), stop_(query.stop), body_(body), context_(g_main_context_new()),
        cancel_(g_cancellable_new())
  {
    g_main_context_push_thread_default(context_);
    session_.reset(soup_session_new());
    GSource *timer = g_timeout_source_new_seconds(library::kPatience);
    g_source_set_callback(
        timer,
        +[](gpointer self) -> gboolean {
          static_cast<Request *>(self)->is_late_ = true;
          g_cancellable_cancel(static_cast<Request *>(self)->cancel_.get());
          return G_SOURCE_REMOVE;
        },
        this, nullptr);
    g_source_attach(timer, context_);
    g_source_unref(timer);
    if (stop_ != nullptr)
      connected_
          = g_cancellable_connect(stop_, G_CALLBACK(+[](GCancellable *, gpointer cancel) {
                                    g_cancellable_cancel(static_cast<GCancellable *>(cancel));
                                  }),
                                  cancel_.get(), nullptr);
  }
  ~Request()
  {
    if (stop_ != nullptr)
      g_cancellable_disconnect(stop_, connected_);
    stream_.reset();
    session_.reset();
    g_main_context_pop_thread_default(context_);
    g_main_context_unref(context_);
  }
  Request(const Request &) = delete;
  Request &operator=(const Request &) = delete;

  /// Returns the fault; empty: none.
  std::string run()
  {
    const Owned<SoupMessage> message(soup_message_new("GET", query_.address.c_str()));
    if (!message)
      return "expected an address";
    soup_message_add_flags(message.get(), SOUP_MESSAGE_NO_REDIRECT);
    for (const auto &[name, value] : query_.headers)
      soup_message_headers_append(soup_message_get_request_headers(message.get()), name.c_str(),
                                  value.c_str());
    soup_session_send_async(session_.get(), message.get(), G_PRIORITY_DEFAULT, cancel_.get(),
                            on_result, this);
    stream_.reset(soup_session_send_finish(session_.get(), wait(), &error_));
    g_clear_object(&result_);
    if (!stream_)
      return failure();
    if (const auto status = soup_message_get_status(message.get()); status != SOUP_STATUS_OK) {
      const char *where = soup_message_headers_get_one(
          soup_message_get_response_headers(message.get()), "Location");
      return "expected status 200, got status " + std::to_string(status) + "; "
             + (SOUP_STATUS_IS_REDIRECTION(status) && where != nullptr
                    ? "redirects are not followed: give the address to which it leads"
                    : query_.advice);
    }
    std::array<char, 16384> piece{};
    while (true) {
      g_input_stream_read_async(stream_.get(), piece.data(), piece.size(), G_PRIORITY_DEFAULT,
                                cancel_.get(), on_result, this);
      const gssize count = g_input_stream_read_finish(stream_.get(), wait(), &error_);
      g_clear_object(&result_);
      if (count < 0)
        return failure();
      if (count == 0)
        return "";
      if (body_.size() + static_cast<std::size_t>(count) > query_.most)
        return "expected at most " + std::to_string(query_.most) + " bytes, got more";
      body_.append(piece.data(), static_cast<std::size_t>(count));
    }
  }

private:
  static void on_result(GObject *, GAsyncResult *result, gpointer self)
  {
    static_cast<Request *>(self)->result_ = G_ASYNC_RESULT(g_object_ref(result));
  }

  GAsyncResult *wait()
  {
    while (result_ == nullptr)
      g_main_context_iteration(context_, TRUE);
    return result_;
  }

  std::string failure()
  {
    const std::string why
        = is_late_
              ? "expected an answer within " + std::to_string(library::kPatience)
                    + " s, got none; is the server running?"
              : std::string("cannot be fetched: ") + error_->message + "; is the server running?";
    g_clear_error(&error_);
    return why;
  }

  const library::Query &query_;
  GCancellable *const stop_;
  std::string &body_;
  GMainContext *const context_;
  const Owned<GCancellable> cancel_;
  Owned<SoupSession> session_;
  Owned<GInputStream> stream_;
  GAsyncResult *result_ = nullptr;
  GError *error_ = nullptr;
  gulong connected_ = 0;
  bool is_late_ = false;
};

} // namespace

extern "C" G_MODULE_EXPORT bool
visuotactile_fetch(const library::Query &query, std::string &body, std::string &error)
{
  error = Request(query, body).run();
  return error.empty();
}
