// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mutex>

namespace tactor {

/// Releases a lock for as long as it lives.
class Unlocked
{
public:
  explicit Unlocked(std::unique_lock<std::mutex> &lock) : lock_(lock)
  {
    lock_.unlock();
  }
  ~Unlocked()
  {
    lock_.lock();
  }
  Unlocked(const Unlocked &) = delete;
  Unlocked &operator=(const Unlocked &) = delete;

private:
  std::unique_lock<std::mutex> &lock_;
};

} // namespace tactor
