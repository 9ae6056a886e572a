// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

/// Commands of visuotactile-settings. As Command::run.
int list(int argc, char **argv);
int set(int argc, char **argv);
int unset(int argc, char **argv);
int switch_on(int argc, char **argv);
int switch_off(int argc, char **argv);
int devices(int argc, char **argv);
int players(int argc, char **argv);
int use(int argc, char **argv);
int test(int argc, char **argv);
