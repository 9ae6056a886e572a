// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mutex>
#include <vector>

namespace saliency {

/// The rows of an image, shared out among threads: each has a band of its own; who is done before
/// the others, as they woke up later or are slower, takes the lower half of what the one with most
/// has left.
class RowShares
{
public:
  struct Rows
  {
    int begin;
    int end; ///< not among them; begin: there are none left
  };

  /// Not while rows are taken.
  void reset(int rows, int threads);

  /// A thread's next rows, from top to bottom but where it takes another's.
  Rows take(int thread);

private:
  std::mutex mutex_;
  std::vector<Rows> left_; ///< of each thread
};

} // namespace saliency
