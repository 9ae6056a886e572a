// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/folder.h"

#include <string>

namespace study {

/// The answers as CSV (RFC 4180): a row for each answer, with the data of its session.
std::string answer_table(const Folder &folder);

/// The orders of conditions as CSV: a row for each participant, a column for each position.
std::string order_table(const Folder &folder);

} // namespace study
