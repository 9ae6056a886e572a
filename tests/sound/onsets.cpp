// SPDX-License-Identifier: LGPL-2.1-or-later
#include "onsets.h"

#include <aubio/aubio.h>

#include <algorithm>
#include <cmath>

namespace judged {

std::vector<float>
rendered(const sound::SyntheticSound &made, double seconds, int rate,
         std::span<const sound::Speaker> speakers)
{
  std::vector<float> frames(static_cast<std::size_t>(seconds * rate) * speakers.size());
  made.render(rate, 0, speakers, frames);
  return frames;
}

std::vector<sound::Moment>
analyzed(std::span<const float> frames, int rate, std::span<const sound::Speaker> speakers,
         const sound::FeelSettings &settings, bool looks_ahead)
{
  sound::SoundAnalyzer analyzer(rate, speakers, looks_ahead);
  const std::span<const sound::Moment> moments = analyzer.add(frames, settings);
  return { moments.begin(), moments.end() };
}

std::vector<double>
onsets_of(std::span<const sound::Moment> moments)
{
  std::vector<double> result;
  for (const sound::Moment &moment : moments)
    if (moment.onset)
      result.push_back(std::chrono::duration<double>(moment.begin).count());
  return result;
}

std::vector<double>
impacts_of(const sound::SyntheticSound &made)
{
  std::vector<double> result;
  for (const sound::SoundEvent &event : made.events())
    if (event.kind == sound::SoundKind::impact || event.kind == sound::SoundKind::explosion)
      result.push_back(std::chrono::duration<double>(event.begin).count());
  return result;
}

void
Count::add(std::span<const double> onsets, std::span<const double> truth, double tolerance)
{
  std::vector<bool> used(onsets.size());
  for (const double at : truth)
    for (std::size_t i = 0; i < onsets.size(); i++)
      if (!used[i] && std::abs(onsets[i] - at) <= tolerance) {
        used[i] = true;
        right++;
        break;
      }
  found += static_cast<int>(onsets.size());
  truths += static_cast<int>(truth.size());
}

double
Count::precision() const
{
  return found > 0 ? static_cast<double>(right) / found : 0;
}

double
Count::recall() const
{
  return truths > 0 ? static_cast<double>(right) / truths : 0;
}

double
Count::f1() const
{
  return found + truths > 0 ? 2.0 * right / (found + truths) : 0;
}

std::vector<Peer>
peers()
{
  std::vector<Peer> result;
  for (const char *method :
       { "energy", "hfc", "complex", "phase", "specdiff", "kl", "mkl", "specflux" })
    for (const double threshold : { 0.1, 0.3, 0.6, 1.0, 2.0, 4.0 })
      result.push_back({ method, threshold });
  return result;
}

std::vector<double>
heard_by(const Peer &peer, std::span<const float> mono, int rate, int window)
{
  const auto size = static_cast<uint_t>(window);
  const uint_t hop = size / 2;
  aubio_onset_t *onset = new_aubio_onset(peer.method.c_str(), size, hop, static_cast<uint_t>(rate));
  aubio_onset_set_threshold(onset, static_cast<smpl_t>(peer.threshold));
  aubio_onset_set_minioi_s(onset, 0.08F); // as ours
  fvec_t *in = new_fvec(hop);
  fvec_t *out = new_fvec(1);
  std::vector<double> result;
  for (std::size_t at = 0; at + hop <= mono.size(); at += hop) {
    std::copy_n(mono.begin() + static_cast<std::ptrdiff_t>(at), hop, in->data);
    aubio_onset_do(onset, in, out);
    if (out->data[0] != 0)
      result.push_back(static_cast<double>(aubio_onset_get_last_s(onset)));
  }
  del_fvec(out);
  del_fvec(in);
  del_aubio_onset(onset);
  return result;
}

} // namespace judged
