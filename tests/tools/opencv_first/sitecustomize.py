# SPDX-License-Identifier: LGPL-2.1-or-later
"""For `meson test --setup=opencv_first`: every Python process imports these first, like opencv_first.py."""
import cv2
import scipy.linalg
