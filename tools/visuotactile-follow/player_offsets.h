// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib.h>

#include <memory>
#include <string>

/// What kind of player it is by its name: "vlc" of "vlc.instance123", "mpv" of "mpv at /run/…".
std::string player_kind(const std::string &name);

/// How much later than players of each kind say it their picture is on the screen, in ms, as the
/// user has set it, in a key file: [vlc] offset=40.
class PlayerOffsets
{
public:
  static constexpr double kMost = 5000; ///< ms, either way

  /// $XDG_CONFIG_HOME/visuotactile/follow.conf
  static std::string usual_path();

  /// A file that does not exist is empty. Throws std::runtime_error, with the path, if it is no key
  /// file or larger than a MiB.
  explicit PlayerOffsets(std::string path);

  /// 0 where none is set, or one that is no number of at most kMost.
  double of(const std::string &kind) const;

  /// Limits it to kMost, and writes the file at once; its other lines are kept. Throws
  /// std::runtime_error with the path.
  void set(const std::string &kind, double offset);

private:
  std::string path_;
  std::unique_ptr<GKeyFile, void (*)(GKeyFile *)> file_;
};
