// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

/// A screen of the X server.
struct Monitor
{
  std::string name; ///< "HDMI-1"
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

struct _XDisplay;

/// The screens, the primary one first; empty: there is no X server.
std::vector<Monitor> monitors();

/// The screen of that name as it is now. Throws std::runtime_error if it is gone.
Monitor monitor(const std::string &name);

/// A black window over a whole screen, without a pointer, and in its middle one for the film. Main
/// context's thread.
class FilmWindow
{
public:
  /// `left` is called when Escape or Q is pressed, or a window manager closes or hides the window.
  /// It may delete this. A film that is larger than the screen is made smaller. Throws
  /// std::runtime_error.
  FilmWindow(const Monitor &screen, int width, int height, std::function<void()> left);
  ~FilmWindow();
  FilmWindow(const FilmWindow &) = delete;
  FilmWindow &operator=(const FilmWindow &) = delete;

  /// The film's window, for GstVideoOverlay.
  guintptr handle() const
  {
    return film_;
  }
  int width() const
  {
    return width_;
  }
  int height() const
  {
    return height_;
  }

private:
  void place(const Monitor &screen);
  void look();

  std::unique_ptr<_XDisplay, int (*)(_XDisplay *)> display_;
  int width_;
  int height_;
  std::function<void()> left_;
  gulong window_ = 0;
  gulong film_ = 0;
  gulong close_ = 0; ///< the atom
  guint source_ = 0;
};
