// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/equalizer.h"
#include "synth/wave.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace synth {

/// The carrier of a channel, its phase and gain.
struct Voice
{
  std::shared_ptr<const Wave> wave;
  double phase = 0;     ///< rounds by which its wave is ahead
  float gain = 1;       ///< factor on amplitudes; with 1 and more they are limited to full scale
  double frequency = 0; ///< Hz of a sine; 0: a carrier that tune() leaves as it is
  std::vector<EqualizerBand> equalizer{}; ///< of a sine, in `gain` at `frequency`
};

/// Carriers whose amplitudes change by ramps. A carrier goes on where it is silent, so that its
/// phase is that of the time since the first sample.
///
/// The ramp is the integral of a Hann window: more than 2 / its length from the carrier, its
/// sidebands are low and fall by 24 dB an octave, those of a straight ramp by 12. Changes add up:
/// one may come while others are under way. No sample exceeds full scale: amplitudes are limited,
/// so that their waves keep their shape.
///
/// Samples do not depend on how they are divided into calls of render(), which allocates nothing.
/// Not thread-safe.
class Synthesizer
{
public:
  /// Changes of one channel that may be under way. More wait.
  static constexpr std::size_t kMostRamps = 16;

  /// `ramp`: samples of a change, at least 1.
  Synthesizer(int rate, std::vector<Voice> voices, int ramp);

  int ramp() const;

  /// The channel's amplitude, clamped to [0, 1], changes from the next sample on. It is half way
  /// after half a ramp.
  void change(std::size_t channel, float amplitude);

  /// The channel's sine goes on at this frequency, in Hz, with the equalizer's gain there; 0: at
  /// its own. Other carriers stay as they are: their harmonics would go beyond kHighest, and a
  /// loop has no frequency.
  void tune(std::size_t channel, double frequency);

  /// The next vibration begins softly: its amplitude is limited by a line from zero to full scale
  /// in so many samples.
  void arm(std::int64_t soft_start);

  /// All channels are at zero.
  bool is_silent() const;

  /// The next samples, interleaved.
  void render(std::span<float> samples);

  /// As render() of so many samples of each channel, while it is silent.
  void skip(std::int64_t count);

private:
  struct Ramp
  {
    int done; ///< samples
    float by;
  };

  struct Channel
  {
    Voice voice;
    std::uint64_t phase;   ///< 2^64 is a round
    std::uint64_t advance; ///< of a sample
    double own_advance;    ///< in rounds
    double tuned = 0;      ///< Hz; 0: own
    float level = 0;       ///< of change(), [0, 1]
    float gain;            ///< at the frequency
    float settled = 0;     ///< amplitude without the ramps
    float target = 0;      ///< amplitude after all ramps
    float wanted = 0;      ///< as target, with those that wait
    std::size_t under_way = 0;
    std::array<Ramp, kMostRamps> ramps{}; ///< the first under_way, oldest first
  };

  static void set_amplitude(Channel &channel);
  static void begin_ramp(Channel &channel);
  void render_channel(Channel &channel, std::size_t index, std::span<float> samples);
  std::span<const float> amplitudes(Channel &channel, std::size_t most);
  void soften(std::span<float> samples);

  std::vector<Channel> channels_;
  std::vector<float> ramp_;      ///< share of a change after each sample
  std::vector<float> amplitude_; ///< of one block
  std::int64_t soft_start_ = 0;  ///< samples
  std::int64_t softened_ = 0;    ///< samples since its begin; up to soft_start_
  bool armed_ = false;
};

} // namespace synth
