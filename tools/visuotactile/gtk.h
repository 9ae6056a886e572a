// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtk/gtk.h>

#include <functional>
#include <string>
#include <utility>

/// Calls for a signal, whatever its arguments, as long as the object lives.
inline void
connect(gpointer object, const char *signal, std::function<void()> call)
{
  g_signal_connect_data(
      object, signal,
      G_CALLBACK(+[](gpointer own) { (*static_cast<std::function<void()> *>(own))(); }),
      new std::function<void()>(std::move(call)),
      +[](gpointer own, GClosure *) { delete static_cast<std::function<void()> *>(own); },
      G_CONNECT_SWAPPED);
}

/// A wrapped label, at the left.
inline GtkWidget *
text_label(const std::string &text)
{
  GtkWidget *label = gtk_label_new(text.c_str());
  gtk_label_set_wrap(GTK_LABEL(label), TRUE);
  gtk_label_set_xalign(GTK_LABEL(label), 0);
  return label;
}

inline GtkWidget *
heading(const char *text)
{
  GtkWidget *label = text_label(text);
  gtk_widget_add_css_class(label, "heading");
  gtk_widget_set_margin_top(label, 12);
  return label;
}

inline GtkWidget *
column()
{
  return gtk_box_new(GTK_ORIENTATION_VERTICAL, 6);
}

inline GtkWidget *
row()
{
  return gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 12);
}

inline void
add(GtkWidget *box, GtkWidget *child)
{
  gtk_box_append(GTK_BOX(box), child);
}

inline void
clear(GtkWidget *box)
{
  while (GtkWidget *child = gtk_widget_get_first_child(box))
    gtk_box_remove(GTK_BOX(box), child);
}

/// The name that screen readers read.
inline void
name(GtkWidget *widget, const char *text)
{
  // Since GTK 4.14, a button is named by its label, which has precedence.
  gtk_accessible_reset_relation(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_RELATION_LABELLED_BY);
  gtk_accessible_update_property(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_PROPERTY_LABEL, text, -1);
}

/// The text of a button, `_` before its key.
inline void
set_text(GtkWidget *button, const char *text)
{
  gtk_button_set_label(GTK_BUTTON(button), text);
  gtk_button_set_use_underline(GTK_BUTTON(button), TRUE);
  // GTK 4.8 would name it twice, once with the underline.
  gtk_accessible_reset_property(GTK_ACCESSIBLE(button), GTK_ACCESSIBLE_PROPERTY_LABEL);
}

inline GtkWidget *
text_button(const char *text, const char *command, std::function<void()> press)
{
  GtkWidget *button = gtk_button_new();
  set_text(button, text);
  gtk_widget_set_tooltip_text(button, command);
  connect(button, "clicked", std::move(press));
  return button;
}
