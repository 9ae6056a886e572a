// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Plays a launch line and leaves all signals to their default action. A word on its standard input
// ends it in another way.
#include <cstdlib>
#include <iostream>
#include <string>
#include <unistd.h>

#include <gst/gst.h>

int
main(int argc, char **argv)
{
  gst_init(nullptr, nullptr);
  GError *error = nullptr;
  GstElement *pipeline = gst_parse_launchv(const_cast<const gchar **>(argv + 1), &error);
  if (argc < 2 || error)
    g_error("expected a launch line: %s", error ? error->message : "got none");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  std::string word;
  std::cin >> word;
  if (word == "exec")
    execl("/bin/true", "true", nullptr);
  else if (word == "_exit")
    _exit(3);
  else if (word == "quick_exit")
    std::quick_exit(3);
  else if (word == "abort")
    std::abort();
  return 3; // exit() without NULL
}
