// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Everything that an application, a user, a network and a cable can do to a film with a chair, in
// an order drawn by lot. After each step: nothing waits for ever, GLib warned of nothing, the
// motors are where the film is or at zero, and none was told what was asked for before a flush. The
// first thing that is wrong ends the run with the seed, the steps and the stacks.
#pragma once

#include "stage.h"
#include "watchdog.h"
#include "witness.h"

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

/// One run. What is not said to be for any thread is for the one that made it.
class Chaos
{
public:
  /// Takes only these steps, and what gets a film going again; all if there are none. Throws
  /// std::invalid_argument.
  Chaos(Stage::Kind kind, const std::string &film, std::uint64_t seed,
        const std::vector<std::string> &only, Watchdog &watchdog);
  ~Chaos();
  void run(int count);
  static bool is_step(const std::string &name);
  /// The elements that are not in their pipeline's state, from any thread and without a lock:
  /// whatever hangs may have it.
  void print_states();
  /// What check() waits for, from any thread.
  std::string waiting_for();

private:
  // ---- dice

  int dice(int sides)
  {
    return std::uniform_int_distribution<int>(0, sides - 1)(random_);
  }
  double fraction()
  {
    return std::uniform_real_distribution<double>(0, 1)(random_);
  }
  template <typename Value, std::size_t size> Value pick(const std::array<Value, size> &values)
  {
    return values[static_cast<std::size_t>(dice(size))];
  }

  // ---- the stage

  void make_stage();
  void leave_stage();
  /// Takes what is on the bus. Errors that nobody made are faults.
  void hear();
  /// playbin (1.22) that is stopped or fails while it begins plays no more, or aborts: it is let
  /// begin first.
  void let_begin();
  void set_state(GstState state);
  /// Waits, in small pieces, until it holds; the watchdog ends what takes too long. False if it
  /// need not hold any more.
  template <typename Condition> bool await(Condition condition)
  {
    for (;;) {
      hear();
      if (is_broken_)
        return false;
      if (condition())
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  // ---- steps

  struct Step
  {
    const char *name;
    int weight;
    void (Chaos::*act)();
    bool only_seekable = false;
  };
  static const std::vector<Step> &all_steps();
  const Step &draw();
  void step();
  void note(const std::string &what);
  void recover();

  // What an application does

  void play();
  void pause();
  void ready();
  void null();
  void seek();
  /// Frame after frame, as players do it: in a pause.
  void skip_frames();
  void change_caps();
  void change_property();
  void change_clock();
  void change_latency();
  void query();
  /// GstBaseSrc (1.22) takes the end of a live stream only when it does not wait for downstream,
  /// which in a pause it may.
  bool can_end() const;
  void send_eos();
  void post_error();
  void dispose();

  // What becomes of boards

  /// Which takes effect when the board is opened next.
  void change_device();
  void plug(MemoryBoard &board);
  void plug();
  void unplug();
  void refuse();
  void stall_board();
  void repair_boards();
  void repair_boards_without_stage();
  bool boards_are_well();

  // What happens inside the stream and on the network

  /// Does something to one buffer on its way to tactorsink, the next that comes.
  void once(GstPadProbeReturn (*act)(GstPad *, GstPadProbeInfo *, int), int value = 0);
  void forget_probe();
  void flow_error();
  void gap();
  /// Nothing comes for a while.
  void starve();
  /// The tactile branch is taken out of a pipeline that plays; the picture goes on.
  void cut_branch();
  void mend_branch();
  /// Before the pipeline goes to rest, so that it is whole when it plays again.
  void restore_branch();
  void join_branch(bool sync);
  /// The other computer hangs, begins anew, or sends what is none of ours.
  void disturb_network();

  // Two threads

  /// What two threads of an application may do at the same time.
  void two_at_once();
  // Of the other thread: nothing of this object is changed there, and no dice are thrown.
  void query_often();
  void pull_and_plug();
  void latency_often();
  void mute_often();
  void eos_inside();
  void seek_inside();

  // ---- after each step

  /// Running time of the chair; nothing if it has no clock now.
  bool running_time(gint64 &running);
  void check();

  const Stage::Kind kind_;
  const std::string film_;
  std::vector<const Step *> drawn_;
  std::mt19937_64 random_;
  Watchdog &watchdog_;
  std::unique_ptr<Stage> stage_;
  GstBus *bus_ = nullptr;
  struct Once
  {
    GstPad *pad = nullptr; ///< with the probe
    gulong id = 0;
    GstPadProbeReturn (*act)(GstPad *, GstPadProbeInfo *, int) = nullptr;
    int value = 0;
    std::atomic<bool> is_done{ false };
  } once_;
  std::atomic<bool> has_prerolled_{ false }; ///< since READY: what is not linked yet takes no seek
  GstPad *extractor_ = nullptr;              ///< what the branch that is cut came from
  GstState state_ = GST_STATE_NULL;
  bool is_settled_ = false; ///< and since the last flush
  bool is_muted_ = false;
  bool is_broken_ = false; ///< an error came: only READY helps
  bool has_ended_ = false;
  std::atomic<bool> is_excused_{ false }; ///< something was done that may end in an error
  bool is_cut_ = false;
  std::mutex mutex_;
  std::string waiting_for_;
};
