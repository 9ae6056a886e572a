// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

/// main() of each command.
int make_new(int argc, char **argv);
int run_study(int argc, char **argv);
int print_status(int argc, char **argv);
int export_table(int argc, char **argv);
int write_report(int argc, char **argv);
int compute_power(int argc, char **argv);
int simulate(int argc, char **argv);
int forget(int argc, char **argv);
