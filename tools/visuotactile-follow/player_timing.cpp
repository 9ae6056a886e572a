// SPDX-License-Identifier: LGPL-2.1-or-later
#include "player_timing.h"

#include "files/regular_file.h"
#include "files/whole_file.h"
#include "translation.h"

#include <glib/gstdio.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace {

constexpr const char *kOffset = "offset";
constexpr std::uintmax_t kMostBytes = std::uintmax_t{ 1 } << 20;

} // namespace

std::string
player_kind(const std::string &name)
{
  std::string kind = name.substr(0, name.find_first_of(" ."));
  std::ranges::transform(kind, kind.begin(), [](char c) { return g_ascii_tolower(c); });
  std::erase_if(kind, [](char c) { return !g_ascii_isalnum(c) && c != '-' && c != '_'; });
  return kind.empty() ? "player" : kind;
}

std::optional<SyncTo>
sync_of(std::string_view name)
{
  for (const SyncTo sync : { SyncTo::screen, SyncTo::sound })
    if (name == name_of(sync))
      return sync;
  return std::nullopt;
}

const char *
name_of(SyncTo sync)
{
  return sync == SyncTo::screen ? "screen" : "sound";
}

std::string
PlayerTiming::usual_path()
{
  g_autofree gchar *path
      = g_build_filename(g_get_user_config_dir(), "visuotactile", "follow.conf", nullptr);
  return path;
}

PlayerTiming::PlayerTiming(std::string path)
    : path_(std::move(path)), file_(g_key_file_new(), g_key_file_unref)
{
  read();
}

void
PlayerTiming::read()
{
  const tl::expected<std::string, files::Error> text = files::read(path_, kMostBytes);
  if (!text && text.error().number == ENOENT) {
    file_.reset(g_key_file_new());
    return;
  }
  if (!text)
    throw std::runtime_error(in_text("cannot read '{}': {}", path_, text.error().reason));
  g_autoptr(GError) error = nullptr;
  if (!g_key_file_load_from_data(file_.get(), text->data(), text->size(), G_KEY_FILE_KEEP_COMMENTS,
                                 &error))
    throw std::runtime_error(in_text("cannot read '{}': {}", path_, error->message));
}

std::optional<double>
PlayerTiming::number(const std::string &kind, const char *key) const
{
  g_autoptr(GError) error = nullptr;
  const double number = g_key_file_get_double(file_.get(), kind.c_str(), key, &error);
  return error == nullptr && std::abs(number) <= kMost ? std::optional(number) : std::nullopt;
}

std::optional<SyncTo>
PlayerTiming::sync_to(const std::string &kind) const
{
  g_autofree gchar *name = g_key_file_get_string(file_.get(), kind.c_str(), "sync-to", nullptr);
  return name != nullptr ? sync_of(name) : std::nullopt;
}

std::optional<double>
PlayerTiming::screen_latency(const std::string &kind) const
{
  return number(kind, "screen-latency");
}

std::optional<double>
PlayerTiming::sound_latency(const std::string &kind) const
{
  return number(kind, "sound-latency");
}

std::optional<ServerSettings>
PlayerTiming::server(follow::ServerKind kind) const
{
  const auto text = [&](const char *key) -> std::string {
    g_autofree gchar *value = g_key_file_get_string(file_.get(), name_of(kind), key, nullptr);
    return value != nullptr ? value : "";
  };
  ServerSettings settings{
    .kind = kind, .address = text("server"), .token = text("token"), .device = text("device")
  };
  return !settings.address.empty() && !settings.token.empty() ? std::optional(std::move(settings))
                                                              : std::nullopt;
}

bool
PlayerTiming::is_public() const
{
  GStatBuf status;
  return g_stat(path_.c_str(), &status) == 0 && (status.st_mode & (S_IRGRP | S_IROTH)) != 0;
}

/// Names of groups have no brackets and control characters.
std::string
PlayerTiming::film_group(const std::string &film)
{
  g_autofree gchar *name = g_uri_escape_string(film.c_str(), nullptr, FALSE);
  return std::string("film ") + name;
}

double
PlayerTiming::offset(const std::string &kind) const
{
  return number(kind, kOffset).value_or(0);
}

void
PlayerTiming::set_offset(const std::string &kind, double offset)
{
  read();
  g_key_file_set_double(file_.get(), kind.c_str(), kOffset, std::clamp(offset, -kMost, kMost));
  g_autofree gchar *folder = g_path_get_dirname(path_.c_str());
  if (g_mkdir_with_parents(folder, 0700) != 0)
    throw std::runtime_error(in_text("cannot make the folder '{}': {}", folder, g_strerror(errno)));
  gsize length = 0;
  g_autofree gchar *text = g_key_file_to_data(file_.get(), &length, nullptr);
  const auto written = files::replace_file(path_, { text, length }, files::Readers::user);
  if (!written)
    throw std::runtime_error(in_text("cannot write {}", written.error()));
}
