// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

/// Throws UsageError unless tactorsink has a driver of this name, or it is `another` one that the
/// program has.
void expect_driver(const std::string &name, const std::string &another = "");
