// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair_page.h"

#include "house/missing.h"
#include "house/switches.h"
#include "translation.h"

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
  GtkWidget *settings = column();
  gtk_widget_set_hexpand(settings, TRUE);
  add(settings, heading(_("Device")));
  add(settings, missing_);
  add(settings, devices_);
  GtkWidget *again
      = text_button(_("Look a_gain"), "visuotactile-settings devices", [this] { look(); });
  gtk_widget_set_halign(again, GTK_ALIGN_START);
  add(settings, again);
  add(settings, make_strength());
  add(page_, settings);
  add(page_, make_test());
  show_settings();
}

ChairPage::~ChairPage()
{
  *alive_ = false;
  for (const Value &value : values_) {
    if (value.settles != 0)
      g_source_remove(value.settles);
    g_object_unref(value.shown);
  }
  stop_test();
  if (tested_)
    tested_->forget();
}

void
ChairPage::write_all()
{
  for (Value &value : values_)
    if (value.settles != 0)
      write(value);
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
  GtkWidget *intensity = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, 0, 100, 5);
  gtk_scale_set_draw_value(GTK_SCALE(intensity), TRUE);
  gtk_scale_set_value_pos(GTK_SCALE(intensity), GTK_POS_RIGHT);
  gtk_widget_set_tooltip_text(intensity, "visuotactile-settings set intensity=0.5");
  delay_ = gtk_spin_button_new_with_range(-chair::kMostDelay, chair::kMostDelay, 5);
  gtk_spin_button_set_digits(GTK_SPIN_BUTTON(delay_), 1);
  gtk_widget_set_tooltip_text(delay_, "visuotactile-settings set delay=20");
  gtk_widget_set_halign(delay_, GTK_ALIGN_START);
  attach(_("_Intensity (%)"), intensity, 0);
  attach(_("De_lay (ms)"), delay_, 1);
  values_[0].shown = gtk_range_get_adjustment(GTK_RANGE(intensity));
  values_[1].shown = gtk_spin_button_get_adjustment(GTK_SPIN_BUTTON(delay_));
  for (Value &value : values_) {
    g_object_ref(value.shown); // it is read when its widget is gone
    connect(value.shown, "value-changed", [this, &value] {
      if (!shows_)
        settle(value);
    });
  }
  return grid;
}

void
ChairPage::settle(Value &value)
{
  if (value.settles != 0)
    g_source_remove(value.settles);
  value.settles = g_timeout_add_full(
      G_PRIORITY_DEFAULT, kSettle,
      +[](gpointer call) -> gboolean {
        (*static_cast<std::function<void()> *>(call))();
        return G_SOURCE_REMOVE;
      },
      new std::function<void()>([this, &value] {
        value.settles = 0;
        write(value);
      }),
      +[](gpointer call) { delete static_cast<std::function<void()> *>(call); });
}

void
ChairPage::write(Value &value)
{
  if (const guint waits = std::exchange(value.settles, 0))
    g_source_remove(waits);
  shared_.change({ "visuotactile-settings", "set",
                   std::string(value.key) + "="
                       + number(gtk_adjustment_get_value(value.shown) / value.factor) },
                 {});
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
  const chair::Values now = chair_values();
  for (const Value &value : values_)
    if (value.settles == 0)
      gtk_adjustment_set_value(
          value.shown,
          value.factor * g_ascii_strtod(setting(now, value.key, value.usual).c_str(), nullptr));
  gtk_widget_set_sensitive(delay_, setting(now, "driver", "auto") != chair::kShakers);
  shows_ = false;
  show_chosen();
}

struct ChairPage::Look
{
  ChairPage *page;
  std::shared_ptr<bool> alive;
  unsigned number;
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
        if (*look->alive && look->number == look->page->looks_)
          look->page->show_devices(look->found, look->servers, look->lines);
      },
      nullptr);
  g_task_set_task_data(
      task, new Look{ .page = this, .alive = alive_, .number = ++looks_ },
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
  offers_.clear();
  if (const std::optional<FoundDevice> last = absent_device(found, servers))
    put({ last->name, last->driver, last->device });
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
  const chair::Values now = chair_values();
  if (setting(now, "driver", "auto") == "intiface")
    put({ in_text("{} of Intiface", setting(now, "device", "")), "intiface",
          setting(now, "device", "") });
  if (std::ranges::find(servers, "intiface") != servers.end())
    name_intiface();
  show_chosen();
}

/// An entry, as a device of Intiface is never taken unless it is named.
void
ChairPage::name_intiface()
{
  GtkWidget *line = column();
  GtkWidget *label = gtk_label_new_with_mnemonic(_("Device of Intif_ace, by its name there"));
  GtkWidget *entry = gtk_entry_new();
  gtk_label_set_mnemonic_widget(GTK_LABEL(label), entry);
  gtk_accessible_update_relation(GTK_ACCESSIBLE(entry), GTK_ACCESSIBLE_RELATION_LABELLED_BY, label,
                                 nullptr, -1);
  gtk_label_set_xalign(GTK_LABEL(label), 0);
  connect(entry, "activate", [this, entry] {
    const std::string device = gtk_editable_get_text(GTK_EDITABLE(entry));
    if (device.empty())
      return;
    choose({ device, "intiface", device });
  });
  add(line, label);
  add(line, entry);
  add(devices_, line);
}

