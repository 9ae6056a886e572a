// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cairo.h>

#include <functional>
#include <memory>
#include <string>

struct FreeCairo
{
  void operator()(cairo_surface_t *surface) const
  {
    cairo_surface_destroy(surface);
  }
  void operator()(cairo_t *context) const
  {
    cairo_destroy(context);
  }
};
using Surface = std::unique_ptr<cairo_surface_t, FreeCairo>;
using Context = std::unique_ptr<cairo_t, FreeCairo>;

/// Whether a picture can be written to a file of that name: it ends in .png or .svg.
bool is_picture_name(const std::string &path);

/// Draws a picture of so many units and writes it, whole or not at all, as PNG or SVG by the name's
/// ending; a PNG has `scale` pixels to the unit. Throws std::runtime_error with the file and the
/// reason.
void write_picture(const std::string &path, double width, double height, double scale,
                   const std::function<void(cairo_t *)> &draw);
