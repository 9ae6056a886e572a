# SPDX-License-Identifier: LGPL-2.1-or-later
"""The chair follows this Kodi: starts visuotactile-follow, unless one runs, and ends it, with all motors at zero, when Kodi ends.
Copy this folder to ~/.kodi/addons and enable it in Kodi's settings."""

import subprocess

import xbmc

PROGRAM = "visuotactile-follow"


def serve(monitor):
    if subprocess.run([PROGRAM, "--status"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode == 0:
        monitor.waitForAbort()
        return
    with subprocess.Popen([PROGRAM, "--quiet"], stderr=subprocess.PIPE, text=True) as follower:
        while not monitor.waitForAbort(1):
            if follower.poll() is not None:
                xbmc.log(f"{PROGRAM}: {follower.stderr.read()}", xbmc.LOGERROR)
                return
        follower.terminate()
        follower.communicate()


try:
    serve(xbmc.Monitor())
except OSError as error:
    xbmc.log(f"{PROGRAM} cannot be started: {error}", xbmc.LOGERROR)
