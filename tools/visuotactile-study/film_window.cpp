// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_window.h"
#include "translation.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/Xrandr.h>
#include <X11/keysym.h>

#include <glib-unix.h>

#include <algorithm>
#include <stdexcept>

namespace {

std::unique_ptr<Display, int (*)(Display *)>
open_display()
{
  // The default handler ends the program, as if a window that a window manager hides were a fault.
  XSetErrorHandler([](Display *, XErrorEvent *) { return 0; });
  return { XOpenDisplay(nullptr), XCloseDisplay };
}

/// A pointer that is not seen.
Cursor
no_pointer(Display *display, Window window)
{
  const char nothing = 0;
  XColor black{};
  const Pixmap empty = XCreateBitmapFromData(display, window, &nothing, 1, 1);
  const Cursor cursor = XCreatePixmapCursor(display, empty, empty, &black, &black, 0, 0);
  XFreePixmap(display, empty);
  return cursor;
}

} // namespace

std::vector<Monitor>
monitors()
{
  std::vector<Monitor> found;
  const auto display = open_display();
  if (!display)
    return found;
  int count = 0;
  XRRMonitorInfo *infos
      = XRRGetMonitors(display.get(), DefaultRootWindow(display.get()), True, &count);
  for (int i = 0; i < count; i++) {
    const XRRMonitorInfo &one = infos[i];
    char *name = XGetAtomName(display.get(), one.name);
    found.insert(one.primary ? found.begin() : found.end(), { .name = name ? name : "",
                                                              .x = one.x,
                                                              .y = one.y,
                                                              .width = one.width,
                                                              .height = one.height });
    if (name)
      XFree(name);
  }
  if (infos)
    XRRFreeMonitors(infos);
  if (found.empty()) // a server without RandR
    found.push_back({ .name = "whole",
                      .width = DisplayWidth(display.get(), DefaultScreen(display.get())),
                      .height = DisplayHeight(display.get(), DefaultScreen(display.get())) });
  return found;
}

Monitor
monitor(const std::string &name)
{
  const std::vector<Monitor> all = monitors();
  const auto found = std::ranges::find(all, name, &Monitor::name);
  if (found == all.end())
    throw std::runtime_error(
        in_text("the screen '{}' is gone; connect it, or start again with another --screen", name));
  return *found;
}

FilmWindow::FilmWindow(const Monitor &screen, int width, int height, std::function<void()> left)
    : display_(open_display()), width_(width), height_(height), left_(std::move(left))
{
  Display *display = display_.get();
  if (display == nullptr)
    throw std::runtime_error(_("the X server has gone; expected the one of the start"));
  const double scale = std::min({ 1.0, static_cast<double>(screen.width) / width,
                                  static_cast<double>(screen.height) / height });
  width_ = std::max(1, static_cast<int>(width * scale));
  height_ = std::max(1, static_cast<int>(height * scale));
  window_ = XCreateSimpleWindow(display, DefaultRootWindow(display), screen.x, screen.y,
                                static_cast<unsigned>(screen.width),
                                static_cast<unsigned>(screen.height), 0, 0, 0);
  film_ = XCreateSimpleWindow(display, window_, 0, 0, static_cast<unsigned>(width_),
                              static_cast<unsigned>(height_), 0, 0, 0);
  place(screen);
  XStoreName(display, window_, "Film");
  XSizeHints hints{};
  hints.flags = USPosition | USSize;
  XSetWMNormalHints(display, window_, &hints);
  const auto atom = [&](const char *name) {
    return XInternAtom(display, name, False);
  };
  Atom whole = atom("_NET_WM_STATE_FULLSCREEN");
  XChangeProperty(display, window_, atom("_NET_WM_STATE"), XA_ATOM, 32, PropModeReplace,
                  reinterpret_cast<unsigned char *>(&whole), 1);
  close_ = atom("WM_DELETE_WINDOW");
  XSetWMProtocols(display, window_, &close_, 1);
  const Cursor cursor = no_pointer(display, window_);
  XDefineCursor(display, window_, cursor);
  XFreeCursor(display, cursor);
  XSelectInput(display, window_, KeyPressMask | StructureNotifyMask);
  XSelectInput(display, film_, KeyPressMask);
  XMapWindow(display, film_);
  XMapRaised(display, window_);
  XFlush(display);
  source_ = g_unix_fd_add(
      ConnectionNumber(display), G_IO_IN,
      +[](gint, GIOCondition, gpointer self) -> gboolean {
        static_cast<FilmWindow *>(self)->look();
        return G_SOURCE_CONTINUE;
      },
      this);
}

FilmWindow::~FilmWindow()
{
  g_source_remove(source_);
  XDestroyWindow(display_.get(), window_);
}

/// The film in the middle.
void
FilmWindow::place(const Monitor &screen)
{
  XMoveWindow(display_.get(), film_, (screen.width - width_) / 2, (screen.height - height_) / 2);
}

void
FilmWindow::look()
{
  while (XPending(display_.get()) > 0) {
    XEvent event;
    XNextEvent(display_.get(), &event);
    const KeySym key = event.type == KeyPress ? XLookupKeysym(&event.xkey, 0) : NoSymbol;
    const bool is_closed
        = (event.type == ClientMessage && static_cast<Atom>(event.xclient.data.l[0]) == close_)
          || (event.type == UnmapNotify && event.xunmap.window == window_);
    if (key == XK_Escape || key == XK_q || is_closed)
      return std::function(left_)(); // may delete this
    if (event.type == MapNotify)
      XSetInputFocus(display_.get(), window_, RevertToPointerRoot, CurrentTime);
    if (event.type == ConfigureNotify && event.xconfigure.window == window_)
      place({ .width = event.xconfigure.width, .height = event.xconfigure.height });
  }
  XFlush(display_.get());
}
