// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The commands of tactor-calibrate. Each takes its own arguments, argv[0] being its name, and
// returns the exit status: 0, or 2 for arguments that are wrong. What else goes wrong is thrown.

int run_measure(int argc, char **argv);
int run_analyse(int argc, char **argv);
int run_show(int argc, char **argv);
int run_check(int argc, char **argv);
