// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Settings of the user, for all players or for one, which have no setting of their own.
namespace chair {

/// The driver of shakers at a sound card, on which only some programs play.
inline constexpr const char *kShakers = "audio";

/// The kind of values that a key takes.
enum class Kind
{
  flag,   ///< true or false
  number, ///< in [least, most]
  choice, ///< one of `choices`
  grid,   ///< rows x columns, each 1 to 64: 3x3
  text,   ///< anything
  path,   ///< an absolute path of a file
};

/// A setting. All but `enabled` and `grid` have the name of a property of an element.
struct Key
{
  const char *name;
  Kind kind;
  bool live; ///< also while a film plays
  const char *help;
  double least = 0;
  double most = 0;
  const char *choices = ""; ///< separated by ", "
};

/// The switch of a program.
inline constexpr const char *kEnabled = "enabled";
/// Rows and columns of the tactile map.
inline constexpr const char *kGrid = "grid";
/// Delay of all vibration.
inline constexpr const char *kDelay = "delay";
inline constexpr double kMostDelay = 500; ///< ms, either way

std::span<const Key> keys();

/// The key of that name; nullptr if there is none.
const Key *find_key(std::string_view name);

/// All of them, with commas between.
std::string names_of_keys();

/// The values that `key` takes, such as "a number from 0 to 1".
std::string expected(const Key &key);

/// Whether `key` takes `value`.
bool takes(const Key &key, const std::string &value);

/// The environment variable that beats the file: VISUOTACTILE_INTENSITY.
std::string variable(const Key &key);

struct Grid
{
  unsigned rows = 0;
  unsigned columns = 0;
};

/// A value of Kind::grid, else rows and columns 0.
Grid parse_grid(const std::string &value);

using Values = std::map<std::string, std::string>;

/// The keys that belong to a device, not to the user.
inline constexpr std::array kOfDevice = { kGrid, "mapping", "calibration" };

/// The settings of one program.
struct Settings
{
  Values values{};                       ///< valid ones by key
  std::vector<std::string> complaints{}; ///< invalid ones: a line each
  bool others = false;                   ///< whether another program is switched on

  /// Switched on or off for this program. Where nothing is said: `otherwise`.
  bool enabled(bool otherwise) const;

  /// For a program that cannot play on shakers: its driver is the usual one instead, with a
  /// complaint.
  void leave_out_shakers();
};

/// The names by which this process finds its section: of the executable file, and g_get_prgname().
/// The latter comes first.
std::vector<std::string> program_names();

/// The settings in the user's file and the environment, for this process. A key of the program's
/// section overrides that of [chair], but for `mute=true` of [chair], and an environment variable
/// overrides both. Entries that cannot be read are ignored.
Settings read_settings();

/// Whether any program is switched on.
bool any_enabled();

} // namespace chair
