// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tl/expected.hpp>

#include <cstdlib>
#include <string>
#include <type_traits>
#include <utility>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include <gst/check/gstcheck.h>

inline const std::string &
text_of(const std::string &error)
{
  return error;
}

template <class Error>
const std::string &
text_of(const Error &error)
{
  return error.text;
}

/// The value of a call that must not fail.
template <class T, class Error>
T
unwrap(tl::expected<T, Error> result)
{
  fail_unless(result.has_value(), "%s", result ? "" : text_of(result.error()).c_str());
  if constexpr (!std::is_void_v<T>)
    return std::move(*result);
}

/// The error of a call that must fail.
template <class T, class Error>
Error
refusal_of(const tl::expected<T, Error> &result)
{
  fail_if(result.has_value(), "it did not fail");
  if (result)
    std::abort();
  return result.error();
}
