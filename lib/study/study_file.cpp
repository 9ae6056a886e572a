// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A study's key file.
#include "study/events.h"
#include "study/study.h"

#include "files/whole_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string_view>

#include <glib.h>

namespace study {

namespace {

constexpr std::size_t kMostConditions = 32;
constexpr std::size_t kMostQuestions = 500;
constexpr double kMostPoints = 100; ///< of a Likert scale

struct Setting
{
  const char *name;
  const char *choices; ///< " a b "; null: a number in [least, most]; empty: a text
  double least = 0;
  double most = 0;
};

constexpr Setting kSettings[] = {
  { "film", "" },
  { "noise", nullptr, 0, 1 },
  { "intensity", nullptr, 0, 1 },
  { "profile", " tuned paper " },
  { "people", " off fast thorough " },
  { "sound", " off film music dialogue-heavy bass-shaker " },
  { "compensation", " exact frame-block none " },
  { "rate", nullptr, 0, 1000 },
  { "sensitivity", nullptr, 0.1, 10 },
  { "density", nullptr, 0, 1 },
  { "rows", nullptr, 1, 64 },
  { "columns", nullptr, 1, 64 },
  { "driver", "" },
  { "device", "" },
  { "mapping", "" },
  { "calibration", "" },
};

/// Names of columns of the table and of the report's, and words of R: no factor may have one.
constexpr std::string_view kColumns
    = " participant state group session question kind answer text time response_ms "
      "marks plays film_file settings program gstreamer study consent trace commands "
      "late error_p50_ms error_p99_ms error_max_ms frames frames_dropped value n "
      "mean se bar if else repeat while function for next break in TRUE FALSE NULL "
      "Inf NaN NA ";

using KeyFile = std::unique_ptr<GKeyFile, void (*)(GKeyFile *)>;

/// Reads a key file group by group and keeps the first fault.
class Reader
{
public:
  explicit Reader(const std::string &text) : file_(g_key_file_new(), g_key_file_unref)
  {
    g_autoptr(GError) error = nullptr;
    if (!g_key_file_load_from_data(file_.get(), text.data(), text.size(), G_KEY_FILE_NONE, &error))
      fail("", "", error->message);
  }

  const std::string &fault() const
  {
    return fault_;
  }
  void fail(const std::string &group, const std::string &key, const std::string &what)
  {
    if (fault_.empty())
      fault_ = (group.empty() ? "" : "[" + group + "]") + (key.empty() ? "" : " " + key)
               + (group.empty() ? "" : ": ") + what;
  }

  /// Groups whose name begins with this word, without the word.
  std::vector<std::string> groups(const std::string &word) const
  {
    std::vector<std::string> found;
    for (const std::string &group : all_groups())
      if (group.starts_with(word + " "))
        found.push_back(group.substr(word.size() + 1));
    return found;
  }
  std::vector<std::string> all_groups() const
  {
    return taken(g_key_file_get_groups(file_.get(), nullptr));
  }
  std::vector<std::string> keys(const std::string &group) const
  {
    return taken(g_key_file_get_keys(file_.get(), group.c_str(), nullptr, nullptr));
  }
  bool has(const std::string &group) const
  {
    return g_key_file_has_group(file_.get(), group.c_str()) != FALSE;
  }

  void expect_keys(const std::string &group, const std::vector<std::string> &known)
  {
    for (const std::string &key : keys(group))
      if (std::ranges::find(known, key) == known.end())
        fail(group, key, "unknown; the keys are " + joined(known, ", "));
  }

  std::string text(const std::string &group, const std::string &key,
                   const std::string &otherwise = "")
  {
    g_autoptr(GError) error = nullptr;
    g_autofree gchar *value
        = g_key_file_get_string(file_.get(), group.c_str(), key.c_str(), &error);
    if (value)
      return value;
    if (!g_error_matches(error, G_KEY_FILE_ERROR, G_KEY_FILE_ERROR_KEY_NOT_FOUND)
        && !g_error_matches(error, G_KEY_FILE_ERROR, G_KEY_FILE_ERROR_GROUP_NOT_FOUND))
      fail(group, key, error->message);
    return otherwise;
  }

  std::vector<std::string> texts(const std::string &group, const std::string &key)
  {
    return taken(
        g_key_file_get_string_list(file_.get(), group.c_str(), key.c_str(), nullptr, nullptr));
  }

