// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/base/gstflowcombiner.h>
#include <gst/gst.h>

/// The pads of an element that passes a stream through, from `sink` to `src`, and sends its maps on
/// the pad `tactile`. One source pad may be unlinked or fail without the other. Streaming thread,
/// or while there is none.
class SplitPads
{
public:
  struct Functions
  {
    GstPadChainFunction chain;
    GstPadEventFunction event; ///< of the sink pad; ends with pass_event()
    /// The query function of the tactile pad; null: the default of pads.
    GstPadQueryFunction tactile_query = nullptr;
    /// Maps come with the stream: another grid is sent upstream to their source.
    bool maps_come = false;
  };

  /// Adds pads of the class's templates. Those live as long as the element, which owns this.
  SplitPads(GstElement *element, const Functions &functions);
  ~SplitPads();
  SplitPads(const SplitPads &) = delete;
  SplitPads &operator=(const SplitPads &) = delete;

  GstPad *sink() const;
  GstPad *tactile() const;

  /// The frame rate of the next caps of maps; 0/1: unknown or variable.
  void set_framerate(gint n, gint d);

  /// Sends caps with this grid, if they differ from the last ones, then the segment. The grid
  /// stays; before the first one it is the grid that downstream prefers, else 3 × 3.
  void announce(guint rows, guint columns);
  void announce();
  guint rows() const;
  guint columns() const;

  /// To the tactile pad, a map after announce(). For pass().
  GstFlowReturn push_map(GstBuffer *map);
  GstFlowReturn push_gap(GstClockTime pts, GstClockTime duration);
  /// The next map does not follow the last one. So it is after a flush, a segment and reset().
  void interrupt();
  /// The result of the tactile pad if nothing is pushed.
  GstFlowReturn maps_flow() const;

  /// To the source pad. Returns the flow of both pads.
  GstFlowReturn pass(GstBuffer *buffer, GstFlowReturn of_maps);

  /// To the source pad, and if it is not about pictures or sound only, to the tactile pad, too.
  gboolean pass_event(GstEvent *event);

  /// Forgets the stream.
  void reset();

  /// Whether downstream of the tactile pad prefers another grid than the announced one. Queries it
  /// if something has changed there.
  bool wants_grid(guint *rows, guint *columns);

private:
  void start_stream(GstEvent *event);
  gboolean tell_maps(GstEvent *event);

  GstPad *sink_;
  GstPad *src_;
  GstPad *tactile_;
  GstFlowCombiner *combiner_;
  gint fps_n_ = 0;
  gint fps_d_ = 1;
  guint rows_ = 0; ///< of the tactile pad's caps; 0: none sent yet
  guint columns_ = 0;
  bool fps_changed_ = false; ///< since these caps were sent
  bool interrupted_ = true;
  GstEvent *segment_ = nullptr; ///< for the tactile pad, which needs caps first
};
