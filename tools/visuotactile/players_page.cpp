// SPDX-License-Identifier: LGPL-2.1-or-later
#include "players_page.h"

#include "house/switches.h"
#include "house/translation.h"

PlayersPage::PlayersPage(const Shared &shared) : shared_(shared)
{
  add(page_, heading(_("Players")));
  add(page_, text_label(_("Films in these programs are felt from their next start on.")));
  gtk_list_box_set_selection_mode(GTK_LIST_BOX(list_), GTK_SELECTION_NONE);
  gtk_widget_add_css_class(list_, "boxed-list");
  name(list_, _("Players"));
  add(page_, list_);
  show();
}

void
PlayersPage::show()
{
  shows_ = true;
  while (GtkWidget *line = gtk_widget_get_first_child(list_))
    gtk_list_box_remove(GTK_LIST_BOX(list_), line);
  for (const Switch &player : switches()) {
    GtkWidget *line = row();
    gtk_widget_add_css_class(line, "player");
    std::string title = player.title;
    if (!player.is_there)
      title = in_text("{} (not installed)", title);
    else if (player.name == "kodi")
      title = in_text("{} (enable the add-on there, too)", title);
    GtkWidget *label = text_label(title);
    gtk_widget_set_hexpand(label, TRUE);
    add(line, label);
    GtkWidget *toggle = gtk_switch_new();
    gtk_widget_set_valign(toggle, GTK_ALIGN_CENTER);
    gtk_accessible_update_relation(GTK_ACCESSIBLE(toggle), GTK_ACCESSIBLE_RELATION_LABELLED_BY,
                                   label, nullptr, -1);
    gtk_switch_set_active(GTK_SWITCH(toggle), player.is_on);
    gtk_widget_set_sensitive(toggle, player.is_there || player.is_on);
    gtk_widget_set_tooltip_text(toggle, ("visuotactile-settings on " + player.name).c_str());
    connect(toggle, "notify::active", [this, toggle, player = player.name] {
      if (!shows_)
        shared_.change({ "visuotactile-settings",
                         gtk_switch_get_active(GTK_SWITCH(toggle)) ? "on" : "off", player },
                       [this](bool) { show(); });
    });
    add(line, toggle);
    gtk_list_box_append(GTK_LIST_BOX(list_), line);
    gtk_list_box_row_set_activatable(GTK_LIST_BOX_ROW(gtk_widget_get_parent(line)), FALSE);
    gtk_widget_set_focusable(gtk_widget_get_parent(line), FALSE);
  }
  shows_ = false;
}
