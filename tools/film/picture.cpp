// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture.h"

#include "output.h"
#include "translation.h"

#include <cairo-svg.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>

bool
is_picture_name(const std::string &path)
{
  return path.ends_with(".png") || path.ends_with(".svg");
}

void
write_picture(const std::string &path, double width, double height, double scale,
              const std::function<void(cairo_t *)> &draw)
{
  const std::filesystem::path name = std::filesystem::absolute(path);
  Output file(name.parent_path(), name.filename());
  const bool is_svg = path.ends_with(".svg");
  const Surface surface(is_svg ? cairo_svg_surface_create(file.part_path().c_str(), width, height)
                               : cairo_image_surface_create(
                                   CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(width * scale)),
                                   static_cast<int>(std::ceil(height * scale))));
  {
    const Context context(cairo_create(surface.get()));
    if (!is_svg)
      cairo_scale(context.get(), scale, scale);
    draw(context.get());
  }
  cairo_status_t status = CAIRO_STATUS_SUCCESS;
  if (!is_svg)
    status = cairo_surface_write_to_png(surface.get(), file.part_path().c_str());
  cairo_surface_finish(surface.get());
  if (status == CAIRO_STATUS_SUCCESS)
    status = cairo_surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(
        in_text("cannot write '{}': {}", path, cairo_status_to_string(status)));
  file.commit();
}
