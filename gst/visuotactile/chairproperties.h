// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "chair/settings.h"
#include "chair/settings_watch.h"

#include <gst/gst.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// Applies the user's settings to the elements of a chair, also while a film plays. A property that
/// the player has changed from its default stays as it is.
class ChairProperties
{
public:
  /// `owner` posts warnings about the settings; it and the elements live longer than this.
  ChairProperties(GstElement *owner, std::vector<GstElement *> elements);

  /// Reads the settings, and follows them until close(). Not on several threads at once, as
  /// close(). Returns them.
  chair::Settings open();
  void close();
  /// Posts the driver and its reason.
  void post_driver();

private:
  void apply(const chair::Settings &settings, bool all);
  void give(const char *property, const std::optional<std::string> &value);
  void complain(const chair::Settings &settings);
  const char *reason(GstElement *element, GParamSpec *spec);

  GstElement *owner_;
  std::vector<GstElement *> elements_;
  std::mutex mutex_{};
  std::map<std::string, std::string> given_{}; ///< property and its value then; under the mutex
  std::unique_ptr<chair::SettingsWatch> watch_{};
};
