// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/layout.h"

#include <gst/gst.h>

/// The grid that tactorsink prefers: that of its device, if its tactors have places. It takes any
/// other. Any thread.
class TactorGrid
{
public:
  /// The pad's element is not owned.
  explicit TactorGrid(GstPad *pad);

  /// Sets the layout of the device that was opened, and notifies upstream if it is another than the
  /// last one, which holds until then, as the next device is likely the same.
  void set(const tactor::Layout &layout);

  /// The caps that the pad accepts, the preferred ones first.
  GstCaps *caps(GstCaps *filter) const;
  /// Answers a query for the grid; false if it is another query, or there is no preference.
  bool answer(GstQuery *query) const;

private:
  tactor::Layout layout() const;

  GstPad *pad_;
  tactor::Layout layout_; ///< guarded by the pad's object lock
};
