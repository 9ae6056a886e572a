// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <deque>
#include <mutex>

/// Whose film is felt, of all in this process: one has the chair, others wait for it in the order
/// in which they began. Any thread.
class ChairTurns
{
public:
  /// A film's element, and what is called for it on a thread of GStreamer's.
  struct Film
  {
    GstElement *element;
    GstElementCallAsyncFunc offered; ///< the chair is free: take() it
    GstElementCallAsyncFunc asked;   ///< somebody waits: leave() it if the film has ended
  };

  static ChairTurns &of_process();

  /// Whether the film has the chair now. If not, it waits, and who has it is asked.
  bool take(const Film &film);
  /// The film plays no more: it neither has the chair nor waits.
  void leave(GstElement *element);
  /// The film has ended. It is asked if somebody waits.
  void end(GstElement *element);

private:
  void offer();

  std::mutex mutex_{};
  Film holder_{}; ///< without an element: nobody
  std::deque<Film> waiting_{};
};
