// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <stdexcept>
#include <utility>

#include <tl/expected.hpp>

/// The value, or else the error's text as std::runtime_error, with which a program ends.
template <typename T, typename Error>
T
or_throw(tl::expected<T, Error> result)
{
  if (result)
    return *std::move(result);
  if constexpr (requires { result.error().text(); })
    throw std::runtime_error(result.error().text());
  // cppcheck-suppress identicalConditionAfterEarlyExit ; cppcheck 2.10 cannot read `requires`
  else if constexpr (requires { result.error().text.size(); })
    throw std::runtime_error(result.error().text);
  else
    throw std::runtime_error(result.error());
}

template <typename Error>
void
or_throw(const tl::expected<void, Error> &result)
{
  or_throw(tl::expected<bool, Error>(result.map([] { return true; })));
}
