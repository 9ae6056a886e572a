// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sent_file.h"

#include "soup.h"

#include "files/whole_file.h"

#include <algorithm>
#include <fcntl.h>
#include <memory>
#include <sys/stat.h>
#include <unistd.h>

namespace {

constexpr std::size_t kPiece = 256 * 1024;

/// The rest of a file to send.
struct Sending
{
  files::File file;
  goffset next;
  goffset left;
};

/// Sends the next piece. If the file cannot be read on, the connection ends.
void
send_piece(SoupServerMessage *message, Sending &sending)
{
  SoupMessageBody *body = soup_server_message_get_response_body(message);
  const auto wanted = static_cast<gsize>(std::min<goffset>(sending.left, kPiece));
  if (wanted == 0)
    return;
  auto *bytes = static_cast<guchar *>(g_malloc(wanted));
  const ssize_t count = pread(sending.file.descriptor(), bytes, wanted, sending.next);
  if (count <= 0) {
    g_free(bytes);
    g_socket_shutdown(soup_server_message_get_socket(message), TRUE, TRUE, nullptr);
    return;
  }
  soup_message_body_append_take(body, bytes, static_cast<gsize>(count));
  sending.next += count;
  sending.left -= count;
  if (sending.left == 0)
    soup_message_body_complete(body);
}

} // namespace

void
answer_file(SoupServerMessage *message, const std::string &path, const char *type)
{
  tl::expected<files::File, files::Error> opened = files::open_regular(path);
  struct stat found
  {
  };
  if (!opened || fstat(opened->descriptor(), &found) != 0)
    return answer_error(message, 404,
                        opened ? files::file_error(path)
                               : "'" + path + "': " + opened.error().reason);
  files::File file = *std::move(opened);
  SoupMessageHeaders *asked = soup_server_message_get_request_headers(message);
  SoupMessageHeaders *headers = soup_server_message_get_response_headers(message);
  const goffset size = found.st_size;
  goffset first = 0;
  goffset last = size - 1;
  guint status = 200;
  if (!header(message, "Range").empty()) {
    SoupRange *ranges = nullptr;
    int count = 0;
    if (soup_message_headers_get_ranges(asked, size, &ranges, &count)) {
      if (count == 1 && ranges[0].start >= 0 && ranges[0].start < size
          && ranges[0].end >= ranges[0].start) {
        status = 206;
        first = ranges[0].start;
        last = std::min<goffset>(ranges[0].end, size - 1);
      } else if (count == 1) {
        status = 416;
      }
      soup_message_headers_free_ranges(asked, ranges);
    } else if (header(message, "Range").starts_with("bytes=")) {
      status = 416;
    }
    soup_message_headers_remove(asked, "Range"); // it is done with
  }
  soup_message_headers_replace(headers, "Accept-Ranges", "bytes");
  if (status == 416) {
    soup_message_headers_replace(headers, "Content-Range",
                                 ("bytes */" + std::to_string(size)).c_str());
    return answer_error(message, status,
                        "expected a range within " + std::to_string(size) + " bytes");
  }
  soup_server_message_set_status(message, status, nullptr);
  soup_message_headers_set_content_type(headers, type, nullptr);
  if (status == 206)
    soup_message_headers_set_content_range(headers, first, last, size);
  soup_message_headers_set_encoding(headers, SOUP_ENCODING_CONTENT_LENGTH);
  soup_message_headers_set_content_length(headers, last - first + 1);
  if (std::string_view(soup_server_message_get_method(message)) == "HEAD")
    return;
  soup_message_body_set_accumulate(soup_server_message_get_response_body(message), FALSE);
  auto *sending = new Sending{ .file = std::move(file), .next = first, .left = last - first + 1 };
  g_signal_connect_data(
      message, "wrote-chunk", G_CALLBACK(+[](SoupServerMessage *of, gpointer data) {
        send_piece(of, *static_cast<Sending *>(data));
      }),
      sending, +[](gpointer data, GClosure *) { delete static_cast<Sending *>(data); },
      G_CONNECT_DEFAULT);
  send_piece(message, *sending);
}
