// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The commands: main() of each, see film/command_line.h.
int measure(int argc, char **argv);
int analyze(int argc, char **argv);
int show(int argc, char **argv);
int check(int argc, char **argv);
