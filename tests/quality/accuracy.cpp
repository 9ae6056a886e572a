// SPDX-License-Identifier: LGPL-2.1-or-later
#include "accuracy.h"

#include "decode.h"
#include "films.h"
#include "fixations.h"
#include "frame/front_end.h"
#include "parallel.h"
#include "pictures.h"
#include "saliency/analyzer.h"
#include "saliency/spatial_saliency.h"
#include "support/saliency_oracle.h"
#include "tactile/tactile_map.h"
#include "tactile/tactile_mapping.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>

namespace quality {

namespace {

constexpr Time kFrame{ 1'000'000'000 / 30 };
constexpr double kNearlyFlat
    = 1; ///< ΔE: the oracle's spatial maps with a lower maximum are not compared
constexpr double kAsGood = 0.95;

/// Agreement of a front end's maps with the oracle's.
struct Agreement
{
  std::string frames_of; ///< which pictures or film
  std::string map;       ///< spatial, spatiotemporal or tuned spatial
  std::string front_end; ///< of kFrontEnds
  int frames = 0;
  /// Frames whose oracle map exceeds 1 ΔE or the mapping's floor. Nearly flat maps correlate like
  /// noise.
  int compared = 0;
  double delta_e = 0;    ///< between the L*a*b* images: mean over samples and frames
  double least = 0;      ///< Pearson's correlation of the maps: minimum over the frames compared
  double percentile = 0; ///< its 1 % quantile
  double share_999 = 0;  ///< share of frames with at least 0.999
  /// Share of frames with the same strongest cell of 3 × 3, or with silence in both.
  double same_cell = 0;
  /// The same, or with an oracle level in our strongest cell of at least 95 % of its maximum.
  double as_good = 0;
};

struct FrontEndKind
{
  const char *name;
  bool exact;

  int converted(cv::Size frame, int level) const
  {
    return exact ? 0 : saliency::decimation_level(frame, level);
  }
};
constexpr std::array kFrontEnds{ FrontEndKind{ "default", false }, FrontEndKind{ "exact", true } };

double
mean_delta_e(const saliency::LabImage &lab, const oracle::LabImage &truth)
{
  double sum = 0;
  for (int y = 0; y < truth[0].height; ++y)
    for (int x = 0; x < truth[0].width; ++x) {
      double squared = 0;
      for (std::size_t c = 0; c < 3; ++c)
        squared += std::pow(static_cast<double>(lab.planes[c].at<float>(y, x)) - truth[c](x, y), 2);
      sum += std::sqrt(squared);
    }
  return sum / static_cast<double>(truth[0].values.size());
}

/// The oracle's L*a*b* image of a frame, at a level.
oracle::LabImage
oracle_lab(const saliency::FrameView &frame, int level, int threads)
{
  return oracle::pyramid_of(oracle::lab_image(frame, threads), 0, level).back();
}

saliency::Profile
profile_of(saliency::Profile profile, const FrontEndKind &kind)
{
  profile.exact = kind.exact;
  return profile;
}

/// A map, the position of the picture in it, and its mapping.
struct FeltMap
{
  cv::Mat map; ///< CV_32FC1
  cv::Rect2d picture;
  tactile::MappingSettings mapping;

  tactile::TactileMap levels() const
  {
    tactile::TactileMap cells(3, 3);
    tactile::map_saliency({ .values = map.ptr<float>(),
                            .width = map.cols,
                            .height = map.rows,
                            .stride = static_cast<std::ptrdiff_t>(map.step1()),
                            .horizontal = { picture.x, picture.width },
                            .vertical = { picture.y, picture.height } },
                          mapping, cells);
    return cells;
  }
};

/// Statistics of one kind of map over frames.
class Tally
{
public:
  /// Correlates frames whose oracle map exceeds `floor`.
  void add(const FeltMap &ours, const FeltMap &truth, double floor, double delta_e)
  {
    double peak = 0;
    cv::minMaxLoc(truth.map, nullptr, &peak);
    if (peak > floor)
      correlations_.push_back(correlation(ours.map, truth.map));
    const auto our_cells = ours.levels();
    const auto true_cells = truth.levels();
    const auto our_best = std::ranges::max_element(our_cells.levels);
    const auto true_best = std::ranges::max_element(true_cells.levels);
    const bool silence = *our_best == 0 && *true_best == 0;
    const auto place = our_best - our_cells.levels.begin();
    const bool same
        = silence
          || (*our_best > 0 && *true_best > 0 && place == true_best - true_cells.levels.begin());
    ++frames_;
    same_ += same ? 1 : 0;
    as_good_ += same
                        || (*our_best > 0 && *true_best > 0
                            && true_cells.levels[static_cast<std::size_t>(place)]
                                   >= kAsGood * *true_best)
                    ? 1
                    : 0;
    delta_e_ += delta_e;
  }

  Agreement row(std::string frames_of, std::string map, std::string front_end) const
  {
    if (frames_ == 0)
      throw std::runtime_error(frames_of + ": no frames to compare");
    auto sorted = correlations_;
    std::ranges::sort(sorted);
    Agreement row{ std::move(frames_of), std::move(map), std::move(front_end) };
    row.frames = frames_;
    row.compared = static_cast<int>(sorted.size());
    row.delta_e = delta_e_ / frames_;
    row.least = sorted.empty() ? std::nan("") : sorted.front();
    row.percentile = sorted.empty() ? std::nan("") : sorted[sorted.size() / 100];
    row.share_999
        = static_cast<double>(std::ranges::count_if(sorted, [](double r) { return r >= 0.999; }))
          / row.compared;
    row.same_cell = static_cast<double>(same_) / frames_;
    row.as_good = static_cast<double>(as_good_) / frames_;
    return row;
  }

private:
  int frames_ = 0;
  int same_ = 0;
  int as_good_ = 0;
  double delta_e_ = 0;
  std::vector<double> correlations_;
};

/// For spatial maps, which have no mapping of their own: means of cells.
constexpr tactile::MappingSettings kSpatialMapping{ .threshold = 0, .gain = tactile::Gain::none };

/// Compares spatial and spatiotemporal maps of a contrast profile, of all front ends.
class FilmComparison
{
public:
  FilmComparison(cv::Size size, int threads)
      : threads_(threads), profile_(saliency::Profile::tuned()),
        levels_(saliency::frame_levels(profile_, size)), reference_(profile_)
  {
    for (const auto &kind : kFrontEnds)
      ways_.push_back(
          std::make_unique<Way>(profile_of(profile_, kind), kind.converted(size, levels_.finest)));
  }

  void frame(const saliency::FrameView &frame, Time time, Time duration)
  {
    const oracle::LabImage lab = oracle_lab(frame, levels_.finest, threads_);
    const auto &truth = reference_.analyze(oracle::to_planes(lab), levels_.frame, time, duration);
    const oracle::Image map = oracle::spatial_saliency(
        oracle::pyramid_of(lab, levels_.finest, levels_.coarsest), { levels_.lightness },
        { levels_.chroma }, levels_.saliency, profile_.chroma_weight, false);
    const FeltMap spatial{ oracle::to_mat(map), truth.picture, kSpatialMapping };
    const auto mapping = tactile::MappingSettings::tuned();
    for (auto &way : ways_) {
      const auto &own = way->front_end.lab(frame, levels_.finest, way->converted);
      const double delta_e = mean_delta_e(saliency::to_float(own), lab);
      const auto &found = way->analyzer.analyze(frame, time, duration);
      way->spatial.add({ way->spatial_map, found.picture, kSpatialMapping }, spatial, kNearlyFlat,
                       delta_e);
      way->spatiotemporal.add({ found.map, found.picture, mapping },
                              { truth.map, truth.picture, mapping }, mapping.floor, delta_e);
    }
  }

  void add_rows(const std::string &name, bool temporal, std::vector<Agreement> &rows) const
  {
    for (std::size_t i = 0; i < ways_.size(); ++i)
      rows.push_back(ways_[i]->spatial.row(name, "spatial", kFrontEnds[i].name));
    for (std::size_t i = 0; temporal && i < ways_.size(); ++i)
      rows.push_back(ways_[i]->spatiotemporal.row(name, "spatiotemporal", kFrontEnds[i].name));
  }

private:
  struct Way
  {
    Way(const saliency::Profile &profile, int level) : converted(level), analyzer(profile)
    {
      analyzer.set_observer([this](saliency::Stage stage, const cv::Mat &map) {
        if (stage == saliency::Stage::spatial)
          spatial_map = map;
      });
    }

    int converted;
    saliency::FrontEnd front_end; ///< for ΔE
    saliency::Analyzer analyzer;
    cv::Mat spatial_map;
    Tally spatial;
    Tally spatiotemporal;
  };

  int threads_;
  saliency::Profile profile_;
  saliency::FrameLevels levels_;
  saliency::Analyzer reference_;
  std::vector<std::unique_ptr<Way>> ways_;
};

/// Compares maps of single pictures, of all front ends.
class PictureComparison
{
public:
  explicit PictureComparison(int threads) : threads_(threads)
  {
  }

  void picture(const saliency::FrameView &frame)
  {
    const auto profile = saliency::Profile::tuned_spatial();
    const auto mapping = tactile::MappingSettings::tuned_spatial();
    const cv::Size size(frame.width, frame.height);
    const int level = saliency::frame_levels(profile, size).finest;
    const oracle::LabImage lab = oracle_lab(frame, level, threads_);
    saliency::Analyzer reference(profile);
    const auto &truth = reference.analyze(oracle::to_planes(lab), size, {}, kFrame, false);
    for (std::size_t i = 0; i < kFrontEnds.size(); ++i) {
      saliency::FrontEnd front_end;
      const auto &own = front_end.lab(frame, level, kFrontEnds[i].converted(size, level));
      saliency::Analyzer analyzer(profile_of(profile, kFrontEnds[i]));
      const auto &found = analyzer.analyze(frame, {}, kFrame, false);
      tallies_[i].add({ found.map, found.picture, mapping }, { truth.map, truth.picture, mapping },
                      mapping.floor, mean_delta_e(saliency::to_float(own), lab));
    }
  }

  void add_rows(const std::string &name, std::vector<Agreement> &rows) const
  {
    for (std::size_t i = 0; i < tallies_.size(); ++i)
      rows.push_back(tallies_[i].row(name, "tuned spatial", kFrontEnds[i].name));
  }

private:
  int threads_;
  std::array<Tally, kFrontEnds.size()> tallies_;
};

std::vector<Agreement>
photograph_agreement(const std::filesystem::path &directory, OracleExtent extent)
{
  const cv::Size size(800, 600);
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto &entry : std::filesystem::directory_iterator(directory / "osie", error))
    if (entry.path().extension() == ".jpg")
      files.push_back(entry.path());
  std::ranges::sort(files);
  if (files.empty())
    throw std::runtime_error((directory / "osie").string() + ": no photographs there");

  const std::size_t step = extent == OracleExtent::all ? 1 : extent == OracleExtent::some ? 4 : 10;
  FilmComparison contrast(size, 1);
  PictureComparison spatial(1);
  for (std::size_t i = 0; i < files.size(); i += step) {
    Decoder picture(files[i], "jpegdec", "I420");
    if (!picture.next() || picture.view().width != size.width
        || picture.view().height != size.height)
      throw std::runtime_error(files[i].string() + ": expected 800 x 600 pixels");
    contrast.frame(picture.view(), static_cast<int>(i) * kFrame, kFrame);
    spatial.picture(picture.view());
  }
  std::vector<Agreement> rows;
  contrast.add_rows("photographs", false, rows);
  spatial.add_rows("photographs", rows);
  return rows;
}

/// From the tenth second on, after titles and fades, unless all of it.
std::vector<Agreement>
clip_agreement(const std::filesystem::path &file, OracleExtent extent)
{
  using std::chrono::seconds;
  const Time begin = extent == OracleExtent::all ? seconds(0) : seconds(10);
  const Time end = extent == OracleExtent::all    ? Time::max()
                   : extent == OracleExtent::some ? seconds(40)
                                                  : seconds(13);
  Decoder clip(file, "decodebin", "I420");
  std::unique_ptr<FilmComparison> comparison;
  while (clip.next() && clip.time() < end) {
    if (clip.time() < begin)
      continue;
    if (!comparison)
      comparison
          = std::make_unique<FilmComparison>(cv::Size(clip.view().width, clip.view().height), 1);
    comparison->frame(clip.view(), clip.time(), clip.duration());
  }
  if (!comparison)
    throw std::runtime_error(file.string() + ": too short");
  std::vector<Agreement> rows;
  comparison->add_rows(file.filename().string(), true, rows);
  return rows;
}

std::vector<Agreement>
leaves_agreement(cv::Size size, int pictures, int threads)
{
  FilmComparison contrast(size, threads);
  PictureComparison spatial(threads);
  for (int i = 0; i < pictures; ++i) {
    Frame frame(size);
    frame.draw(dead_leaves(size, static_cast<std::uint64_t>(i) + 1));
    frame.add_noise(tactile::SensorNoise(2, static_cast<std::uint64_t>(i)), i * kFrame);
    contrast.frame(frame.view(), i * kFrame, kFrame);
    spatial.picture(frame.view());
  }
  const std::string name
      = "leaves " + std::to_string(size.width) + "×" + std::to_string(size.height);
  std::vector<Agreement> rows;
  contrast.add_rows(name, false, rows);
  spatial.add_rows(name, rows);
  return rows;
}

} // namespace

Table
accuracy_table(const std::filesystem::path &data, int threads, OracleExtent extent)
{
  const bool few = extent == OracleExtent::few;
  std::vector<std::function<std::vector<Agreement>()>> jobs{
    [] {
      return leaves_agreement({ 640, 360 }, 10, 1);
    },
    [=] {
      return leaves_agreement({ 1920, 1080 }, few ? 2 : 10, 1);
    },
    [=] {
      return leaves_agreement({ 3840, 2160 }, few ? 1 : 5, 1);
    }
  };
  if (!data.empty()) {
    jobs.emplace_back([=] { return photograph_agreement(data, extent); });
    for (const auto &file : list_films(data / "clips"))
      jobs.emplace_back([=] { return clip_agreement(file, extent); });
  }
  std::vector<std::vector<Agreement>> found(jobs.size());
  in_parallel(
      threads, jobs.size(), [&](std::size_t i) { found[i] = jobs[i](); }, "accuracy");
  std::vector<Agreement> rows;
  for (const auto &some : found)
    rows.insert(rows.end(), some.begin(), some.end());
  Table table(
      "Agreement with a double-precision oracle",
      "Pearson's r of each map with one in double precision, over frames in which something "
      "is salient. "
      "Exact: exact=true, L\\*a\\*b\\* of every pixel. "
      "As good: a cell of at least 95 % of the oracle's strongest.",
      { "frames of", "map", "front end", "frames", "compared", "ΔE, mean", "r, least",
        "r, 1 % quantile", "r ≥ 0.999", "same strongest cell", "or as good" });
  for (const auto &row : rows)
    table.add({ row.frames_of, row.map, row.front_end, std::to_string(row.frames),
                std::to_string(row.compared), figure(row.delta_e, 3), figure(row.least, 5),
                figure(row.percentile, 5), percent(row.share_999), percent(row.same_cell),
                percent(row.as_good) },
              row.front_end == "default" && row.map != "spatial");
  return table;
}

bool
accuracy_holds(int threads)
{
  bool good = true;
  const auto floor = [&](const Agreement &row, const char *what, double value, double least) {
    if (value >= least)
      return;
    std::fprintf(stderr, "%s, %s: %s is %.6f; expected at least %.6f\n", row.frames_of.c_str(),
                 row.front_end.c_str(), what, value, least);
    good = false;
  };
  // At 1000×1000, components are decimated to the level of the map before conversion.
  for (const cv::Size size : { cv::Size(640, 360), cv::Size(1920, 1080), cv::Size(1000, 1000) })
    for (const auto &row : leaves_agreement(size, size.width > 640 ? 1 : 8, threads)) {
      const bool of_every_pixel
          = row.front_end == "exact" || saliency::decimation_level(size, 1) == 0;
      const double decimated = size.height == 1000 ? 0.998 : 0.9995;
      const double least = row.map == "tuned spatial" ? 0.985
                           : of_every_pixel           ? 0.999999
                                                      : decimated;
      floor(row, "correlation", row.least, least);
      floor(row, "share of frames with the same strongest cell", row.same_cell, 1);
    }
  return good;
}

} // namespace quality
