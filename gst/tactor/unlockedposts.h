// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/base/gstbasesink.h>

#include <atomic>

/// Messages of a sink that its streaming thread posts while it has the preroll lock, which is
/// released meanwhile: a handler may pause the pipeline. Afterwards the sink may be flushing.
class UnlockedPosts
{
public:
  /// While it lives, this thread has the preroll lock of the sink.
  class Scope
  {
  public:
    explicit Scope(UnlockedPosts &posts) : posts_(posts)
    {
      posts_.locker_ = g_thread_self();
    }
    ~Scope()
    {
      posts_.locker_ = nullptr;
    }
    Scope(const Scope &) = delete;
    Scope &operator=(const Scope &) = delete;

  private:
    UnlockedPosts &posts_;
  };

  /// Returns the result of `post`. Any thread.
  template <class Post> gboolean post(GstBaseSink *sink, Post post)
  {
    if (locker_ != g_thread_self())
      return post();
    locker_ = nullptr; // a handler may post, too
    GST_BASE_SINK_PREROLL_UNLOCK(sink);
    const gboolean posted = post();
    GST_BASE_SINK_PREROLL_LOCK(sink);
    locker_ = g_thread_self();
    return posted;
  }

private:
  std::atomic<GThread *> locker_{ nullptr }; ///< another thread only sees that it is not that one
};
