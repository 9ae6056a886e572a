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

/// Whether the name ends in .png or .svg.
bool is_picture_name(const std::string &path);

/// Draws a picture of `width` by `height` units and writes it as PNG or SVG, by the name's ending.
/// A PNG has `scale` pixels per unit. Throws std::runtime_error, and leaves no partial file.
void write_picture(const std::string &path, double width, double height, double scale,
                   const std::function<void(cairo_t *)> &draw);
