// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Pipelines that block because a queue is missing, and pipelines that wait for something else, on a
// GstTestClock instead of the system's.
#include <condition_variable>
#include <mutex>
#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/contains.h"
#include "support/playing.h"

#include <gst/check/gsttestclock.h>

#include "support/check_tests.h"

namespace {

#define FILM "tactiletestsrc num-buffers=50 ! video/x-raw,width=64,height=48 ! "
#define CHAIR "tactorsink name=chair driver=simulator "

/// A pipeline on its way to PAUSED, on a test clock.
class Paused
{
public:
  explicit Paused(const char *line)
  {
    clock_ = gst_test_clock_new();
    gst_system_clock_set_default(clock_);
    pipeline_ = gst_parse_launch(line, nullptr);
    fail_unless(pipeline_ != nullptr, "%s", line);
    gst_object_ref_sink(pipeline_);
    if (GstElement *source = gst_bin_get_by_name(GST_BIN(pipeline_), "source")) {
      g_signal_connect(source, "need-data", G_CALLBACK(+[](GstElement *, guint, Paused *self) {
                         const std::lock_guard lock(self->mutex_);
                         self->source_waits_ = true;
                         self->changed_.notify_all();
                       }),
                       this);
      gst_object_unref(source);
    }
    gst_element_set_state(pipeline_, GST_STATE_PAUSED);
  }
  ~Paused()
  {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(pipeline_);
    gst_system_clock_set_default(nullptr);
    gst_object_unref(clock_);
  }
  Paused(const Paused &) = delete;
  Paused &operator=(const Paused &) = delete;

  /// Waits until this sink, or the whole pipeline, has prerolled.
  void wait_for(const char *name = nullptr)
  {
    GstElement *element = name ? gst_bin_get_by_name(GST_BIN(pipeline_), name)
                               : GST_ELEMENT(gst_object_ref(pipeline_));
    fail_unless_equals_int(gst_element_get_state(element, nullptr, nullptr, 60 * GST_SECOND),
                           GST_STATE_CHANGE_SUCCESS);
    gst_object_unref(element);
  }

  /// Waits until the empty source asks for data, so that its thread is not on the way to any sink.
  void wait_for_source()
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return source_waits_; });
  }

  /// Lets this many seconds pass and returns the warnings.
  std::string seconds(int count)
  {
    for (int i = 0; i < count; i++) {
      gst_test_clock_advance_time(GST_TEST_CLOCK(clock_), GST_SECOND);
      while (GstClockID waited = gst_test_clock_process_next_clock_id(GST_TEST_CLOCK(clock_)))
        gst_clock_id_unref(waited);
    }
    std::string text;
    GstBus *bus = gst_element_get_bus(pipeline_);
    while (GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING)) {
      g_autoptr(GError) error = nullptr;
      g_autofree gchar *debug = nullptr;
      gst_message_parse_warning(message, &error, &debug);
      text += std::string(error->message) + " " + debug + "\n";
      gst_message_unref(message);
    }
    gst_object_unref(bus);
    return text;
  }

private:
  GstClock *clock_;
  GstElement *pipeline_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool source_waits_ = false;
};

void
assert_told(Paused &film, const char *where)
{
  assert_text(film.seconds(2), "");
  assert_contains(film.seconds(1),
                  { "waits forever", "queue is missing", where, "two seconds", "! queue !" });
  assert_text(film.seconds(5), ""); // only once
}

} // namespace

/// The chair has its map, the picture waits.
CHECK_TEST(test_extractor)
{
  Paused film(FILM "tactileextractor name=split split.src ! fakesink split.tactile ! " CHAIR);
  film.wait_for("chair");
  assert_told(film, "'split'");
}

/// The picture has its frame, the chair waits. One branch is in a bin.
CHECK_TEST(test_tee)
{
  Paused film(FILM "tee name=split split. ! bin.( name=picture fakesink name=screen ) "
                   "split. ! identity ! " CHAIR);
  film.wait_for("screen");
  assert_told(film, "'split'");
}

/// The queue is before the fork, so the branches share its thread.
CHECK_TEST(test_queue_before_the_fork)
{
  Paused film(FILM "queue ! tee name=split split. ! fakesink name=screen split. ! " CHAIR);
  film.wait_for("screen");
  assert_told(film, "'split'");
}

/// One of two queues is missing, and the other one does not help.
CHECK_TEST(test_one_queue)
{
  Paused film(FILM
              "tactileextractor name=split split.src ! queue ! fakesink split.tactile ! " CHAIR);
  film.wait_for("chair");
  assert_told(film, "'split'");
}

/// All sinks have prerolled: the user pauses, for any time.
CHECK_TEST(test_pause)
{
  for (const char *line : {
           FILM "tactileextractor name=split split.src ! queue ! fakesink split.tactile ! queue "
                "! " CHAIR,
           FILM "tee name=split split. ! queue ! fakesink split. ! " CHAIR,
           FILM CHAIR,
       }) {
    Paused film(line);
    film.wait_for();
    assert_text(film.seconds(5), "");
  }
}

/// Slow sources, before the fork or elsewhere.
CHECK_TEST(test_slow_source)
{
  Paused film("appsrc name=source ! tee name=split split. ! fakesink split. ! " CHAIR);
  film.wait_for_source();
  assert_text(film.seconds(5), "");
  Paused sound(FILM "tee name=split split. ! queue ! fakesink name=screen split. ! " CHAIR
                    "appsrc ! fakesink");
  sound.wait_for("screen");
  sound.wait_for("chair");
  assert_text(sound.seconds(5), "");
}

/// A sink is freed by its owner's unref, though the clock's thread has yet to free the watch.
CHECK_TEST(test_watch_holds_no_sink)
{
  GstClock *clock = gst_test_clock_new();
  gst_system_clock_set_default(clock);
  GstElement *chair = gst_element_factory_make("tactorsink", nullptr);
  gst_object_ref_sink(chair);
  gst_util_set_object_arg(G_OBJECT(chair), "driver", "simulator");
  gst_element_set_state(chair, GST_STATE_PAUSED);
  GstClockID look = nullptr;
  fail_unless(gst_test_clock_peek_next_pending_id(GST_TEST_CLOCK(clock), &look));
  gst_element_set_state(chair, GST_STATE_NULL);
  gpointer alive = chair;
  g_object_add_weak_pointer(G_OBJECT(chair), &alive);
  gst_object_unref(chair);
  fail_unless(alive == nullptr);
  gst_clock_id_unref(look);
  gst_system_clock_set_default(nullptr);
  gst_object_unref(clock);
}

CHECK_MAIN(queuewatch)
