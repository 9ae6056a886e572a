# SPDX-License-Identifier: LGPL-2.1-or-later
"""For `meson test --setup=opencv_first`: every Python imports these before all else, as opencv_first.py does."""
import cv2
import scipy.linalg
