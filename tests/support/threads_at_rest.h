// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Whether the other threads of this process have anything left to do, by proc(5): a thread that is
// ready to run counts as busy even where the host gives it no processor. A test that moves a clock
// only then needs no time of its own, at any load.
#pragma once

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include <unistd.h>

/// How often each other thread went to sleep so far, or nothing where one is awake.
inline std::optional<std::map<std::string, long>>
sleeps_of_other_threads()
{
  std::map<std::string, long> sleeps;
  std::error_code error;
  for (const auto &task : std::filesystem::directory_iterator("/proc/self/task", error)) {
    const std::string id = task.path().filename();
    if (id == std::to_string(gettid()))
      continue;
    std::ifstream status(task.path() / "status");
    for (std::string name; status >> name; std::getline(status, name)) {
      std::string state;
      if (name == "State:" && status >> state && state != "S")
        return std::nullopt;
      if (name == "voluntary_ctxt_switches:")
        status >> sleeps[id];
    }
  }
  return sleeps;
}

/// True if no other thread was awake between two looks at all of them.
inline bool
other_threads_rest()
{
  const auto before = sleeps_of_other_threads();
  return before && before == sleeps_of_other_threads();
}
