// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clips.h"

#include "decode.h"
#include "models.h"

#include <algorithm>
#include <array>
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

/// Measures one profile on one film.
class ProfileScore
{
public:
  ProfileScore(std::string name, const saliency::Profile &profile,
               const tactile::MappingSettings &mapping)
      : model_(std::move(name), profile, mapping)
  {
  }

  void judge_by(const std::vector<Label> &labels)
  {
    judge_.emplace(labels);
  }

  void frame(const saliency::FrameView &view, Time time, Time duration)
  {
    const saliency::Saliency &found = model_.frame(view, time, duration, map_);
    int felt = 0;
    for (std::size_t i = 0; i < tactors_.size(); ++i) {
      const bool on = map_.levels[i] > 0;
      tactors_[i].frame(on, time, duration);
      felt += on ? 1 : 0;
    }
    chair_.frame(felt > 0, time, duration);
    frames_ += 1;
    active_ += felt > 0 ? 1 : 0;
    felt_ += felt;
    camera_moves_ += found.camera_moves ? 1 : 0;
    cuts_ += found.cut ? 1 : 0;
    length_ += duration;
    if (judge_)
      judge_->frame(time, map_);
  }

  ClipRow row(std::string clip) const
  {
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
    return { std::move(clip), model_.name(), scores,
             judge_ ? std::optional(judge_->scores()) : std::nullopt };
  }

private:
  AnalyzerModel model_;
  tactile::TactileMap map_{ kSide, kSide };
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

} // namespace

std::vector<ClipRow>
score_clips(const std::filesystem::path &directory)
{
  std::vector<ClipRow> rows;
  for (const auto &file : list_films(directory)) {
    std::array profiles{
      ProfileScore("paper", saliency::Profile::paper(), tactile::MappingSettings::paper()),
      ProfileScore("tuned", saliency::Profile::tuned(), tactile::MappingSettings::tuned())
    };
    if (const std::vector<Label> labels = labels_of(file); !labels.empty())
      for (auto &profile : profiles)
        profile.judge_by(labels);
    Decoder clip(file, "decodebin", "I420");
    bool any = false;
    for (; clip.next(); any = true)
      for (auto &profile : profiles)
        profile.frame(clip.view(), clip.time(), clip.duration());
    if (!any)
      throw std::runtime_error(file.string() + ": no frames in it");
    for (const auto &profile : profiles)
      rows.push_back(profile.row(file.filename().string()));
  }
  return rows;
}

} // namespace quality
