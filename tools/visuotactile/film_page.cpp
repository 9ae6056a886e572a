// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_page.h"

#include "translation.h"

namespace {

GtkWidget *
make_button(const char *text, const char *command, std::function<void()> press)
{
  GtkWidget *button = text_button(text, command, std::move(press));
  gtk_widget_set_halign(button, GTK_ALIGN_START);
  return button;
}

} // namespace

FilmPage::FilmPage(GtkWindow *window, const Shared &shared) : window_(window), shared_(shared)
{
  add(page_, heading(_("Film")));
  add(page_, title_);
  add(page_, make_button(_("Open a fil_m…"), "Ctrl+O", [this] { choose(); }));
  play_
      = make_button(_("_Play it on the chair"), "visuotactile-play FILM", [this] { play(false); });
  gtk_widget_add_css_class(play_, "suggested-action");
  add(page_, play_);
  edit_ = make_button(_("_Edit its track in the desk"), "tactile-track desk FILM",
                      [this] { edit(); });
  add(page_, edit_);
  add(page_, heading(_("No film at hand?")));
  example_ = make_button("", "visuotactile-play", [this] { play(true); });
  add(page_, example_);
  set_film("");
}

FilmPage::~FilmPage()
{
  if (player_)
    player_->forget();
  if (desk_) {
    desk_->forget();
    desk_->stop();
  }
}

std::string
FilmPage::playing() const
{
  return playing_;
}

void
FilmPage::set_film(const std::string &uri)
{
  uri_ = uri;
  g_autoptr(GFile) file = g_file_new_for_uri(uri.c_str());
  g_autofree gchar *base = g_file_get_basename(file);
  g_autofree gchar *shown = base ? g_filename_display_name(base) : nullptr;
  gtk_label_set_text(GTK_LABEL(title_), uri.empty() ? _("No film is open.") : shown ? shown : "");
  gtk_widget_set_sensitive(edit_, !uri.empty());
  show_buttons();
}

/// The one that was pressed stops what plays.
void
FilmPage::show_buttons()
{
  const bool film = player_ && !is_example_;
  const bool example = player_ && is_example_;
  set_text(play_, film ? _("_Stop the film") : _("_Play it on the chair"));
  set_text(example_, example ? _("_Stop the film") : _("Play an e_xample of 25 seconds"));
  gtk_widget_set_sensitive(play_, film || (!example && !uri_.empty()));
  gtk_widget_set_sensitive(example_, !film);
}

void
FilmPage::choose()
{
  GtkFileChooserNative *chooser = gtk_file_chooser_native_new(
      _("Open a film"), window_, GTK_FILE_CHOOSER_ACTION_OPEN, nullptr, nullptr);
  GtkFileFilter *films = gtk_file_filter_new();
  gtk_file_filter_set_name(films, _("Films"));
  gtk_file_filter_add_mime_type(films, "video/*");
  gtk_file_chooser_add_filter(GTK_FILE_CHOOSER(chooser), films);
  g_object_unref(films);
  g_signal_connect(
      chooser, "response", G_CALLBACK(+[](GtkNativeDialog *dialog, int response, gpointer self) {
        g_autoptr(GFile) file = response == GTK_RESPONSE_ACCEPT
                                    ? gtk_file_chooser_get_file(GTK_FILE_CHOOSER(dialog))
                                    : nullptr;
        g_autofree gchar *uri = file ? g_file_get_uri(file) : nullptr;
        if (uri)
          static_cast<FilmPage *>(self)->set_film(uri);
        g_object_unref(dialog);
      }),
      this);
  gtk_native_dialog_set_modal(GTK_NATIVE_DIALOG(chooser), TRUE);
  gtk_native_dialog_show(GTK_NATIVE_DIALOG(chooser));
}

void
FilmPage::stop()
{
  stops_ = true;
  if (player_)
    player_->stop();
}

void
FilmPage::play(bool example)
{
  if (player_) {
    stop();
    return;
  }
  stops_ = false;
  simulated_ = false;
  std::vector<std::string> arguments{ "visuotactile-play" };
  if (!example)
    arguments.push_back(uri_);
  playing_ = example ? _("an example") : gtk_label_get_text(GTK_LABEL(title_));
  is_example_ = example;
  player_
      = Command::start(std::move(arguments),
                       { .line = {},
                         .told =
                             [this](const std::string &line) {
                               // a warning where a device is there that cannot be used
                               if (line.find("the motors are simulated") == std::string::npos)
                                 return;
                               simulated_ = true;
                               shared_.show_state();
                             },
                         .ended =
                             [this](const std::string &complaint) {
                               player_ = nullptr;
                               playing_.clear();
                               show_buttons();
                               if (!stops_ || complaint != "?") // it may have been stopped early
                                 shared_.report(complaint);
                               shared_.show_state();
                             } });
  show_buttons();
  shared_.show_state();
}

void
FilmPage::edit()
{
  g_autofree gchar *path = g_filename_from_uri(uri_.c_str(), nullptr, nullptr);
  if (path == nullptr) {
    shared_.complain(_("The desk edits films on this computer."));
    return;
  }
  shared_.complain("");
  if (desk_) {
    desk_->forget();
    desk_->stop();
  }
  desk_ = Command::start({ "tactile-track", "desk", path },
                         { .line = {}, .told = {}, .ended = [this](const std::string &complaint) {
                            desk_ = nullptr;
                            shared_.complain(complaint);
                          } });
}
