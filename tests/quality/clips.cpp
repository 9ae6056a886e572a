// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clips.h"

#include "decode.h"
#include "models.h"
#include "parallel.h"
#include "table.h"
#include "tracks/formats/track_file.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
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
    return { .clip = clip.filename().string(),
             .model = std::move(model),
             .scores = scores,
             .labels = judge_ ? std::optional(judge_->scores()) : std::nullopt };
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

/// The file in this folder, or in its folder `unseen`, that has the film's name; empty if none has.
std::filesystem::path
file_of(const std::filesystem::path &folder, const std::filesystem::path &film)
{
  const std::string name = film.stem().string() + ".csv";
  for (const std::filesystem::path &file : { folder / name, folder / "unseen" / name })
    if (std::filesystem::exists(file))
      return file;
  return {};
}

/// None if nobody has labeled it.
std::vector<Label>
labels_of(const std::filesystem::path &folder, const std::filesystem::path &film)
{
  const std::filesystem::path file = file_of(folder, film);
  return file.empty() ? std::vector<Label>{} : read_labels(file);
}

/// What is felt of a frame.
struct FeltFrame
{
  tactile::TactileMap map;
  Time time;
  Time duration;
  double peak; ///< of the saliency map
};

/// Share of the frames that are felt.
double
share_of(const std::vector<FeltFrame> &frames)
{
  const auto felt = std::ranges::count_if(frames, [](const FeltFrame &frame) {
    return std::ranges::any_of(frame.map.levels, [](float level) { return level > 0; });
  });
  return frames.empty() ? 0 : static_cast<double>(felt) / static_cast<double>(frames.size());
}

/// The paper's profile as saliencytactile has it.
ClipRow
score_paper(const std::filesystem::path &file, const std::vector<Label> &labels)
{
  const auto model = paper_model();
  ClipJudge judge(labels);
  tactile::TactileMap map(kSide, kSide);
  Decoder clip(file, "decodebin", "I420");
  while (clip.next()) {
    const auto &found = model->frame(clip.view(), clip.time(), clip.duration(), map);
    judge.frame(map, clip.time(), clip.duration(), found.camera_moves, found.cut);
  }
  return judge.row(file, model->name());
}

/// Ours at each of kSensitivities; the frames of the first go to `felt`.
std::vector<ClipRow>
score_ours(const std::filesystem::path &file, const std::vector<Label> &labels,
           std::vector<FeltFrame> &felt)
{
  const auto model = tuned_model();
  AnalyzerModel without(kWithoutPeople, saliency::Profile::tuned(),
                        tactile::MappingSettings::tuned());
  ClipJudge judge_without(labels);
  std::vector<tactile::MappingSettings> mappings;
  for (const double sensitivity : kSensitivities) {
    mappings.push_back(tactile::MappingSettings::tuned());
    mappings.back().floor /= sensitivity;
    mappings.back().sensitivity = sensitivity;
  }
  std::vector<ClipJudge> judges(mappings.size(), ClipJudge(labels));
  tactile::TactileMap map(kSide, kSide);
  Decoder clip(file, "decodebin", "I420");
  while (clip.next()) {
    const auto view = model->look(clip.view(), clip.time(), clip.duration());
    const saliency::Saliency &found = model->found();
    for (std::size_t i = 0; i < mappings.size(); ++i) {
      tactile::map_saliency(view, mappings[i], map);
      judges[i].frame(map, clip.time(), clip.duration(), found.camera_moves, found.cut);
      if (i == 0)
        felt.push_back({ map, clip.time(), clip.duration(), found.peak });
    }
    without.frame(clip.view(), clip.time(), clip.duration(), map);
    judge_without.frame(map, clip.time(), clip.duration(), found.camera_moves, found.cut);
  }
  std::vector<ClipRow> rows;
  for (std::size_t i = 0; i < judges.size(); ++i)
    rows.push_back(judges[i].row(file, model_at(kSensitivities[i])));
  rows.push_back(judge_without.row(file, without.name()));
  return rows;
}

ClipRow
score_frames(const std::vector<FeltFrame> &frames, const std::filesystem::path &file,
             const std::vector<Label> &labels, const std::string &name)
{
  ClipJudge judge(labels);
  for (const FeltFrame &frame : frames)
    judge.frame(frame.map, frame.time, frame.duration, false, false);
  return judge.row(file, name);
}

ClipRow
score_center(std::vector<FeltFrame> frames, const std::filesystem::path &file,
             const std::vector<Label> &labels)
{
  for (FeltFrame &frame : frames) {
    const float level = std::ranges::max(frame.map.levels);
    std::ranges::fill(frame.map.levels, 0.0F);
    frame.map.levels[kSide * kSide / 2] = level;
  }
  return score_frames(frames, file, labels, "center, same frames");
}

