// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clips.h"

#include "decode.h"
#include "models.h"
#include "parallel.h"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

namespace quality {

namespace {

constexpr int kSide = 3; ///< rows and columns of the chair

/// Counts intervals, and measures the longest.
class Stretches
{
public:
  void frame(bool on, Time time, Time duration)
  {
    if (!on) {
      begin_.reset();
      return;
    }
    if (!begin_) {
      begin_ = time;
      ++count_;
    }
    longest_ = std::max(longest_, time + duration - *begin_);
  }

  double longest() const
  {
    return std::chrono::duration<double>(longest_).count();
  }
  int count() const
  {
    return count_;
  }

private:
  std::optional<Time> begin_;
  Time longest_{ 0 };
  int count_ = 0;
};

/// Measures what is felt of one film.
class ClipJudge
{
public:
  explicit ClipJudge(const std::vector<Label> &labels)
  {
    if (!labels.empty())
      judge_.emplace(labels);
  }

  void frame(const tactile::TactileMap &map, Time time, Time duration, bool camera_moves, bool cut)
  {
    int felt = 0;
    for (std::size_t i = 0; i < tactors_.size(); ++i) {
      const bool on = map.levels[i] > 0;
      tactors_[i].frame(on, time, duration);
      felt += on ? 1 : 0;
    }
    chair_.frame(felt > 0, time, duration);
    frames_ += 1;
    active_ += felt > 0 ? 1 : 0;
    felt_ += felt;
    camera_moves_ += camera_moves ? 1 : 0;
    cuts_ += cut ? 1 : 0;
    length_ += duration;
    if (judge_)
      judge_->frame(time, map);
  }

  /// Throws std::runtime_error if there were no frames.
  ClipRow row(const std::filesystem::path &clip, std::string model) const
  {
    if (frames_ == 0)
      throw std::runtime_error(clip.string() + ": no frames in it");
    ClipScores scores;
    scores.frames = frames_;
    scores.active = active_ / frames_;
    scores.tactors = felt_ / frames_ / (kSide * kSide);
    scores.tactors_active = active_ > 0 ? felt_ / active_ : 0;
    scores.longest = chair_.longest();
    int cues = 0;
    for (const auto &tactor : tactors_) {
      scores.longest_tactor = std::max(scores.longest_tactor, tactor.longest());
      cues += tactor.count();
    }
    scores.cues_per_minute = cues / std::chrono::duration<double, std::ratio<60>>(length_).count();
    scores.camera_moves = camera_moves_ / frames_;
    scores.cuts = cuts_;
    return { clip.filename().string(), std::move(model), scores,
             judge_ ? std::optional(judge_->scores()) : std::nullopt };
  }

private:
  Stretches chair_;
  std::array<Stretches, static_cast<std::size_t>(kSide *kSide)> tactors_;
  int frames_ = 0;
  double active_ = 0;
  double felt_ = 0;
  double camera_moves_ = 0;
  int cuts_ = 0;
  Time length_{ 0 };
  std::optional<LabelJudge> judge_;
};

/// Those of a film in tests/quality/labels, by the film's name; none if nobody has labeled it.
std::vector<Label>
labels_of(const std::filesystem::path &film)
{
  const std::filesystem::path file
      = std::filesystem::path(LABELS) / (film.stem().string() + ".csv");
  return std::filesystem::exists(file) ? read_labels(file) : std::vector<Label>{};
}

/// The paper's profile and ours.
std::vector<ClipRow>
score_ours(const std::filesystem::path &file, const std::vector<Label> &labels)
{
  const std::array models{ paper_model(), tuned_model() };
  std::array judges{ ClipJudge(labels), ClipJudge(labels) };
  tactile::TactileMap map(kSide, kSide);
  Decoder clip(file, "decodebin", "I420");
  while (clip.next())
    for (std::size_t i = 0; i < models.size(); ++i) {
      const auto &found = models[i]->frame(clip.view(), clip.time(), clip.duration(), map);
      judges[i].frame(map, clip.time(), clip.duration(), found.camera_moves, found.cut);
    }
  return { judges[0].row(file, models[0]->name()), judges[1].row(file, models[1]->name()) };
}

std::vector<ClipRow>
score_peer(Peer peer, const std::filesystem::path &file, const std::vector<Label> &labels)
{
  PeerSaliency saliency(peer);
  ClipJudge judge(labels);
  tactile::TactileMap map(kSide, kSide);
  Decoder clip(file, "decodebin", "BGR");
  while (clip.next()) {
    map_peer(saliency.compute(as_mat(clip.view())), map);
    judge.frame(map, clip.time(), clip.duration(), false, false);
  }
  return { judge.row(file, name(peer)) };
}

} // namespace

std::vector<ClipRow>
score_clips(const std::filesystem::path &directory, int threads)
{
  std::vector<std::function<std::vector<ClipRow>()>> jobs;
  for (const auto &file : list_films(directory)) {
    const std::vector<Label> labels = labels_of(file);
    jobs.emplace_back([=] { return score_ours(file, labels); });
    for (const Peer peer : kPeers)
      if (!labels.empty() && is_available(peer))
        jobs.emplace_back([=] { return score_peer(peer, file, labels); });
  }
  std::vector<std::vector<ClipRow>> found(jobs.size());
  in_parallel(
      threads, jobs.size(), [&](std::size_t i) { found[i] = jobs[i](); }, "clips");
  std::vector<ClipRow> rows;
  for (auto &some : found)
    std::ranges::move(some, std::back_inserter(rows));
  return rows;
}

} // namespace quality
