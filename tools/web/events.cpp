// SPDX-License-Identifier: LGPL-2.1-or-later
#include "events.h"

Events::Events(std::function<void(const std::string &page)> left)
    : left_(std::move(left)), tick_(g_timeout_add_seconds(
                                  1,
                                  +[](gpointer self) -> gboolean {
                                    // Also finds pages that are gone.
                                    static_cast<Events *>(self)->send(":\n\n");
                                    return G_SOURCE_CONTINUE;
                                  },
                                  this))
{
}

Events::~Events()
{
  g_source_remove(tick_);
  for (Stream &stream : streams_) {
    g_signal_handlers_disconnect_by_data(stream.message, &stream);
    g_object_unref(stream.message);
  }
}

std::string
Events::event(const char *name, const std::string &json)
{
  return std::string("event: ") + name + "\ndata: " + json + "\n\n";
}

void
Events::write(SoupServerMessage *message, const std::string &text)
{
  soup_message_body_append(soup_server_message_get_response_body(message), SOUP_MEMORY_COPY,
                           text.data(), text.size());
  soup_server_message_unpause(message);
}

void
Events::add(SoupServerMessage *message, const std::string &page, const std::string &first)
{
  SoupMessageHeaders *headers = soup_server_message_get_response_headers(message);
  soup_server_message_set_status(message, 200, nullptr);
  soup_message_headers_set_content_type(headers, "text/event-stream", nullptr);
  soup_message_headers_set_encoding(headers, SOUP_ENCODING_CHUNKED);
  SoupMessageBody *body = soup_server_message_get_response_body(message);
  soup_message_body_set_accumulate(body, FALSE);
  soup_message_body_append(body, SOUP_MEMORY_COPY, first.data(), first.size());
  streams_.push_back(
      { .of = this, .message = SOUP_SERVER_MESSAGE(g_object_ref(message)), .page = page });
  g_signal_connect(message, "finished", G_CALLBACK(+[](SoupServerMessage *, gpointer stream) {
                     static_cast<Stream *>(stream)->of->ended(static_cast<Stream *>(stream));
                   }),
                   &streams_.back());
}

void
Events::send(const std::string &events)
{
  for (const Stream &stream : streams_)
    write(stream.message, events);
}

void
Events::ended(Stream *stream)
{
  const std::string page = stream->page;
  g_signal_handlers_disconnect_by_data(stream->message, stream);
  g_object_unref(stream->message);
  streams_.remove_if([stream](const Stream &one) { return &one == stream; });
  left_(page);
}
