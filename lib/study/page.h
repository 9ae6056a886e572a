// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/folder.h"

#include <string>

/// The state of a study for its pages, in JSON.
namespace study {

/// The state of a step's film.
enum class Phase
{
  ready,
  playing,
  failed, ///< the experimenter decides
};

/// An object with a text for each name.
std::string object_json(const Settings &settings);

/// The state for the participant's page, without names of conditions. `participant`: null before
/// one begins.
std::string page_state(const Study &study, const Participant *participant, Phase phase,
                       std::int64_t at = now());

/// The state for the experimenter's page.
std::string overview(const Folder &folder, const Participant *active, Phase phase,
                     std::int64_t at = now());

} // namespace study