/// Moving through the list chooses none: that is a click, Return or the space key.
void
ChairPage::put(const Choice &choice)
{
  GtkWidget *button = gtk_toggle_button_new();
  GtkWidget *line = row();
  add(line, gtk_image_new_from_icon_name("object-select-symbolic"));
  add(line, text_label(choice.name));
  gtk_button_set_child(GTK_BUTTON(button), line);
  gtk_button_set_has_frame(GTK_BUTTON(button), FALSE);
  name(button, choice.name.c_str());
  gtk_widget_set_tooltip_text(button, ("visuotactile-settings use driver=" + choice.driver
                                       + (choice.device.empty() ? "" : " device=" + choice.device))
                                          .c_str());
  connect(button, "clicked", [this, choice] { choose(choice); });
  add(devices_, button);
  offers_.push_back({ choice, button });
}

void
ChairPage::choose(const Choice &choice)
{
  stop_test();
  std::vector<std::string> use{ "visuotactile-settings", "use", "driver=" + choice.driver };
  if (!choice.device.empty())
    use.push_back("device=" + choice.device);
  const bool is_new = std::ranges::none_of(offers_, [&](const Offer &offer) {
    return offer.choice.driver == choice.driver && offer.choice.device == choice.device;
  });
  shared_.change(std::move(use), [this, is_new](bool) {
    show_settings();
    if (is_new)
      look();
  });
}

/// That of the settings.
void
ChairPage::show_chosen()
{
  const chair::Values now = chair_values();
  const std::string driver = setting(now, "driver", "auto");
  for (const auto &[choice, button] : offers_) {
    const bool chosen = driver == choice.driver
                        && (choice.device.empty() || choice.device == setting(now, "device", ""));
    gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(button), chosen);
    gtk_widget_set_opacity(gtk_widget_get_first_child(gtk_button_get_child(GTK_BUTTON(button))),
                           chosen ? 1 : 0);
  }
  show_motors();
}

void
ChairPage::show_motors()
{
  const chair::Values now = chair_values();
  const std::string shown = setting(now, "driver", "auto") + setting(now, "device", "")
                            + setting(now, chair::kGrid, "");
  if (shown == shown_)
    return;
  shown_ = shown;
  gtk_label_set_text(GTK_LABEL(felt_),
                     _("Sit down, and start. A motor in the picture is felt alone."));
  if (!has_grid(setting(now, "driver", "auto"))) {
    picture_.show_none();
    return;
  }
  const chair::Grid grid = chair::parse_grid(setting(now, chair::kGrid, "3x3"));
  if (grid.rows > kMostSide || grid.columns > kMostSide)
    picture_.show_none();
  else
    picture_.show_grid(grid.rows, grid.columns);
}

void
ChairPage::test(int motor)
{
  next_ = motor;
  write_all();
  if (tested_)
    tested_->stop();
  else
    shared_.when_changed([this] { start_test(); });
}

void
ChairPage::start_test()
{
  if (!next_ || tested_)
    return;
  const int motor = *std::exchange(next_, std::nullopt);
  if (setting(chair_values(), "mute", "false") == "true") {
    shared_.complain(_("All vibration is off: switch it on below."));
    return;
  }
  std::vector<std::string> arguments{ "visuotactile-play", "--feel-test" };
  if (motor > 0)
    arguments.push_back("--motor=" + std::to_string(motor));
  set_text(test_, _("_Stop the feel test"));
  const auto number = std::make_shared<int>(motor > 0 ? motor : 1);
  tested_ = Command::start(std::move(arguments),
                           { .line =
                                 [this, number](const std::string &line) {
                                   const bool is_motor
                                       = line != _("simulated, as the driver is the simulator");
                                   const std::string shown = is_motor
                                                                 ? picture_.light((*number)++, line)
                                                                 : _("The motors are simulated.");
                                   gtk_label_set_text(GTK_LABEL(felt_), shown.c_str());
                                 },
                             .ended = [this](const std::string &complaint) { tested(complaint); },
                             .ends_with_window = true });
  shared_.show_state();
}

void
ChairPage::tested(const std::string &complaint)
{
  tested_ = nullptr;
  picture_.light(0, "");
  set_text(test_, _("_Feel all motors"));
  const bool stopped = std::exchange(stops_, false) || next_;
  if (!stopped || complaint != "?") // of one that was stopped, too: motors may still be on
    shared_.report(complaint);
  shared_.show_state();
  if (next_)
    shared_.when_changed([this] { start_test(); });
}

void
ChairPage::stop_test()
{
  next_.reset();
  stops_ = tested_ != nullptr;
  if (tested_)
    tested_->stop();
}
