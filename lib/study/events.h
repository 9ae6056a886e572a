// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace study {

/// ms since 1970, by the clock of the computer.
std::int64_t now();

/// 2026-11-27T06:55:34.123Z
std::string date_text(std::int64_t time);

/// A line of a participant's journal: a JSON object with its kind and time.
class Event
{
public:
  explicit Event(const char *kind, std::int64_t at = now());

  Event &add(const char *name, const std::string &text);
  Event &add(const char *name, double number);
  Event &add(const char *name, std::int64_t number);
  /// `json` is added as it is.
  Event &add_json(const char *name, const std::string &json);

  std::string line() const
  {
    return line_ + "}";
  }

private:
  std::string line_;
};

/// With spaces, or something else, between.
std::string joined(const std::vector<std::string> &words, const char *between = " ");

/// A number in JSON, in any locale.
std::string write_number(double number);

} // namespace study
