// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <compare>
#include <deque>
#include <mutex>

/// Assigns the chair to one of all films in this process. The holder keeps the chair until a film
/// plays that has the stronger claim. A free chair goes to the strongest claim of those that wait,
/// and of equal ones to the first that began. Any thread.
class ChairTurns
{
public:
  struct Claim
  {
    enum class State
    {
      kEnded,
      kPaused,
      kPlays
    };

    State state;
    gint64 pixels; ///< of the picture; decides between films of the same state

    std::strong_ordering operator<=>(const Claim &) const = default;
  };

  /// A film's element, and its callbacks on a thread of GStreamer's.
  struct Film
  {
    GstElement *element;
    GstElementCallAsyncFunc offered; ///< the chair is free: take() it
    GstElementCallAsyncFunc asked;   ///< make room if outranked()
  };

  static ChairTurns &of_process();

  /// Whether the film has the chair now. If not, it waits.
  bool take(const Film &film, Claim claim);
  /// Changes the claim of a film that has the chair or waits.
  void claim(GstElement *element, Claim claim);
  /// Whether this film has the chair, and another one should.
  bool outranked(GstElement *element);
  /// The film plays no more: it neither has the chair nor waits.
  void leave(GstElement *element);

private:
  struct Claimant : Film
  {
    Claim claim;
  };

  std::deque<Claimant>::iterator next();
  bool wanted();
  void settle();

  std::mutex mutex_{};
  Claimant holder_{}; ///< without an element: none
  std::deque<Claimant> waiting_{};
};
