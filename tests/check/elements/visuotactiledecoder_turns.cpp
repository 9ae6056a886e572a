// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Whose film visuotactiledecoder makes felt where several play in one process.
#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"

#include "support/check_tests.h"

namespace {

/// A film's pipeline. Without a number of frames it goes on and on.
class Film
{
public:
  explicit Film(const std::string &source = "", const std::string &width = "64")
      : pipeline(make_pipeline("tactiletestsrc pattern=dynamic-motion " + source
                               + " ! video/x-raw,height=48,width=" + width
                               + " ! jpegenc ! "
                                 "visuotactiledecoder tactors::driver=simulator ! "
                                 "fakesink sync=true"))
  {
  }
  ~Film()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
  }
  Film(const Film &) = delete;
  Film &operator=(const Film &) = delete;

  void go(GstState state) const
  {
    change_state(pipeline, state);
  }

  /// Whether its motors play, as the film does.
  bool has_chair() const
  {
    g_autoptr(GstElement) tactors = gst_bin_get_by_name(GST_BIN(pipeline), "tactors");
    GstState state = GST_STATE_NULL;
    gst_element_get_state(tactors, &state, nullptr, GST_CLOCK_TIME_NONE);
    return state > GST_STATE_READY;
  }
  /// The next turn is given on a thread of GStreamer's.
  void wait_for_chair() const
  {
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
    while (!has_chair())
      if (GstMessage *message
          = gst_bus_timed_pop_filtered(bus, 10 * GST_MSECOND, GST_MESSAGE_STATE_CHANGED))
        gst_message_unref(message);
  }
  guint64 issued() const
  {
    g_autoptr(GstElement) tactors = gst_bin_get_by_name(GST_BIN(pipeline), "tactors");
    return actuation_stat_of(tactors, "issued");
  }

  GstElement *const pipeline;
};

} // namespace

CHECK_TEST(test_the_first_film_has_the_chair)
{
  const Film first;
  const Film second;
  const Film third;
  for (const Film *film : { &first, &second, &third })
    film->go(GST_STATE_PAUSED);
  fail_unless(first.has_chair() && !second.has_chair() && !third.has_chair());
  first.go(GST_STATE_READY); // leaves it
  second.wait_for_chair();
  fail_if(first.has_chair() || third.has_chair());
  first.go(GST_STATE_PAUSED); // waits behind the third
  second.go(GST_STATE_NULL);
  third.wait_for_chair();
  fail_if(first.has_chair());
}

/// Players may keep an old film, paused, beside the one that they show.
CHECK_TEST(test_a_paused_film_makes_room)
{
  const Film first;
  const Film paused;
  const Film second;
  first.go(GST_STATE_PLAYING);
  paused.go(GST_STATE_PAUSED);
  second.go(GST_STATE_PLAYING);
  fail_unless(first.has_chair());
  first.go(GST_STATE_PAUSED);
  second.wait_for_chair();
  fail_if(first.has_chair() || paused.has_chair());
  first.go(GST_STATE_PLAYING);
  second.go(GST_STATE_PAUSED);
  first.wait_for_chair();
  fail_if(second.has_chair() || paused.has_chair());
}

/// An advertisement beside it, which plays on, is not felt once the film goes on.
CHECK_TEST(test_the_largest_picture)
{
  const Film small;
  const Film large("", "96");
  small.go(GST_STATE_PLAYING);
  fail_unless(small.has_chair());
  large.go(GST_STATE_PLAYING);
  large.wait_for_chair();
  fail_if(small.has_chair());
  large.go(GST_STATE_PAUSED);
  small.wait_for_chair();
  large.go(GST_STATE_PLAYING);
  large.wait_for_chair();
  fail_if(small.has_chair());
}

CHECK_TEST(test_a_film_that_has_ended_makes_room)
{
  const Film first;
  const Film second;
  first.go(GST_STATE_PAUSED);
  seek_exactly(first.pipeline, 1, 0, GST_SECOND);
  first.go(GST_STATE_PLAYING);
  fail_unless(first.has_chair());
  wait_for_eos(first.pipeline);
  second.go(GST_STATE_PLAYING);
  second.wait_for_chair();
  fail_if(first.has_chair());
  // It is sought in, and plays again.
  seek_exactly(first.pipeline, 1, 0, GST_CLOCK_TIME_NONE);
  second.go(GST_STATE_PAUSED);
  first.wait_for_chair();
  fail_if(second.has_chair());
}

/// The film is felt from then on.
CHECK_TEST(test_a_turn_in_the_middle_of_a_film)
{
  const Film first;
  const Film second("num-buffers=150");
  first.go(GST_STATE_PLAYING);
  second.go(GST_STATE_PLAYING);
  fail_if(second.has_chair());
  first.go(GST_STATE_NULL);
  wait_for_eos(second.pipeline);
  fail_unless(second.issued() > 0);
}

CHECK_MAIN(visuotactiledecoder_turns)
