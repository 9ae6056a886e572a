// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gio/gio.h>

#include <functional>
#include <map>
#include <string>

/// What the running visuotactile-follow does, as it reports on the session bus. Starts none.
class FollowState
{
public:
  /// Calls `changed` after each change, at most once a second.
  explicit FollowState(std::function<void()> changed);
  ~FollowState();
  FollowState(const FollowState &) = delete;
  FollowState &operator=(const FollowState &) = delete;

  /// In a sentence.
  std::string text() const;

private:
  void look();

  std::function<void()> changed_;
  GCancellable *ended_ = g_cancellable_new();
  GDBusConnection *bus_ = nullptr;
  bool runs_ = false;
  std::map<std::string, std::string> values_{};
  guint watch_ = 0;
  guint timer_ = 0;
};
