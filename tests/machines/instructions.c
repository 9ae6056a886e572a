/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* A plugin of QEMU 7 and 8 that counts the instructions of a program, of all its threads, and of
 * arm64's those of NEON, SVE and floating point. It writes both to the file that its argument "to"
 * names.
 *
 * Debian has no package with qemu-plugin.h: what is declared here is of QEMU's interface,
 * version 1. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct info
{
  const char *target_name;
};
void qemu_plugin_register_vcpu_tb_trans_cb(uint64_t id,
                                           void (*)(uint64_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *, void (*)(unsigned, void *), int,
                                          void *);
void qemu_plugin_register_atexit_cb(uint64_t id, void (*)(uint64_t, void *), void *);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
const void *qemu_plugin_insn_data(const struct qemu_plugin_insn *);

EXPORT int qemu_plugin_version = 1;
EXPORT int qemu_plugin_install(uint64_t id, const struct info *info, int argc, char **argv);

static int is_arm64;
static uint64_t all, vectors;

/* One block of instructions: how many there are, times 65536, and of them with vectors. */
static void
count(unsigned cpu, void *block)
{
  (void)cpu;
  __atomic_fetch_add(&all, (uintptr_t)block >> 16, __ATOMIC_RELAXED);
  __atomic_fetch_add(&vectors, (uintptr_t)block & 0xffff, __ATOMIC_RELAXED);
}

static void
translate(uint64_t id, struct qemu_plugin_tb *tb)
{
  const size_t n = qemu_plugin_tb_n_insns(tb);
  size_t i, of_vectors = 0;
  (void)id;
  for (i = 0; is_arm64 && i < n; i++) {
    uint32_t code;
    memcpy(&code, qemu_plugin_insn_data(qemu_plugin_tb_get_insn(tb, i)), sizeof code);
    /* op0, bits 28 to 25: x11x is NEON and floating point with its loads, 0010 is SVE. */
    of_vectors += (code >> 26 & 3) == 3 || (code >> 25 & 15) == 2;
  }
  qemu_plugin_register_vcpu_tb_exec_cb(tb, count, 0, (void *)(uintptr_t)(n << 16 | of_vectors));
}

static void
finish(uint64_t id, void *path)
{
  FILE *file = fopen(path, "w");
  (void)id;
  if (!file || fprintf(file, "%" PRIu64 " %" PRIu64 "\n", all, vectors) < 0 || fclose(file) != 0)
    abort();
}

int
qemu_plugin_install(uint64_t id, const struct info *info, int argc, char **argv)
{
  if (argc != 1 || strncmp(argv[0], "to=", 3) != 0)
    return -1;
  is_arm64 = strcmp(info->target_name, "aarch64") == 0;
  qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
  qemu_plugin_register_atexit_cb(id, finish, argv[0] + 3);
  return 0;
}
