// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mutex>
#include <vector>

namespace saliency {

/// Work stealing over the rows of an image. Each thread starts with a band of its own; one that
/// runs out takes the bottom half of the largest remaining band.
class RowShares
{
public:
  struct Rows
  {
    int begin;
    int end; ///< exclusive; equal to begin if no rows are left
  };

  /// Shares rows [0, rows) out among `threads`. Must not run concurrently with take().
  void reset(int rows, int threads);

  /// The next rows of thread number `thread`, from top to bottom except where it steals.
  Rows take(int thread);

private:
  std::mutex mutex_;
  std::vector<Rows> left_; ///< per thread
};

} // namespace saliency
