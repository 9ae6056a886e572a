// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A random sequence of everything that an application, a user, a network and a cable can do to a
// film with a chair. Invariants after each step: nothing hangs, GLib has not warned, motors match
// the film or are at zero, and no command from before a flush reaches a motor. The first violation
// ends the run and prints the seed, the steps and the stacks.
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

/// One run. Methods are for the thread that created it, unless they say otherwise.
class Chaos
{
public:
  /// Draws only the steps in `only`, and those that resume a film; all steps if it is empty. Throws
  /// std::invalid_argument.
  Chaos(Stage::Kind kind, const std::string &film, std::uint64_t seed,
        const std::vector<std::string> &only, Watchdog &watchdog);
  ~Chaos();
  void run(int count);
  static bool is_step(const std::string &name);
  /// Prints the elements that are not in their pipeline's state. From any thread. Takes no lock,
  /// because what hangs may hold it.
  void print_states();
  /// What check() waits for. From any thread.
  std::string waiting_for();

private:
  // ---- random numbers

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
  /// Handles the messages on the bus. Errors that no step caused are faults.
  void hear();
  /// Waits until a player has prerolled: a playbin that is stopped or fails before never plays
  /// again, or aborts (GStreamer 1.22).
  void let_begin();
  void set_state(GstState state);
  /// Polls until the condition holds. The watchdog ends the run if it takes too long. False if the
  /// stage broke, so that it need not hold.
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
  /// Steps frame by frame while paused, as players do.
  void skip_frames();
  void change_caps();
  void change_property();
  void change_clock();
  void change_latency();
  void query();
  /// A live GstBaseSrc (1.22) handles EOS only when it is not blocked downstream, which it may be
  /// while paused.
  bool can_end() const;
  void send_eos();
  void post_error();
  void dispose();

  // What happens to boards

  /// Takes effect when the board is next opened.
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

  /// Calls `act` for the next buffer on its way to tactorsink.
  void once(GstPadProbeReturn (*act)(GstPad *, GstPadProbeInfo *, int), int value = 0);
  void forget_probe();
  void flow_error();
  void gap();
  /// Stops the data flow for a while.
  void starve();
  /// Removes the tactile branch from a playing pipeline. The picture goes on.
  void cut_branch();
  void mend_branch();
  /// Puts the branch back before the pipeline leaves PLAYING.
  void restore_branch();
  void join_branch(bool sync);
  /// The sender hangs, restarts, or sends garbage.
  void disturb_network();

  // Two threads

  /// Two things that an application may do from two threads at a time.
  void two_at_once();
  // For the second thread. They change no member and draw no random number.
  void query_often();
  void pull_and_plug();
  void latency_often();
  void mute_often();
  void eos_inside();
  void seek_inside();

  // ---- after each step

  /// The chair's running time. False without a clock.
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
  std::atomic<bool> has_prerolled_{ false }; ///< since READY; before that, seeks are refused
  GstPad *extractor_ = nullptr;              ///< source pad of the removed branch
  GstState state_ = GST_STATE_NULL;
  bool is_settled_ = false; ///< state reached, no flush since
  bool is_muted_ = false;
  bool is_broken_ = false; ///< after an error, until READY
  bool has_ended_ = false;
  std::atomic<bool> is_excused_{ false }; ///< a step may have caused an error
  bool is_cut_ = false;
  std::mutex mutex_;
  std::string waiting_for_;
};
