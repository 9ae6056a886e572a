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
  /// All motors of the feel test to zero.
  void stop_test();

private:
  /// A device to choose.
  struct Choice
  {
    std::string name;
    std::string driver;
    std::string device; ///< empty: the driver's usual one
  };
  struct Look;

  void show_devices(const std::vector<FoundDevice> &found, const std::vector<std::string> &servers,
                    const std::vector<std::string> &lines);
  void put(const Choice &choice);
  void choose(const Choice &choice);
  void show_motors();
  /// Of that motor, from 1, or all: 0.
  void test(int motor);
  void tested(const std::string &complaint);
  void name_intiface();
  GtkWidget *make_test();
  GtkWidget *make_strength();

  const Shared &shared_;
  GtkWidget *page_ = column();
  GtkWidget *devices_ = column();
  GtkWidget *missing_ = column();
  GtkWidget *first_ = nullptr; ///< of the devices' group
  GtkWidget *test_ = nullptr;
  GtkWidget *felt_ = text_label("");
  GtkWidget *intensity_ = nullptr;
  GtkWidget *delay_ = nullptr;
  ChairPicture picture_;
  std::shared_ptr<Command> tested_;
  std::optional<int> next_{}; ///< motor to feel after the present one
  bool stops_ = false;        ///< the feel test was stopped by the user
  guint settled_ = 0;         ///< timeout after which the scales are written
  bool shows_ = false;        ///< the settings are being shown, not changed
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};
