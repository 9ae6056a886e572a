// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair_picture.h"

#include "translation.h"

namespace {

constexpr int kWidth = 260;
constexpr int kHeight = 300;
constexpr int kListed = 4; ///< motors in a row where their places are not known

} // namespace

ChairPicture::ChairPicture(std::function<void(int)> press) : press_(std::move(press))
{
  GtkWidget *area = gtk_drawing_area_new();
  gtk_drawing_area_set_content_width(GTK_DRAWING_AREA(area), kWidth);
  gtk_drawing_area_set_content_height(GTK_DRAWING_AREA(area), kHeight);
  gtk_drawing_area_set_draw_func(
      GTK_DRAWING_AREA(area),
      +[](GtkDrawingArea *, cairo_t *cairo, int width, int height, gpointer self) {
        static_cast<ChairPicture *>(self)->draw(cairo, width, height);
      },
      this, nullptr);
  gtk_overlay_set_child(GTK_OVERLAY(overlay_), area);
  gtk_overlay_add_overlay(GTK_OVERLAY(overlay_), grid_);
  gtk_overlay_set_measure_overlay(GTK_OVERLAY(overlay_), grid_, TRUE);
  gtk_grid_set_row_spacing(GTK_GRID(grid_), 4);
  gtk_grid_set_column_spacing(GTK_GRID(grid_), 4);
  gtk_widget_set_halign(grid_, GTK_ALIGN_CENTER);
  gtk_widget_set_valign(grid_, GTK_ALIGN_START);
  gtk_widget_set_margin_top(grid_, 44);
  gtk_widget_set_margin_bottom(grid_, 100);
  gtk_widget_set_halign(overlay_, GTK_ALIGN_CENTER);
}

void
ChairPicture::draw(cairo_t *cairo, int width, int height) const
{
  GdkRGBA color{};
  gtk_style_context_get_color(gtk_widget_get_style_context(overlay_), &color);
  color.alpha = 0.25F;
  gdk_cairo_set_source_rgba(cairo, &color);
  const double w = width;
  const double h = height;
  const auto block = [&](double left, double top, double right, double bottom) {
    constexpr double kRound = 14;
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, right - kRound, top + kRound, kRound, -G_PI_2, 0);
    cairo_arc(cairo, right - kRound, bottom - kRound, kRound, 0, G_PI_2);
    cairo_arc(cairo, left + kRound, bottom - kRound, kRound, G_PI_2, G_PI);
    cairo_arc(cairo, left + kRound, top + kRound, kRound, G_PI, 3 * G_PI_2);
    cairo_close_path(cairo);
    cairo_fill(cairo);
  };
  block(w * 0.5 - 40, 0, w * 0.5 + 40, 32);   // for the head
  block(10, 34, w - 10, h - 90);              // back
  block(0, h - 86, w, h - 44);                // seat
  cairo_rectangle(cairo, 24, h - 42, 10, 42); // legs
  cairo_rectangle(cairo, w - 34, h - 42, 10, 42);
  cairo_fill(cairo);
}

void
ChairPicture::put(const std::string &motor, int column, int row)
{
  GtkWidget *button = gtk_button_new_with_label(std::to_string(motors_.size() + 1).c_str());
  name(button, motor.c_str());
  gtk_widget_set_tooltip_text(button, motor.c_str());
  gtk_widget_add_css_class(button, "motor");
  const int number = static_cast<int>(motors_.size()) + 1;
  connect(button, "clicked", [this, number] { press_(number); });
  gtk_grid_attach(GTK_GRID(grid_), button, column, row, 1, 1);
  motors_.push_back(button);
}

void
ChairPicture::show_grid(unsigned rows, unsigned columns)
{
  show_none();
  for (unsigned r = 0; r < rows; r++)
    for (unsigned c = 0; c < columns; c++) {
      const std::string place = in_text("row {}", std::to_string(r + 1)) + ", "
                                + in_text("column {}", std::to_string(c + 1));
      put(place, static_cast<int>(c), static_cast<int>(r));
    }
}

void
ChairPicture::show_none()
{
  for (GtkWidget *motor : motors_)
    gtk_grid_remove(GTK_GRID(grid_), motor);
  motors_.clear();
}

std::string
ChairPicture::light(int number, const std::string &motor)
{
  if (number == static_cast<int>(motors_.size()) + 1)
    put(motor, (number - 1) % kListed, (number - 1) / kListed);
  std::string shown = motor;
  for (std::size_t i = 0; i < motors_.size(); i++)
    if (static_cast<int>(i) + 1 == number) {
      gtk_widget_add_css_class(motors_[i], "felt");
      shown = gtk_widget_get_tooltip_text(motors_[i]);
    } else {
      gtk_widget_remove_css_class(motors_[i], "felt");
    }
  return shown;
}
