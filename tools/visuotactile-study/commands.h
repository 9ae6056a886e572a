// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/command_line.h"
#include "study/folder.h"

/// The name of a factor, by default the first one's. Throws UsageError if the study has none of it.
std::string expect_factor(const TextOption &factor, const study::Study &study);

/// Prints a warning for each participant whose journal cannot be read.
void print_damaged(const char *program, const study::Folder &folder);

/// Writes a file of answers, which only the user may read if it is new.
void write_private(const std::string &path, const std::string &text);

/// main() of each command.
int make_new(int argc, char **argv);
int run_study(int argc, char **argv);
int print_status(int argc, char **argv);
int export_table(int argc, char **argv);
int write_report(int argc, char **argv);
int compute_power(int argc, char **argv);
int simulate(int argc, char **argv);
int forget(int argc, char **argv);
