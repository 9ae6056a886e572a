// SPDX-License-Identifier: LGPL-2.1-or-later
#include "players_page.h"

#include "translation.h"

PlayersPage::PlayersPage(const Shared &shared) : shared_(shared)
{
  add(page_, heading(_("Players")));
  add(page_,
      text_label(
          _("Films in the chosen programs are felt. Restart programs that are already open.")));
  gtk_list_box_set_selection_mode(GTK_LIST_BOX(list_), GTK_SELECTION_NONE);
  gtk_widget_add_css_class(list_, "boxed-list");
  name(list_, _("Players"));
  add(page_, list_);
  show();
}

void
PlayersPage::add_line(const Switch &player)
{
  GtkWidget *line = row();
  gtk_widget_add_css_class(line, "player");
  GtkWidget *label = text_label("");
  gtk_widget_set_hexpand(label, TRUE);
  add(line, label);
  GtkWidget *toggle = gtk_switch_new();
  gtk_widget_set_valign(toggle, GTK_ALIGN_CENTER);
  gtk_accessible_update_relation(GTK_ACCESSIBLE(toggle), GTK_ACCESSIBLE_RELATION_LABELLED_BY, label,
                                 nullptr, -1);
  gtk_widget_set_tooltip_text(toggle, ("visuotactile-settings on " + player.name).c_str());
  connect(toggle, "notify::active", [this, toggle, name = player.name] {
    if (!shows_)
      shared_.change({ "visuotactile-settings",
                       gtk_switch_get_active(GTK_SWITCH(toggle)) ? "on" : "off", name },
                     [this](bool) { show(); });
  });
  add(line, toggle);
  gtk_list_box_append(GTK_LIST_BOX(list_), line);
  gtk_list_box_row_set_activatable(GTK_LIST_BOX_ROW(gtk_widget_get_parent(line)), FALSE);
  gtk_widget_set_focusable(gtk_widget_get_parent(line), FALSE);
  lines_[player.name] = { label, toggle };
}

void
PlayersPage::show()
{
  shows_ = true;
  for (const Switch &player : switches()) {
    if (!lines_.contains(player.name))
      add_line(player);
    const auto &[label, toggle] = lines_[player.name];
    std::string title = player.title;
    if (!player.is_there)
      title = in_text("{} (not installed)", title);
    else if (player.name == "kodi")
      title = in_text("{} (enable the add-on there, too)", title);
    gtk_label_set_text(GTK_LABEL(label), title.c_str());
    gtk_switch_set_active(GTK_SWITCH(toggle), player.is_on);
    gtk_widget_set_sensitive(toggle, player.is_there || player.is_on);
  }
  shows_ = false;
}
