#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Presses keys in a window of the X server in $DISPLAY, as if on a keyboard.

Waits until there is such a window, at most 10 s.

Usage: press_keys.py WIDTH KEY...      the window's width, names of keys as in X11/keysymdef.h
"""
import ctypes
import sys
import time

KEY_PRESS = 2
KEY_PRESS_MASK = 1
Window = ctypes.c_ulong


class KeyEvent(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int), ("display", ctypes.c_void_p),
                ("window", Window), ("root", Window), ("subwindow", Window), ("time", ctypes.c_ulong), ("x", ctypes.c_int),
                ("y", ctypes.c_int), ("x_root", ctypes.c_int), ("y_root", ctypes.c_int), ("state", ctypes.c_uint), ("keycode", ctypes.c_uint),
                ("same_screen", ctypes.c_int)]


class Event(ctypes.Union):
    _fields_ = [("key", KeyEvent), ("pad", ctypes.c_long * 24)]


x = ctypes.CDLL("libX11.so.6")
x.XOpenDisplay.restype = ctypes.c_void_p
x.XDefaultRootWindow.restype = Window
x.XStringToKeysym.restype = ctypes.c_ulong
for function in (x.XDefaultRootWindow, x.XQueryTree, x.XGetGeometry, x.XSendEvent, x.XFlush, x.XKeysymToKeycode, x.XCloseDisplay):
    function.argtypes = None
display = ctypes.c_void_p(x.XOpenDisplay(None))

# Windows of others go at any time.
ignore_errors = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(lambda display, error: 0)
x.XSetErrorHandler(ignore_errors)


def children(window):
    root, parent, count, found = Window(), Window(), ctypes.c_uint(), ctypes.POINTER(Window)()
    if not x.XQueryTree(display, Window(window), ctypes.byref(root), ctypes.byref(parent), ctypes.byref(found), ctypes.byref(count)):
        return []
    return [found[i] for i in range(count.value)]


def width_of(window):
    root, numbers = Window(), [ctypes.c_int(), ctypes.c_int()] + [ctypes.c_uint() for _ in range(4)]
    if not x.XGetGeometry(display, Window(window), ctypes.byref(root), *map(ctypes.byref, numbers)):
        return 0
    return numbers[2].value


def windows(window):
    for child in children(window):
        yield child
        yield from windows(child)


def windows_as_wide(width):
    return [window for window in windows(x.XDefaultRootWindow(display)) if width_of(window) == width]


deadline = time.monotonic() + 10
targets = windows_as_wide(int(sys.argv[1]))
while not targets and time.monotonic() < deadline:
    time.sleep(0.05)
    targets = windows_as_wide(int(sys.argv[1]))
if not targets:
    sys.exit(f"no window is {sys.argv[1]} pixels wide")
for name in sys.argv[2:]:
    code = x.XKeysymToKeycode(display, ctypes.c_ulong(x.XStringToKeysym(name.encode())))
    event = Event()
    event.key = KeyEvent(type=KEY_PRESS, display=display, window=targets[0], keycode=code, same_screen=1)
    x.XSendEvent(display, Window(targets[0]), 0, ctypes.c_long(KEY_PRESS_MASK), ctypes.byref(event))
    x.XFlush(display)
    time.sleep(0.15)
x.XCloseDisplay(display)