  double number(const std::string &group, const std::string &key, double otherwise, double least,
                double most)
  {
    const std::string value = text(group, key);
    if (value.empty())
      return otherwise;
    gchar *end = nullptr;
    const double number = g_ascii_strtod(value.c_str(), &end);
    if (*end != '\0' || !(number >= least && number <= most)) {
      std::array<char, 96> range{};
      g_snprintf(range.data(), range.size(), "a number from %g to %g", least, most);
      fail(group, key, std::string("expected ") + range.data() + ", got '" + value + "'");
    }
    return number;
  }

  GKeyFile *file() const
  {
    return file_.get();
  }

private:
  /// Frees the list; null: it is empty.
  static std::vector<std::string> taken(gchar **list)
  {
    g_auto(GStrv) texts = list;
    return list ? std::vector<std::string>(list, list + g_strv_length(list))
                : std::vector<std::string>();
  }

  KeyFile file_;
  std::string fault_;
};

/// Whether a factor, level or question may have the name.
bool
is_name(const std::string &name)
{
  return !name.empty() && name.size() <= 40 && g_ascii_isalpha(name[0])
         && std::ranges::all_of(
             name, [](char c) { return g_ascii_isalnum(c) || c == '-' || c == '_' || c == '.'; });
}

/// The settings of a group, without its keys in `known`.
Settings
read_settings(Reader &reader, const std::string &group,
              std::initializer_list<std::string_view> known = {})
{
  Settings settings;
  for (const std::string &key : reader.keys(group)) {
    if (std::ranges::find(known, key) != known.end())
      continue;
    const auto *const setting
        = std::ranges::find_if(kSettings, [&](const Setting &one) { return key == one.name; });
    if (setting == std::end(kSettings)) {
      reader.fail(group, key, "unknown; the settings are " + names_of_settings());
      continue;
    }
    const std::string value = reader.text(group, key);
    if (setting->choices == nullptr)
      reader.number(group, key, 0, setting->least, setting->most);
    else if (*setting->choices != '\0'
             && (value.find(' ') != std::string::npos
                 || std::string_view(setting->choices).find(" " + value + " ")
                        == std::string_view::npos))
      reader.fail(group, key,
                  std::string("expected one of") + setting->choices + "and got '" + value + "'");
    settings[key] = value;
  }
  return settings;
}

void
read_factors(Reader &reader, Study &study)
{
  std::size_t conditions = 1;
  std::size_t groups = 1;
  for (const std::string &name : reader.groups("factor")) {
    const std::string group = "factor " + name;
    reader.expect_keys(group, { "label", "levels", "design" });
    if (!is_name(name) || name.find_first_of("-.") != std::string::npos
        || kColumns.find(" " + name + " ") != std::string_view::npos)
      reader.fail(
          group, "",
          "expected a name of letters, digits and _ that is no column of a table and no word of R");
    const std::string design = reader.text(group, "design", "within");
    if (design != "within" && design != "between")
      reader.fail(group, "design", "expected within or between, got '" + design + "'");
    Factor factor{ .name = name,
                   .label = reader.text(group, "label", name),
                   .between = design == "between",
                   .levels = {} };
    for (const std::string &level : reader.texts(group, "levels")) {
      const std::string of_level = "level " + name + " " + level;
      if (!is_name(level))
        reader.fail(group, "levels", "expected names of letters, digits, _, - and .");
      if (std::ranges::find(factor.levels, level, &Level::name) != factor.levels.end())
        reader.fail(group, "levels", "'" + level + "' is there twice");
      factor.levels.push_back({ .name = level,
                                .label = reader.text(of_level, "label", level),
                                .settings = read_settings(reader, of_level, { "label" }) });
    }
    if (factor.levels.size() < 2)
      reader.fail(group, "levels", "expected two or more, with semicolons between");
    std::size_t &combinations = factor.between ? groups : conditions;
    combinations *= std::max<std::size_t>(factor.levels.size(), 1);
    if (combinations > kMostConditions)
      return reader.fail(group, "levels",
                         "expected at most " + std::to_string(kMostConditions)
                             + " sessions a participant, and as many groups");
    study.factors.push_back(std::move(factor));
  }
  for (const std::string &name : reader.groups("level")) {
    const bool is_known = std::ranges::any_of(study.factors, [&](const Factor &factor) {
      return std::ranges::any_of(factor.levels, [&](const Level &level) {
        return name == factor.name + " " + level.name;
      });
    });
    if (!is_known)
      reader.fail("level " + name, "", "expected a factor and one of its levels");
  }
}

Settings
read_when(Reader &reader, const std::string &group, const Study &study, bool at_end)
{
  Settings when;
  for (const std::string &one : reader.texts(group, "when")) {
    const std::size_t colon = one.find(':');
    const std::string factor = one.substr(0, colon);
    const std::string level = colon == std::string::npos ? "" : one.substr(colon + 1);
    const auto found = std::ranges::find(study.factors, factor, &Factor::name);
    if (found == study.factors.end()
        || std::ranges::find(found->levels, level, &Level::name) == found->levels.end())
      reader.fail(group, "when", "expected FACTOR:LEVEL, got '" + one + "'");
    else if (at_end && !found->between)
      reader.fail(group, "when",
                  "expected a factor between for a question at-end, got '" + one
                      + "', which changes from session to session");
    if (!when.emplace(factor, level).second)
      reader.fail(group, "when", "expected one level of a factor, got two of '" + factor + "'");
  }
  return when;
}

void
read_questions(Reader &reader, Study &study)
{
  constexpr double kFar = 1e6;
  for (const std::string &name : reader.groups("question")) {
    const std::string group = "question " + name;
    reader.expect_keys(group, { "text", "kind", "low", "high", "step", "labels", "time", "when" });
    if (!is_name(name))
      reader.fail(group, "", "expected a name of letters, digits, _, - and .");
    Question question{ .name = name, .text = reader.text(group, "text") };
    const std::string kind = reader.text(group, "kind", "slider");
    const std::string time = reader.text(group, "time", "after-film");
    question.kind = kind == "likert" ? Question::Kind::likert
                    : kind == "text" ? Question::Kind::text
                                     : Question::Kind::slider;
    if (kind != name_of(question.kind))
      reader.fail(group, "kind", "expected slider, likert or text, got '" + kind + "'");
    if (question.text.empty())
      reader.fail(group, "text", "expected the words of the question");
    question.at_end = time == "at-end";
    if (!question.at_end && time != "after-film")
      reader.fail(group, "time", "expected after-film or at-end, got '" + time + "'");
    question.low = reader.number(group, "low", 1, -kFar, kFar);
    question.high = reader.number(group, "high", 100, -kFar, kFar);
    question.step = reader.number(group, "step", 1, 1e-3, kFar);
    if (question.high <= question.low)
      reader.fail(group, "high", "expected a number above low");
    question.labels = reader.texts(group, "labels");
    if (question.kind == Question::Kind::likert
        && (question.labels.size() < 2
            || static_cast<double>(question.labels.size()) > kMostPoints))
      reader.fail(group, "labels", "expected one for each point of the scale, 2 to 100");
    question.when = read_when(reader, group, study, question.at_end);
    study.questions.push_back(std::move(question));
  }
  if (study.questions.empty())
    reader.fail("question Q1", "", "expected at least one question");
  if (study.questions.size() > kMostQuestions)
    reader.fail("question", "", "expected at most 500");
}

/// Reads a file. Relative paths begin at the folder.
tl::expected<std::string, std::string>
read_beside(const std::string &folder, const std::string &name)
{
  const std::filesystem::path path = std::filesystem::path(name).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == "..")
    return tl::unexpected("expected the name of a file in the study's folder, got '" + name + "'");
  auto text = files::read_whole(folder + "/" + name, kMostText);
  if (text && !g_utf8_validate(text->data(), static_cast<gssize>(text->size()), nullptr))
    return tl::unexpected("'" + name + "': expected a text in UTF-8");
  return text;
}

/// The items of a questionnaire, one a line, become questions.
tl::expected<void, std::string>
add_items(Reader &reader, const std::string &name, const std::string &folder)
{
  const std::string group = "questionnaire " + name;
  const auto text = read_beside(folder, reader.text(group, "file"));
  if (!text)
    return tl::unexpected("[" + group + "] file: " + text.error());
  std::size_t number = 0;
  g_auto(GStrv) lines = g_strsplit(text->c_str(), "\n", -1);
  for (gchar **line = lines; *line; line++) {
    const std::string item = g_strstrip(*line);
    if (item.empty() || item[0] == '#')
      continue;
    const std::string question = "question " + name + std::to_string(++number);
    if (reader.has(question))
      return tl::unexpected("[" + question + "]: expected another name, as [" + group
                            + "] gives this one to an item");
    g_key_file_set_string(reader.file(), question.c_str(), "text", item.c_str());
    for (const std::string &key : reader.keys(group))
      if (key != "file") {
        g_autofree gchar *value
            = g_key_file_get_value(reader.file(), group.c_str(), key.c_str(), nullptr);
        g_key_file_set_value(reader.file(), question.c_str(), key.c_str(), value);
      }
  }
  if (number == 0)
    return tl::unexpected("[" + group + "] file: expected items in it, one a line");
  g_key_file_remove_group(reader.file(), group.c_str(), nullptr);
  return {};
}

} // namespace

