// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "gtk.h"
#include "shared.h"

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
  GtkWidget *list_ = gtk_list_box_new();
  bool shows_ = false; ///< states are being shown, not changed
};
