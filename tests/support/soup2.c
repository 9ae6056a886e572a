// SPDX-License-Identifier: LGPL-2.1-or-later
// Stands for libsoup 2 in a program: the driver looks for its name. Not every release still has
// it.
int visuotactile_not_libsoup(void);

int
visuotactile_not_libsoup(void)
{
  return 2;
}
