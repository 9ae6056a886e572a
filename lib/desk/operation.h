// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "desk/document.h"

#include <optional>
#include <string>
#include <vector>

namespace desk {

/// The part of a track that an operation changes. Events are judged whole.
struct Selection
{
  std::optional<std::int32_t> from; ///< ms; none: the beginning
  std::optional<std::int32_t> to;   ///< ms; none: the end
  std::vector<int> cells;           ///< row-major from 0; empty: all
};

/// An operation of tactile-track edit. The names are in kOperations.
struct Operation
{
  std::string name;
  double value = 0;  ///< seconds, percent, factor or steps
  double second = 0; ///< of "limit": the rest in seconds
  Selection selection;
};

/// The splices of an operation. Other cues are not changed; notes stay. The error says what was
/// expected: a name, a value, a draft (null if there is none).
tl::expected<std::vector<Splice>, std::string>
operate(const Document &document, const tactile::Track *draft, const Operation &operation);

/// The least splices that make the document's cues those of `track`, in whole ms and percent.
/// Boundaries of cues between which nothing changes stay where they are.
std::vector<Splice> splices_to(const Document &document, const tactile::Track &track);

} // namespace desk
