# SPDX-License-Identifier: LGPL-2.1-or-later
"""mpv's IPC socket, told by a test."""
import json
import socket


class MpvSocket:
    def __init__(self, path):
        self.path = path
        self.line = socket.socket(socket.AF_UNIX)

    def connects(self):
        """Whether mpv has its socket by now."""
        try:
            self.line.connect(self.path)
        except OSError:
            return False
        return True

    def command(self, *words):
        self.line.sendall((json.dumps({"command": words}) + "\n").encode())
