// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "gtk.h"
#include "shared.h"

#include "house/switches.h"

#include <map>
#include <string>

/// A switch for each player whose films can be felt.
class PlayersPage
{
public:
  explicit PlayersPage(const Shared &shared);

  GtkWidget *widget() const
  {
    return page_;
  }

  /// Shows the present state of all.
  void show();

private:
  const Shared &shared_;
  GtkWidget *page_ = column();
  struct Line
  {
    GtkWidget *label;
    GtkWidget *toggle;
  };
  void add_line(const Switch &player);

  GtkWidget *list_ = gtk_list_box_new();
  std::map<std::string, Line> lines_{}; ///< by the switch's name
  bool shows_ = false;                  ///< states are being shown, not changed
};
