// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <vector>

/// The order of conditions for each participant.
namespace study {

using Row = std::vector<std::size_t>;

/// A Williams square of `count` conditions: each condition has each position once, and follows each
/// other condition equally often. `count` rows, or twice as many if it is odd. (Williams, E. J.:
/// Experimental designs balanced for the estimation of residual effects of treatments. Australian
/// J. of Scientific Research A 2, 1949)
std::vector<Row> williams_square(std::size_t count);

/// A row of the square of a group of participants.
struct Place
{
  std::size_t group = 0;
  std::size_t row = 0;

  bool operator==(const Place &) const = default;
};

/// A place that was given to a participant.
struct GivenPlace
{
  Place place;
  bool is_free = false; ///< the participant was dropped
};

/// The place of the next participant: one that became free; else, in the smallest group, one of the
/// least used rows, the one that makes positions and successions most even.
Place next_place(std::size_t groups, const std::vector<Row> &square,
                 const std::vector<GivenPlace> &given);

} // namespace study