/// Twice: as it is, and with the given share of its frames, the strongest.
std::vector<ClipRow>
score_peer(Peer peer, const std::filesystem::path &file, const std::vector<Label> &labels,
           double share)
{
  PeerSaliency saliency(peer);
  std::vector<FeltFrame> frames;
  tactile::TactileMap map(kSide, kSide);
  Decoder clip(file, "decodebin", "BGR");
  while (clip.next()) {
    const cv::Mat &found = saliency.compute(as_mat(clip.view()));
    map_peer(found, map);
    double peak = 0;
    cv::minMaxLoc(found, nullptr, &peak);
    frames.push_back({ map, clip.time(), clip.duration(), peak });
  }
  std::vector<ClipRow> rows{ score_frames(frames, file, labels, name(peer)) };
  std::vector<double> peaks;
  for (const FeltFrame &frame : frames)
    peaks.push_back(frame.peak);
  std::ranges::sort(peaks);
  const auto silent = static_cast<std::size_t>((1 - share) * static_cast<double>(peaks.size()));
  for (FeltFrame &frame : frames)
    if (silent > 0 && frame.peak <= peaks[silent - 1])
      std::ranges::fill(frame.map.levels, 0.0F);
  rows.push_back(score_frames(frames, file, labels, std::string(name(peer)) + ", same share"));
  return rows;
}

/// What a method's track has at the times of the film's frames.
std::optional<ClipRow>
score_method(const Method &method, const std::filesystem::path &film,
             const std::vector<Label> &labels, std::vector<FeltFrame> frames)
{
  const std::filesystem::path file = file_of(method.tracks, film);
  if (file.empty())
    return std::nullopt;
  const auto track = tactile::read_track_file(file.string());
  if (!track)
    throw std::runtime_error(track.error().text());
  if (track->rows() != kSide || track->columns() != kSide)
    throw std::runtime_error(file.string() + ": expected 3 x 3 cells, got "
                             + std::to_string(track->rows()) + " x "
                             + std::to_string(track->columns()));
  for (FeltFrame &frame : frames)
    frame.map = track->at(frame.time);
  return score_frames(frames, film, labels, method.name);
}

std::vector<ClipRow>
score_clip(const std::filesystem::path &file, const ClipSet &set, Contenders contenders)
{
  const std::vector<Label> labels = labels_of(set.labels, file);
  std::vector<FeltFrame> felt;
  std::vector<ClipRow> rows;
  if (contenders == Contenders::all)
    rows.push_back(score_paper(file, labels));
  std::ranges::move(score_ours(file, labels, felt), std::back_inserter(rows));
  if (!labels.empty() && contenders == Contenders::all) {
    rows.push_back(score_center(felt, file, labels));
    for (const Peer peer : kPeers)
      if (is_available(peer))
        std::ranges::move(score_peer(peer, file, labels, share_of(felt)), std::back_inserter(rows));
  }
  for (const Method &method : set.methods)
    if (auto row = score_method(method, file, labels, felt))
      rows.push_back(*std::move(row));
  for (ClipRow &row : rows)
    row.unseen = file_of(set.labels, file).parent_path().filename() == "unseen";
  return rows;
}

} // namespace

std::string
model_at(double sensitivity)
{
  return sensitivity == 1 ? "tuned" : "tuned, sensitivity " + figure(sensitivity, 1);
}

std::vector<ClipRow>
fitted_elsewhere(const std::vector<ClipRow> &rows)
{
  // What the other films say of a sensitivity: precision + recall - quiet time felt, over spans.
  const auto merit = [&](const std::string &model, const std::string &but) {
    Mean right;
    Mean found;
    Mean quiet;
    for (const ClipRow &row : rows) {
      if (row.model != model || row.clip == but || !row.labels)
        continue;
      for (std::size_t i = 0; i < row.labels->right.size(); ++i) {
        right.add(row.labels->right[i]);
        found.add(row.labels->found[i]);
        quiet.add(row.labels->quiet[i]);
      }
    }
    return right.value() + found.value() - quiet.value();
  };
  std::vector<ClipRow> fitted;
  for (const ClipRow &row : rows) {
    if (row.model != model_at(1) || !row.labels)
      continue;
    const double best = *std::ranges::max_element(kSensitivities, {}, [&](double sensitivity) {
      return merit(model_at(sensitivity), row.clip);
    });
    const auto chosen = std::ranges::find_if(rows, [&](const ClipRow &other) {
      return other.clip == row.clip && other.model == model_at(best);
    });
    fitted.push_back(*chosen);
    fitted.back().model = kFitted;
  }
  return fitted;
}

std::vector<ClipRow>
score_clips(const ClipSet &set, Contenders contenders, int threads)
{
  std::vector<std::filesystem::path> files = list_films(set.films);
  if (std::filesystem::exists(set.films / "unseen"))
    std::ranges::move(list_films(set.films / "unseen"), std::back_inserter(files));
  std::vector<std::vector<ClipRow>> found(files.size());
  in_parallel(
      threads, files.size(),
      [&](std::size_t i) { found[i] = score_clip(files[i], set, contenders); }, "clips");
  std::vector<ClipRow> rows;
  for (auto &some : found)
    std::ranges::move(some, std::back_inserter(rows));
  return rows;
}

} // namespace quality
