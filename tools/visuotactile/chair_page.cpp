// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair_page.h"

#include "house/missing.h"
#include "house/switches.h"
#include "house/translation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace {

constexpr unsigned kMostSide = 12; ///< of a grid that the picture shows
constexpr guint kSettle = 200;     ///< ms

/// Drivers whose tactors are a grid; others name their motors.
bool
has_grid(const std::string &driver)
{
  return driver == "auto" || driver == "firmata" || driver == "seat" || driver == "simulator";
}

std::string
number(double value)
{
  std::array<char, G_ASCII_DTOSTR_BUF_SIZE> text{};
  return g_ascii_formatd(text.data(), static_cast<gint>(text.size()), "%g", value);
}

} // namespace

ChairPage::ChairPage(const Shared &shared)
    : shared_(shared), picture_([this](int motor) { test(motor); })
{
  add(page_, heading(_("Device")));
  add(page_, missing_);
  add(page_, devices_);
  GtkWidget *again
      = text_button(_("_Look again"), "visuotactile-settings devices", [this] { look(); });
  gtk_widget_set_halign(again, GTK_ALIGN_START);
  add(page_, again);
  add(page_, make_strength());
  add(page_, make_test());
  show_settings();
}

ChairPage::~ChairPage()
{
  *alive_ = false;
  if (settled_ != 0)
    g_source_remove(settled_);
  stop_test();
  if (tested_)
    tested_->forget();
}

GtkWidget *
ChairPage::make_strength()
{
  GtkWidget *grid = gtk_grid_new();
  gtk_grid_set_column_spacing(GTK_GRID(grid), 12);
  gtk_grid_set_row_spacing(GTK_GRID(grid), 6);
  const auto attach = [&](const char *text, GtkWidget *widget, int line) {
    GtkWidget *label = gtk_label_new_with_mnemonic(text);
    gtk_label_set_xalign(GTK_LABEL(label), 0);
    gtk_label_set_mnemonic_widget(GTK_LABEL(label), widget);
    gtk_accessible_update_relation(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_RELATION_LABELLED_BY,
                                   label, nullptr, -1);
    gtk_grid_attach(GTK_GRID(grid), label, 0, line, 1, 1);
    gtk_grid_attach(GTK_GRID(grid), widget, 1, line, 1, 1);
    gtk_widget_set_hexpand(widget, TRUE);
  };
  intensity_ = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, 0, 100, 5);
  gtk_scale_set_draw_value(GTK_SCALE(intensity_), TRUE);
  gtk_scale_set_value_pos(GTK_SCALE(intensity_), GTK_POS_RIGHT);
  gtk_widget_set_tooltip_text(intensity_, "visuotactile-settings set intensity=0.5");
  delay_ = gtk_spin_button_new_with_range(-500, 500, 5);
  gtk_widget_set_tooltip_text(delay_, "visuotactile-settings set delay=20");
  gtk_widget_set_halign(delay_, GTK_ALIGN_START);
  attach(_("_Intensity (%)"), intensity_, 0);
  attach(_("De_lay (ms)"), delay_, 1);
  for (GtkWidget *widget : { intensity_, delay_ })
    connect(widget, "value-changed", [this] {
      if (shows_)
        return;
      if (settled_ != 0)
        g_source_remove(settled_);
      settled_ = g_timeout_add_once(
          kSettle,
          +[](gpointer data) {
            auto *self = static_cast<ChairPage *>(data);
            self->settled_ = 0;
            self->shared_.change(
                { "visuotactile-settings", "set",
                  "intensity=" + number(gtk_range_get_value(GTK_RANGE(self->intensity_)) / 100),
                  "delay=" + number(gtk_spin_button_get_value(GTK_SPIN_BUTTON(self->delay_))) },
                {});
          },
          this);
    });
  return grid;
}

GtkWidget *
ChairPage::make_test()
{
  GtkWidget *box = column();
  add(box, heading(_("Feel test")));
  test_ = text_button(_("_Feel all motors"), "visuotactile-play --feel-test", [this] {
    if (tested_)
      stop_test();
    else
      test(0);
  });
  gtk_widget_add_css_class(test_, "suggested-action");
  add(box, test_);
  add(box, felt_);
  add(box, picture_.widget());
  return box;
}

