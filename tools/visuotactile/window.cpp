// SPDX-License-Identifier: LGPL-2.1-or-later
#include "window.h"

#include "chair_page.h"
#include "film_page.h"
#include "follow_state.h"
#include "players_page.h"

#include "chair/settings_file.h"
#include "chair/settings_watch.h"
#include "translation.h"

#include <deque>
#include <memory>
#include <optional>
#include <utility>

namespace {

constexpr const char *kStyle = R"(
.motor { min-width: 40px; padding: 0 10px; min-height: 32px; border-radius: 22px; }
.motor.felt { background: #c01c28; color: white; }
.missing { background: #f9f06b; color: #241f31; padding: 6px; border-radius: 6px; }
.off { min-height: 56px; font-weight: bold; }
.off:checked { background: #c01c28; color: white; }
.complaint { background: #c01c28; color: white; padding: 6px; border-radius: 6px; }
.player { padding: 8px 12px; }
)";

class Window
{
public:
  Window(GtkApplication *application, const std::string &film_uri);
  ~Window();
  Window(const Window &) = delete;
  Window &operator=(const Window &) = delete;

  void open_film(const std::string &uri)
  {
    film_.set_film(uri);
    gtk_stack_set_visible_child_name(GTK_STACK(stack_), "film");
  }
  GtkWindow *window() const
  {
    return window_;
  }

private:
  struct Change
  {
    std::vector<std::string> arguments;
    Shared::Done done;
  };

  void add_page(GtkWidget *page, const char *id, const char *title);
  void add_actions();
  void switch_all(bool off);
  void change(std::vector<std::string> arguments, Shared::Done done);
  Change next_change();
  void start_change();
  static void show(GtkWidget *label, const std::string &text);
  void show_state();
  void show_settings();

  GtkWindow *window_;
  std::deque<Change> changes_{};    ///< that wait for the one that runs
  std::optional<bool> wants_off_{}; ///< the switch's, which is before them
  bool changing_ = false;
  Shared shared_;
  ChairPage chair_;
  FilmPage film_;
  PlayersPage players_;
  GtkWidget *stack_ = gtk_stack_new();
  GtkWidget *complaint_ = text_label("");
  GtkWidget *report_ = text_label("");
  GtkWidget *state_ = text_label("");
  GtkWidget *off_ = gtk_toggle_button_new();
  bool shows_ = false;
  FollowState follow_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
  chair::SettingsWatch watch_;
};

Window::Window(GtkApplication *application, const std::string &film_uri)
    : window_(GTK_WINDOW(gtk_application_window_new(application))), shared_{
        .change
        = [this](auto arguments, auto done) { change(std::move(arguments), std::move(done)); },
        .when_changed = [this](auto call) { change({}, [call](bool) { call(); }); },
        .complain = [this](const std::string &text) { show(complaint_, text); },
        .report = [this](const std::string &text) { show(report_, text); },
        .show_state =
            [this] {
              show_state();
            }
      },
      chair_(shared_), film_(window_, shared_), players_(shared_),
      follow_([this] { show_state(); }), watch_([this, alive = alive_] {
        // On a thread of its own.
        g_idle_add_full(
            G_PRIORITY_DEFAULT,
            +[](gpointer data) -> gboolean {
              const auto *call = static_cast<std::function<void()> *>(data);
              (*call)();
              return G_SOURCE_REMOVE;
            },
            new std::function<void()>([this, alive] {
              if (*alive)
                show_settings();
            }),
            +[](gpointer data) { delete static_cast<std::function<void()> *>(data); });
      })
{
  gtk_window_set_title(window_, "visuotactile");
  gtk_window_set_icon_name(window_, "org.visuotactile.Chair");
  gtk_window_set_default_size(window_, 760, 640);
  GtkWidget *header = gtk_header_bar_new();
  GtkWidget *switcher = gtk_stack_switcher_new();
  gtk_stack_switcher_set_stack(GTK_STACK_SWITCHER(switcher), GTK_STACK(stack_));
  gtk_header_bar_set_title_widget(GTK_HEADER_BAR(header), switcher);
  gtk_window_set_titlebar(window_, header);
  add_page(chair_.widget(), "chair", _("Chair"));
  add_page(film_.widget(), "film", _("Film"));
  add_page(players_.widget(), "players", _("Players"));
  GtkWidget *box = column();
  gtk_widget_set_vexpand(stack_, TRUE);
  add(box, stack_);
  GtkWidget *foot = column();
  for (const auto set :
       { gtk_widget_set_margin_start, gtk_widget_set_margin_end, gtk_widget_set_margin_bottom })
    set(foot, 12);
  for (GtkWidget *label : { complaint_, report_ }) {
    gtk_widget_add_css_class(label, "complaint");
    gtk_label_set_selectable(GTK_LABEL(label), TRUE);
    gtk_widget_set_visible(label, FALSE);
    add(foot, label);
  }
  add(foot, state_);
  gtk_widget_add_css_class(off_, "off");
  gtk_widget_set_tooltip_text(off_, "visuotactile-settings set mute=true");
  connect(off_, "toggled", [this] {
    if (shows_)
      return;
    switch_all(gtk_toggle_button_get_active(GTK_TOGGLE_BUTTON(off_)));
  });
  add(foot, off_);
  add(box, foot);
  gtk_window_set_child(window_, box);
  add_actions();
  if (!film_uri.empty())
    open_film(film_uri);
  show_settings();
  chair_.look();
  g_object_set_data_full(
      G_OBJECT(window_), "window", this,
      +[](gpointer self) { delete static_cast<Window *>(self); });
}

Window::~Window()
{
  *alive_ = false;
  chair_.write_all();
  while (wants_off_ || !changes_.empty())
    if (const std::vector<std::string> arguments = next_change().arguments; !arguments.empty())
      Command::start(arguments, {});
}

void
Window::add_page(GtkWidget *page, const char *id, const char *title)
{
  for (const auto set :
       { gtk_widget_set_margin_start, gtk_widget_set_margin_end, gtk_widget_set_margin_bottom })
    set(page, 12);
  GtkWidget *scrolled = gtk_scrolled_window_new();
  gtk_scrolled_window_set_policy(GTK_SCROLLED_WINDOW(scrolled), GTK_POLICY_NEVER,
                                 GTK_POLICY_AUTOMATIC);
  gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), page);
  gtk_stack_add_titled(GTK_STACK(stack_), scrolled, id, title);
}

/// Ctrl+O opens a film, Ctrl+M is the off switch, Ctrl+1 to 3 are the pages.
void
Window::add_actions()
{
  GtkEventController *keys = gtk_shortcut_controller_new();
  gtk_shortcut_controller_set_scope(GTK_SHORTCUT_CONTROLLER(keys), GTK_SHORTCUT_SCOPE_GLOBAL);
  const auto on_key = [&](const char *key, std::function<void()> call) {
    gtk_shortcut_controller_add_shortcut(
        GTK_SHORTCUT_CONTROLLER(keys),
        gtk_shortcut_new(
            gtk_shortcut_trigger_parse_string(key),
            gtk_callback_action_new(
                +[](GtkWidget *, GVariant *, gpointer own) -> gboolean {
                  (*static_cast<std::function<void()> *>(own))();
                  return TRUE;
                },
                new std::function<void()>(std::move(call)),
                +[](gpointer own) { delete static_cast<std::function<void()> *>(own); })));
  };
  on_key("<Control>o", [this] { film_.choose(); });
  on_key("<Control>m", [this] {
    gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(off_),
                                 !gtk_toggle_button_get_active(GTK_TOGGLE_BUTTON(off_)));
  });
  on_key("<Control>1", [this] { gtk_stack_set_visible_child_name(GTK_STACK(stack_), "chair"); });
  on_key("<Control>2", [this] { gtk_stack_set_visible_child_name(GTK_STACK(stack_), "film"); });
  on_key("<Control>3", [this] { gtk_stack_set_visible_child_name(GTK_STACK(stack_), "players"); });
  on_key("<Control>w", [this] { gtk_window_close(window_); });
  gtk_widget_add_controller(GTK_WIDGET(window_), keys);
}

/// Before all other changes. Off that cannot be written stops the film of this window.
void
Window::switch_all(bool off)
{
  if (off)
    chair_.stop_test();
  wants_off_ = off;
  start_change();
  show_state();
}

Window::Change
Window::next_change()
{
  if (const std::optional<bool> off = std::exchange(wants_off_, std::nullopt))
    return { { "visuotactile-settings", "set", *off ? "mute=true" : "mute=false" },
             [this, off](bool worked) {
               if (*off && !worked)
                 film_.stop();
               show_settings();
             } };
  Change next = std::move(changes_.front());
  changes_.pop_front();
  return next;
}

void
Window::change(std::vector<std::string> arguments, Shared::Done done)
{
  changes_.push_back({ std::move(arguments), std::move(done) });
  start_change();
}

void
Window::start_change()
{
  if (changing_ || (changes_.empty() && !wants_off_))
    return;
  changing_ = true;
  Change next = next_change();
  if (next.arguments.empty()) {
    changing_ = false;
    next.done(true);
    start_change();
    return;
  }
  Command::start(std::move(next.arguments),
                 { .line = {},
                   .told = {},
                   .ended = [this, alive = alive_, done = next.done](const std::string &complaint) {
                     if (!*alive)
                       return;
                     changing_ = false;
                     show(complaint_, complaint);
                     if (done)
                       done(complaint.empty());
                     start_change();
                   } });
}

void
Window::show(GtkWidget *label, const std::string &text)
{
  gtk_label_set_text(GTK_LABEL(label), text.c_str());
  gtk_widget_set_visible(label, !text.empty());
}

void
Window::show_state()
{
  const bool is_off = gtk_toggle_button_get_active(GTK_TOGGLE_BUTTON(off_));
  std::string state = is_off                ? _("All vibration is off.")
                      : chair_.is_testing() ? _("The feel test runs.")
                                            : follow_.text();
  if (!is_off && !film_.playing().empty())
    state = in_text("The chair plays {}.", film_.playing())
            + (film_.is_simulated() ? std::string(" ") + _("The motors are simulated.") : "");
  gtk_label_set_text(GTK_LABEL(state_), state.c_str());
  set_text(off_, is_off ? _("Switch vibration _on again") : _("Switch all vibration _off"));
}

void
Window::show_settings()
{
  shows_ = true;
  gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(off_),
                               setting(chair_values(), "mute", "false") == "true");
  shows_ = false;
  chair_.show_settings();
  players_.show();
  show_state();
}

} // namespace

void
show_window(GtkApplication *application, const std::string &film_uri)
{
  if (GtkWindow *shown = gtk_application_get_active_window(application)) {
    if (!film_uri.empty())
      static_cast<Window *>(g_object_get_data(G_OBJECT(shown), "window"))->open_film(film_uri);
    gtk_window_present(shown);
    return;
  }
  chair::make_settings_folder();
  GtkCssProvider *style = gtk_css_provider_new();
  gtk_css_provider_load_from_data(style, kStyle, -1);
  gtk_style_context_add_provider_for_display(gdk_display_get_default(), GTK_STYLE_PROVIDER(style),
                                             GTK_STYLE_PROVIDER_PRIORITY_APPLICATION);
  g_object_unref(style);
  const auto *window = new Window(application, film_uri); // deleted with its GtkWindow
  gtk_window_present(window->window());
}
