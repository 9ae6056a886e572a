// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "gtk.h"

#include <functional>
#include <vector>

/// A chair with a button for each motor.
class ChairPicture
{
public:
  /// `press` gets the number of a motor, from 1.
  explicit ChairPicture(std::function<void(int)> press);

  GtkWidget *widget() const
  {
    return overlay_;
  }

  /// Motors in rows and columns on the back of a chair.
  void show_grid(unsigned rows, unsigned columns);
  /// No motors: the names come with the feel test.
  void show_none();
  /// Lights motor `number`, from 1, alone; 0: none. One that is new joins the others. Returns its
  /// name in the user's language.
  std::string light(int number, const std::string &name);

private:
  void put(const std::string &name, int column, int row);
  void draw(cairo_t *cairo, int width, int height) const;

  std::function<void(int)> press_;
  GtkWidget *overlay_ = gtk_overlay_new();
  GtkWidget *grid_ = gtk_grid_new();
  std::vector<GtkWidget *> motors_{};
};