void
ChairPage::show_settings()
{
  shows_ = true;
  const chair::Settings settings = chair::read_settings();
  const double intensity = g_ascii_strtod(setting(settings, "intensity", "1").c_str(), nullptr);
  if (settled_ == 0) {
    gtk_range_set_value(GTK_RANGE(intensity_), std::round(intensity * 100));
    gtk_spin_button_set_value(
        GTK_SPIN_BUTTON(delay_),
        g_ascii_strtod(setting(settings, chair::kDelay, "0").c_str(), nullptr));
  }
  shows_ = false;
}

struct ChairPage::Look
{
  ChairPage *page;
  std::shared_ptr<bool> alive;
  std::vector<FoundDevice> found{};
  std::vector<std::string> servers{};
  std::vector<std::string> lines{};
};

void
ChairPage::look()
{
  // The devices of a sound server may take a while.
  GTask *task = g_task_new(
      nullptr, nullptr,
      +[](GObject *, GAsyncResult *result, gpointer) {
        const auto *look = static_cast<Look *>(g_task_get_task_data(G_TASK(result)));
        if (*look->alive)
          look->page->show_devices(look->found, look->servers, look->lines);
      },
      nullptr);
  g_task_set_task_data(
      task, new Look{ .page = this, .alive = alive_ },
      +[](gpointer look) { delete static_cast<Look *>(look); });
  g_task_run_in_thread(
      task, +[](GTask *self, gpointer, gpointer data, GCancellable *) {
        auto *look = static_cast<Look *>(data);
        look->found = found_devices();
        look->servers = waiting_servers();
        look->lines = missing(look->found);
        g_task_return_boolean(self, TRUE);
      });
  g_object_unref(task);
}

void
ChairPage::show_devices(const std::vector<FoundDevice> &found,
                        const std::vector<std::string> &servers,
                        const std::vector<std::string> &lines)
{
  clear(missing_);
  for (const std::string &line : lines) {
    GtkWidget *label = text_label("⚠ " + line);
    gtk_widget_add_css_class(label, "missing");
    add(missing_, label);
  }
  clear(devices_);
  first_ = nullptr;
  shows_ = true;
  put({ _("The board that is connected, otherwise simulated motors"), "auto", "" });
  for (const FoundDevice &device : found)
    put({ device.driver == kAudio
              ? in_text("Shakers at the sound card {}, for films opened here", device.name)
              : device.name,
          device.driver, device.device });
  for (const std::string &server : servers)
    if (server == "bhaptics") {
      put({ _("Vest of bHaptics, front"), "bhaptics", "vest-front" });
      put({ _("Vest of bHaptics, back"), "bhaptics", "vest-back" });
    }
  put({ _("No hardware: simulated motors"), "simulator", "" });
  const chair::Settings settings = chair::read_settings();
  if (setting(settings, "driver", "auto") == "intiface")
    put({ in_text("{} of Intiface", setting(settings, "device", "")), "intiface",
          setting(settings, "device", "") });
  if (std::ranges::find(servers, "intiface") != servers.end())
    name_intiface();
  shows_ = false;
  show_motors();
}

/// An entry, as a device of Intiface is never taken unless it is named.
void
ChairPage::name_intiface()
{
  GtkWidget *line = row();
  GtkWidget *label = gtk_label_new_with_mnemonic(_("Device of _Intiface, by its name there"));
  GtkWidget *entry = gtk_entry_new();
  gtk_label_set_mnemonic_widget(GTK_LABEL(label), entry);
  gtk_accessible_update_relation(GTK_ACCESSIBLE(entry), GTK_ACCESSIBLE_RELATION_LABELLED_BY, label,
                                 nullptr, -1);
  gtk_widget_set_hexpand(entry, TRUE);
  connect(entry, "activate", [this, entry] {
    const std::string device = gtk_editable_get_text(GTK_EDITABLE(entry));
    if (device.empty())
      return;
    choose({ device, "intiface", device });
    look();
  });
  add(line, label);
  add(line, entry);
  add(devices_, line);
}

