// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair/settings_file.h"

#include "files/regular_file.h"
#include "files/replace.h"

#include <cerrno>

#include <fcntl.h>
#include <glib/gstdio.h>
#include <sys/file.h>
#include <unistd.h>

namespace chair {

namespace {

constexpr std::size_t kMostBytes = std::size_t{ 1 } << 20;

using Error = tl::unexpected<std::string>;

/// The error of make_settings_folder().
Error
cannot_make(const std::string &path)
{
  const int number = errno;
  g_autofree gchar *folder = g_path_get_dirname(path.c_str());
  return Error("cannot make the folder '" + std::string(folder) + "': " + g_strerror(number));
}

} // namespace

std::string
settings_path()
{
  g_autofree gchar *path
      = g_build_filename(g_get_user_config_dir(), "visuotactile", "chair.conf", nullptr);
  return path;
}

bool
make_settings_folder(const std::string &path)
{
  g_autofree gchar *folder = g_path_get_dirname(path.c_str());
  return g_mkdir_with_parents(folder, 0700) == 0;
}

bool
is_program_name(const std::string &name)
{
  return !name.empty() && name.size() <= 255 && name.find_first_of("[]/\r\n\t") == std::string::npos
         && g_utf8_validate(name.c_str(), -1, nullptr);
}

SettingsFile::SettingsFile(std::string path)
    : path_(std::move(path)), file_(g_key_file_new(), g_key_file_unref)
{
}

tl::expected<SettingsFile, std::string>
SettingsFile::load(const std::string &path)
{
  const auto refused = [&path](const std::string &why) {
    return Error("cannot read the settings '" + path + "': " + why);
  };
  const tl::expected<std::string, files::Error> text = files::read(path, kMostBytes);
  SettingsFile file(path);
  if (!text && text.error().number == ENOENT)
    return file;
  if (!text)
    return refused(text.error().reason);
  g_autoptr(GError) error = nullptr;
  if (!g_key_file_load_from_data(file.file_.get(), text->data(), text->size(),
                                 G_KEY_FILE_KEEP_COMMENTS, &error))
    return refused(error->message);
  return file;
}

tl::expected<SettingsFile, std::string>
SettingsFile::load_to_change(const std::string &path)
{
  g_autofree gchar *folder = g_path_get_dirname(path.c_str());
  const int lock
      = make_settings_folder(path) ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
  if (lock < 0)
    return cannot_make(path);
  const std::shared_ptr<const int> owned(new int(lock), [](const int *fd) {
    close(*fd);
    delete fd;
  });
  if (flock(lock, LOCK_EX) != 0)
    return Error("cannot lock the folder '" + std::string(folder) + "': " + g_strerror(errno));
  tl::expected<SettingsFile, std::string> file = load(path);
  if (file)
    file->lock_ = owned;
  return file;
}

std::vector<std::string>
SettingsFile::sections() const
{
  g_auto(GStrv) groups = g_key_file_get_groups(file_.get(), nullptr);
  return { groups, groups + g_strv_length(groups) };
}

Values
SettingsFile::values(const std::string &section, std::vector<std::string> &complaints) const
{
  Values values;
  g_auto(GStrv) names = g_key_file_get_keys(file_.get(), section.c_str(), nullptr, nullptr);
  for (gchar **name = names; name && *name; name++) {
    const std::string place = path_ + ", [" + section + "] " + *name + ": ";
    const Key *key = find_key(*name);
    if (key == nullptr) {
      complaints.push_back(place + "unknown; the keys are " + names_of_keys());
      continue;
    }
    g_autofree gchar *value = g_key_file_get_string(file_.get(), section.c_str(), *name, nullptr);
    if (value == nullptr && key->kind == Kind::path) { // which may be no UTF-8
      g_autofree gchar *bytes = g_key_file_get_value(file_.get(), section.c_str(), *name, nullptr);
      if (bytes && !g_utf8_validate(bytes, -1, nullptr) && !g_str_has_suffix(bytes, "\\"))
        value = g_strcompress(bytes);
    }
    if (value && takes(*key, value))
      values[*name] = value;
    else
      complaints.push_back(place + "expected " + expected(*key)
                           + (value ? ", got '" + std::string(value) + "'" : ""));
  }
  return values;
}

void
SettingsFile::set(const std::string &section, const std::string &key, const std::string &value)
{
  g_key_file_set_string(file_.get(), section.c_str(), key.c_str(), value.c_str());
}

bool
SettingsFile::unset(const std::string &section, const std::string &key)
{
  if (!g_key_file_remove_key(file_.get(), section.c_str(), key.c_str(), nullptr))
    return false;
  gsize left = 0;
  g_auto(GStrv) keys = g_key_file_get_keys(file_.get(), section.c_str(), &left, nullptr);
  if (left == 0)
    g_key_file_remove_group(file_.get(), section.c_str(), nullptr);
  return true;
}

/// The section in which the settings of a device wait that is not used.
static std::string
waiting_section(const std::string &driver, const std::string &device)
{
  const auto escaped = [](const std::string &name) {
    g_autofree gchar *text = g_uri_escape_string(name.c_str(), " /@:", TRUE);
    return std::string(text);
  };
  return "device " + escaped(driver) + (device.empty() ? "" : " " + escaped(device));
}

/// Those of the device; in `to` are no others afterwards.
void
SettingsFile::move_keys(const std::string &from, const std::string &to)
{
  for (const char *key : kOfDevice) {
    unset(to, key);
    g_autofree gchar *value = g_key_file_get_value(file_.get(), from.c_str(), key, nullptr);
    if (value)
      g_key_file_set_value(file_.get(), to.c_str(), key, value);
    unset(from, key);
  }
}

void
SettingsFile::use(const std::string &driver, const std::string &device)
{
  std::vector<std::string> complaints;
  Values former = values(kEveryProgram, complaints);
  const std::string former_driver
      = former.try_emplace("driver", "auto").first->second; // as programs read it
  const std::string &former_device = former["device"];
  if (former_driver == driver && former_device == device)
    return;
  move_keys(kEveryProgram, waiting_section(former_driver, former_device));
  move_keys(waiting_section(driver, device), kEveryProgram);
  set(kEveryProgram, "driver", driver);
  if (device.empty())
    unset(kEveryProgram, "device");
  else
    set(kEveryProgram, "device", device);
}

tl::expected<void, std::string>
SettingsFile::save() const
{
  g_autoptr(GError) error = nullptr;
  if (!make_settings_folder(path_))
    return cannot_make(path_);
  if (!g_key_file_save_to_file(file_.get(), files::target_of(path_).c_str(), &error))
    return Error("cannot write the settings '" + path_ + "': " + error->message);
  return {};
}

} // namespace chair
