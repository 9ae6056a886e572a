// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libsoup/soup.h>

#include <string>

/// Answers with a file, or with the requested range of it, piece by piece.
void answer_file(SoupServerMessage *message, const std::string &path, const char *type);