void
ChairPage::put(const Choice &choice)
{
  GtkWidget *button = gtk_check_button_new_with_label(choice.name.c_str());
  gtk_check_button_set_group(GTK_CHECK_BUTTON(button), first_ ? GTK_CHECK_BUTTON(first_) : nullptr);
  if (first_ == nullptr)
    first_ = button;
  const chair::Settings settings = chair::read_settings();
  const std::string device = setting(settings, "device", "");
  if (setting(settings, "driver", "auto") == choice.driver
      && (choice.driver == "auto" || choice.driver == "simulator" || device == choice.device))
    gtk_check_button_set_active(GTK_CHECK_BUTTON(button), TRUE);
  gtk_widget_set_tooltip_text(button, ("visuotactile-settings set driver=" + choice.driver
                                       + (choice.device.empty() ? "" : " device=" + choice.device))
                                          .c_str());
  connect(button, "toggled", [this, button, choice] {
    if (!shows_ && gtk_check_button_get_active(GTK_CHECK_BUTTON(button)))
      choose(choice);
  });
  add(devices_, button);
}

void
ChairPage::choose(const Choice &choice)
{
  stop_test();
  std::vector<std::string> set{ "visuotactile-settings", "set", "driver=" + choice.driver };
  if (!choice.device.empty())
    set.push_back("device=" + choice.device);
  // The mapping and the rest of the former device are not of this one.
  const bool unsets = choice.device.empty();
  shared_.change(std::move(set), [this, unsets, alive = alive_](bool worked) {
    if (!*alive || !worked)
      return;
    std::vector<std::string> unset{ "visuotactile-settings", "unset", "mapping", "calibration" };
    if (unsets)
      unset.emplace_back("device");
    shared_.change(std::move(unset), [this, alive](bool) {
      if (*alive)
        show_motors();
      for (const Switch &player : switches())
        if (player.name == "follow" && player.is_on)
          Command::start({ "systemctl", "--user", "try-restart", "visuotactile-follow" }, {});
    });
  });
}

void
ChairPage::show_motors()
{
  const chair::Settings settings = chair::read_settings();
  gtk_label_set_text(GTK_LABEL(felt_), _("Sit down, and start. A motor in the picture is felt "
                                         "alone."));
  if (!has_grid(setting(settings, "driver", "auto"))) {
    picture_.show_none();
    return;
  }
  const chair::Grid grid = chair::parse_grid(setting(settings, chair::kGrid, "3x3"));
  if (grid.rows > kMostSide || grid.columns > kMostSide)
    picture_.show_none();
  else
    picture_.show_grid(grid.rows, grid.columns);
}

void
ChairPage::test(int motor)
{
  if (tested_) {
    next_ = motor; // when the device is free
    tested_->stop();
    return;
  }
  if (setting(chair::read_settings(), "mute", "false") == "true") {
    shared_.complain(_("All vibration is off: switch it on below."));
    return;
  }
  shared_.complain("");
  std::vector<std::string> arguments{ "visuotactile-play", "--feel-test" };
  if (motor > 0)
    arguments.push_back("--motor=" + std::to_string(motor));
  set_text(test_, _("_Stop the feel test"));
  const auto number = std::make_shared<int>(motor > 0 ? motor : 1);
  tested_ = Command::start(std::move(arguments),
                           { .line =
                                 [this, number](const std::string &line) {
                                   const bool is_motor = !line.starts_with("simulated");
                                   const std::string shown
                                       = is_motor ? picture_.light((*number)++, line) : line;
                                   gtk_label_set_text(GTK_LABEL(felt_), shown.c_str());
                                 },
                             .ended = [this](const std::string &complaint) { tested(complaint); },
                             .ends_with_window = true });
}

void
ChairPage::tested(const std::string &complaint)
{
  tested_ = nullptr;
  picture_.light(0, "");
  set_text(test_, _("_Feel all motors"));
  if (const std::optional<int> next = std::exchange(next_, std::nullopt))
    test(*next);
  else if (!std::exchange(stops_, false) || complaint != "?")
    shared_.complain(complaint); // of a test that was stopped, too: motors may still be on
}

void
ChairPage::stop_test()
{
  next_.reset();
  stops_ = tested_ != nullptr;
  if (tested_)
    tested_->stop();
}
