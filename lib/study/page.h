// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/folder.h"

#include <string>

/// What pages are told, in JSON.
namespace study {

/// How the film of a step is.
enum class Phase
{
  ready,
  playing,
  failed, ///< the experimenter decides
};

/// Of the participant's page; null: nobody has begun.
std::string page_state(const Study &study, const Participant *participant, Phase phase,
                       std::int64_t at = now());

/// Of the experimenter's page.
std::string overview(const Folder &folder, const Participant *active, Phase phase,
                     std::int64_t at = now());

} // namespace study
