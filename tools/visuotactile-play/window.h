// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib.h>

#include <functional>
#include <memory>
#include <string>

struct _XDisplay;

/// The film's window of an X server, at the film's size. Main context's thread, but handle().
class PlayWindow
{
public:
  struct Events
  {
    std::function<void(const std::string &key)> pressed; ///< a name of X11/keysymdef.h
    std::function<void()> changed; ///< its size, or a part of it is to be drawn again
    std::function<void()> closed;  ///< by the user; it stays until its end
  };

  /// A film that is larger than the screen is made smaller. Null: there is no X server.
  static std::unique_ptr<PlayWindow> open(int width, int height, Events events);
  ~PlayWindow();
  PlayWindow(const PlayWindow &) = delete;
  PlayWindow &operator=(const PlayWindow &) = delete;

  /// For GstVideoOverlay.
  guintptr handle() const
  {
    return window_;
  }
  void set_title(const std::string &title);
  bool is_full_screen() const
  {
    return is_full_;
  }
  void set_full_screen(bool full);

private:
  PlayWindow(_XDisplay *display, int width, int height, Events events);
  void look();

  std::unique_ptr<_XDisplay, int (*)(_XDisplay *)> display_;
  int width_;
  int height_;
  Events events_;
  gulong window_ = 0;
  gulong close_ = 0; ///< the atom
  guint source_ = 0;
  bool is_full_ = false;
};
