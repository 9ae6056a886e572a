# SPDX-License-Identifier: LGPL-2.1-or-later
"""A real Chromium without a screen, and a server of files for tests of the desk's modules."""
import contextlib
import functools
import http.server
import os
import tempfile
import threading

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

# As the desk sends it.
POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; media-src 'self' blob:; connect-src 'self'; "
          "base-uri 'none'; form-action 'none'; frame-ancestors 'none'")
OPTIONS = ("--headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
           "--disable-component-update --disable-sync --autoplay-policy=no-user-gesture-required")


@contextlib.contextmanager
def chromium(width=1280, height=800, scale=1):
    """A driver of a Chromium with a profile of its own; both are gone in the end."""
    with tempfile.TemporaryDirectory(prefix="desk-chromium-", ignore_cleanup_errors=True) as profile:
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for option in [*OPTIONS.split(), f"--user-data-dir={profile}", f"--window-size={width},{height}", f"--force-device-scale-factor={scale}"]:
            options.add_argument(option)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver", env=os.environ | {"HOME": profile}), options=options)
        try:
            driver.set_script_timeout(120)
            yield driver
        finally:
            driver.quit()


class _Files(http.server.SimpleHTTPRequestHandler):
    extensions_map = http.server.SimpleHTTPRequestHandler.extensions_map | {".js": "text/javascript", ".html": "text/html; charset=utf-8"}

    def __init__(self, policy, *arguments, **named):
        self.policy = policy
        super().__init__(*arguments, **named)

    def end_headers(self):
        if self.policy:
            self.send_header("Content-Security-Policy", self.policy)
        self.send_header("Cache-Control", "no-store")
        super().end_headers()

    def log_message(self, *arguments):
        pass


@contextlib.contextmanager
def files(root, policy=POLICY):
    """The address of a server of the files below root. With the desk's policy, by default, nothing is made of strings."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(_Files, policy, directory=str(root)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()
