// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/check/gstcheck.h>

/// The statement must log a critical message and return nothing.
#define ASSERT_REFUSED(statement)                                                                  \
  G_STMT_START                                                                                     \
  {                                                                                                \
    g_test_expect_message("visuotactile", G_LOG_LEVEL_CRITICAL, "*assertion*failed*");             \
    fail_if(statement);                                                                            \
    g_test_assert_expected_messages();                                                             \
  }                                                                                                \
  G_STMT_END