std::string
names_of_settings()
{
  std::vector<std::string> names;
  for (const Setting &setting : kSettings)
    names.emplace_back(setting.name);
  return joined(names, ", ");
}

tl::expected<Study, std::string>
read_study(const std::string &text)
{
  Reader reader(text);
  if (!reader.fault().empty())
    return tl::unexpected(reader.fault());
  for (const std::string &group : reader.all_groups()) {
    const std::string word = group.substr(0, group.find(' '));
    const bool is_single = word == "study" || word == "settings" || word == "practice";
    if (is_single ? group != word
                  : word == group || (word != "factor" && word != "level" && word != "question"))
      reader.fail(group, "",
                  "unknown; the groups are study, settings, practice, factor NAME, level FACTOR "
                  "NAME, question NAME and questionnaire NAME");
  }
  constexpr double kDay = 86400;
  reader.expect_keys("study", { "title", "values", "people", "break", "consent", "consent-version",
                                "instructions", "thanks", "seed", "latest", "most-dropped" });
  Study study;
  study.title = reader.text("study", "title", "Study");
  study.description = reader.text("study", "values", "Rating");
  study.people = static_cast<unsigned>(reader.number("study", "people", 12, 1, 10000));
  study.least_break = reader.number("study", "break", 121, 0, kDay);
  study.consent = reader.text("study", "consent");
  study.consent_version = reader.text("study", "consent-version");
  study.instructions = reader.text("study", "instructions");
  study.thanks = reader.text("study", "thanks", "Thank you.");
  study.seed = static_cast<std::uint64_t>(reader.number("study", "seed", 1, 0, 1e9));
  study.latest = reader.number("study", "latest", 20, 0, 1e6);
  study.most_dropped = reader.number("study", "most-dropped", 1, 0, 100);
  if (study.consent.empty() || study.consent_version.empty())
    reader.fail("study", "consent", "expected the text of the consent, and consent-version");
  study.settings = read_settings(reader, "settings");
  if (reader.has("practice"))
    study.practice = read_settings(reader, "practice");
  read_factors(reader, study);
  read_questions(reader, study);
  if (!reader.fault().empty())
    return tl::unexpected(reader.fault());
  return study;
}

tl::expected<std::string, std::string>
whole_study(const std::string &text, const std::string &folder)
{
  Reader reader(text);
  if (!reader.fault().empty())
    return tl::unexpected(reader.fault());
  for (const std::string key : { "consent", "instructions", "thanks" }) {
    const std::string from = key + "-file";
    const std::string name = reader.text("study", from);
    if (name.empty())
      continue;
    const auto content = read_beside(folder, name);
    if (!content)
      return tl::unexpected("[study] " + from + ": " + content.error());
    g_key_file_set_string(reader.file(), "study", key.c_str(), content->c_str());
    g_key_file_remove_key(reader.file(), "study", from.c_str(), nullptr);
  }
  for (const std::string &name : reader.groups("questionnaire"))
    if (const auto added = add_items(reader, name, folder); !added)
      return tl::unexpected(added.error());
  gsize length = 0;
  g_autofree gchar *whole = g_key_file_to_data(reader.file(), &length, nullptr);
  return std::string(whole, length);
}

} // namespace study
