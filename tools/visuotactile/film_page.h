// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "command.h"
#include "gtk.h"
#include "shared.h"

#include <memory>
#include <string>

/// A film to play on the chair or to open in the desk.
class FilmPage
{
public:
  FilmPage(GtkWindow *window, const Shared &shared);
  /// The desk ends with the window; a film has a window of its own.
  ~FilmPage();
  FilmPage(const FilmPage &) = delete;
  FilmPage &operator=(const FilmPage &) = delete;

  GtkWidget *widget() const
  {
    return page_;
  }

  /// Lets the user choose a film.
  void choose();
  void set_film(const std::string &uri);
  /// Stops the film, if one plays.
  void stop();
  /// The film that visuotactile-play plays, or empty.
  std::string playing() const;
  /// Whether its motors are simulated, as there is no board.
  bool is_simulated() const
  {
    return simulated_;
  }

private:
  void play(bool example);
  void show_buttons();
  void edit();

  GtkWindow *window_;
  const Shared &shared_;
  GtkWidget *page_ = column();
  GtkWidget *title_ = text_label("");
  GtkWidget *play_ = nullptr;
  GtkWidget *edit_ = nullptr;
  GtkWidget *example_ = nullptr;
  std::string uri_{};
  std::string playing_{};
  bool is_example_ = false; ///< that plays, or played last
  bool simulated_ = false;
  std::shared_ptr<Command> player_{};
  bool stops_ = false; ///< by the user
  std::shared_ptr<Command> desk_{};
};
