// SPDX-License-Identifier: LGPL-2.1-or-later
#include "window.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <glib-unix.h>

#include <algorithm>
#include <utility>

std::unique_ptr<PlayWindow>
PlayWindow::open(int width, int height, Events events)
{
  // The default handler ends the program, as if a part of the window that its sink takes away late
  // were a fault.
  XSetErrorHandler([](Display *, XErrorEvent *) { return 0; });
  Display *display = XOpenDisplay(nullptr);
  if (display == nullptr)
    return nullptr;
  return std::unique_ptr<PlayWindow>(new PlayWindow(display, width, height, std::move(events)));
}

PlayWindow::PlayWindow(Display *display, int width, int height, Events events)
    : display_(display, XCloseDisplay), events_(std::move(events))
{
  const int screen = DefaultScreen(display);
  const double scale = std::min({ 1.0, DisplayWidth(display, screen) / static_cast<double>(width),
                                  DisplayHeight(display, screen) / static_cast<double>(height) });
  width_ = std::max(1, static_cast<int>(width * scale));
  height_ = std::max(1, static_cast<int>(height * scale));
  window_ = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0,
                                static_cast<unsigned>(width_), static_cast<unsigned>(height_), 0, 0,
                                BlackPixel(display, screen));
  close_ = XInternAtom(display, "WM_DELETE_WINDOW", False);
  XSetWMProtocols(display, window_, &close_, 1);
  XSelectInput(display, window_, KeyPressMask | StructureNotifyMask | ExposureMask);
  XMapRaised(display, window_);
  XSync(display, False); // it is there when the sink draws into it
  source_ = g_unix_fd_add(
      ConnectionNumber(display), G_IO_IN,
      +[](gint, GIOCondition, gpointer self) -> gboolean {
        static_cast<PlayWindow *>(self)->look();
        return G_SOURCE_CONTINUE;
      },
      this);
}

PlayWindow::~PlayWindow()
{
  g_source_remove(source_);
  XDestroyWindow(display_.get(), window_);
}

void
PlayWindow::set_title(const std::string &title)
{
  Xutf8SetWMProperties(display_.get(), window_, title.c_str(), title.c_str(), nullptr, 0, nullptr,
                       nullptr, nullptr);
  XChangeProperty(display_.get(), window_, XInternAtom(display_.get(), "_NET_WM_NAME", False),
                  XInternAtom(display_.get(), "UTF8_STRING", False), 8, PropModeReplace,
                  reinterpret_cast<const unsigned char *>(title.data()),
                  static_cast<int>(title.size()));
  XFlush(display_.get());
}

void
PlayWindow::set_full_screen(bool full)
{
  Display *display = display_.get();
  is_full_ = full;
  const auto atom = [&](const char *name) {
    return XInternAtom(display, name, False);
  };
  int count = 0;
  Atom *properties = XListProperties(display, DefaultRootWindow(display), &count);
  const bool is_managed
      = properties != nullptr
        && std::find(properties, properties + count, atom("_NET_SUPPORTED")) != properties + count;
  if (properties != nullptr)
    XFree(properties);
  if (is_managed) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = window_;
    event.xclient.message_type = atom("_NET_WM_STATE");
    event.xclient.format = 32;
    event.xclient.data.l[0] = full ? 1 : 0; // adds or removes
    event.xclient.data.l[1] = static_cast<long>(atom("_NET_WM_STATE_FULLSCREEN"));
    XSendEvent(display, DefaultRootWindow(display), False,
               SubstructureRedirectMask | SubstructureNotifyMask, &event);
  } else {
    const int screen = DefaultScreen(display);
    XMoveResizeWindow(display, window_, 0, 0,
                      static_cast<unsigned>(full ? DisplayWidth(display, screen) : width_),
                      static_cast<unsigned>(full ? DisplayHeight(display, screen) : height_));
  }
  XFlush(display);
}

void
PlayWindow::look()
{
  while (XPending(display_.get()) > 0) {
    XEvent event;
    XNextEvent(display_.get(), &event);
    if (event.type == KeyPress) {
      if (const char *name = XKeysymToString(XLookupKeysym(&event.xkey, 0)))
        events_.pressed(name);
    } else if (event.type == Expose || event.type == ConfigureNotify) {
      events_.changed();
    } else if (event.type == ClientMessage
               && static_cast<Atom>(event.xclient.data.l[0]) == close_) {
      events_.closed();
    }
  }
}
