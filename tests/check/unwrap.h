// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tl/expected.hpp>

#include <cstdlib>
#include <string>
#include <type_traits>
#include <utility>

// After the standard library's headers: gstcheck.h defines a macro named fail.
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

/// What a call returned that must not fail.
template <class T, class Error>
T
unwrap(tl::expected<T, Error> result)
{
  fail_unless(result.has_value(), "%s", result ? "" : text_of(result.error()).c_str());
  if constexpr (!std::is_void_v<T>)
    return std::move(*result);
}

/// Why a call failed, which it must.
template <class T, class Error>
Error
refusal_of(const tl::expected<T, Error> &result)
{
  fail_if(result.has_value(), "it did not fail");
  if (result)
    std::abort();
  return result.error();
}
