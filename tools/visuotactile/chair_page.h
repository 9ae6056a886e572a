// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "chair_picture.h"
#include "command.h"
#include "shared.h"

#include "film/device_list.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

/// The devices, the feel test, intensity and delay.
class ChairPage
{
public:
  explicit ChairPage(const Shared &shared);
  ~ChairPage();
  ChairPage(const ChairPage &) = delete;
  ChairPage &operator=(const ChairPage &) = delete;

  GtkWidget *widget() const
  {
    return page_;
  }

  /// Looks for devices, on a thread of its own.
  void look();
  /// Shows the settings, which others may have changed.
  void show_settings();
  /// Writes values that have not settled yet.
  void write_all();
  /// All motors of the feel test to zero.
  void stop_test();
  bool is_testing() const
  {
    return tested_ != nullptr;
  }

private:
  /// A device to choose.
  struct Choice
  {
    std::string name;
    std::string driver;
    std::string device; ///< empty: the driver's usual one
  };
  struct Offer
  {
    Choice choice;
    GtkWidget *button; ///< active: it is used
  };
  /// A number of the settings that is written once it has settled.
  struct Value
  {
    const char *key;
    const char *usual;
    double factor; ///< shown: times that of the setting
    GtkAdjustment *shown = nullptr;
    guint settles = 0; ///< timeout
  };
  struct Look;

  void show_devices(const std::vector<FoundDevice> &found, const std::vector<std::string> &servers,
                    const std::vector<std::string> &lines);
  void put(const Choice &choice);
  void choose(const Choice &choice);
  void show_chosen();
  void show_motors();
  /// Of that motor, from 1, or all: 0.
  void test(int motor);
  void start_test();
  void tested(const std::string &complaint);
  void name_intiface();
  GtkWidget *make_test();
  GtkWidget *make_strength();
  void settle(Value &value);
  void write(Value &value);

  const Shared &shared_;
  GtkWidget *page_ = row();
  GtkWidget *devices_ = column();
  GtkWidget *missing_ = column();
  std::vector<Offer> offers_{};
  GtkWidget *test_ = nullptr;
  GtkWidget *felt_ = text_label("");
  GtkWidget *delay_ = nullptr;
  Value values_[2] = { { "intensity", "1", 100 }, { chair::kDelay, "0", 1 } };
  ChairPicture picture_;
  std::string shown_{}; ///< settings of the picture
  std::shared_ptr<Command> tested_;
  std::optional<int> next_{}; ///< motor to feel when the device is free and chosen
  bool stops_ = false;        ///< the feel test was stopped by the user
  unsigned looks_ = 0;        ///< searches for devices; the last one is shown
  bool shows_ = false;        ///< the settings are being shown, not changed
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};
