// SPDX-License-Identifier: LGPL-2.1-or-later
#include "analysis.h"

#include "frame/front_end.h"
#include "race.h"
#include "saliency/pyramid.h"
#include "saliency/spatial_saliency.h"

#include <opencv2/core.hpp>

#include <cmath>
#include <vector>

namespace bench {

namespace {

constexpr saliency::Time kFrame{ 1'000'000'000 / 30 };

void
pool(const saliency::Saliency &found, const tactile::MappingSettings &mapping,
     tactile::TactileMap &map)
{
  tactile::map_saliency({ .values = found.map.ptr<float>(),
                          .width = found.map.cols,
                          .height = found.map.rows,
                          .stride = static_cast<std::ptrdiff_t>(found.map.step1()),
                          .horizontal = { found.picture.x, found.picture.width },
                          .vertical = { found.picture.y, found.picture.height } },
                        mapping, map);
}

/// A frame of the size after decimation, with full chroma.
saliency::FrameView
small_frame(const cv::Mat &samples)
{
  saliency::FrameView view;
  view.width = samples.cols;
  view.height = samples.rows / 3;
  for (std::size_t c = 0; c < 3; c++)
    view.components[c] = { samples.ptr(static_cast<int>(c) * view.height), samples.cols, 1,
                           view.width, view.height };
  return view;
}

} // namespace

Analysis::Analysis(const saliency::Profile &profile, const tactile::MappingSettings &mapping,
                   cv::Size grid, int threads, double rest)
    : analyzer_(profile), mapping_(mapping), map_(grid.height, grid.width)
{
  analyzer_.set_threads(threads);
  analyzer_.set_rest(rest);
}

void
Analysis::frame(const saliency::FrameView &frame, std::size_t i)
{
  pool(analyzer_.analyze(frame, static_cast<int>(i) * kFrame, kFrame), mapping_, map_);
}

StageTimes
stage_times(const saliency::Profile &profile, const tactile::MappingSettings &mapping,
            const FrameLoop &film, int warm_up, int frames)
{
  saliency::FrontEnd converter;
  saliency::Analyzer analyzer(profile);
  tactile::TactileMap map(3, 3);
  const int level = saliency::frame_levels(profile, film.size()).finest;
  const int converted = profile.exact ? 0 : saliency::decimation_level(film.size(), level);
  const cv::Size small = saliency::level_size(film.size(), converted);
  cv::Mat samples(3 * small.height, small.width, CV_8UC1);
  cv::randu(samples, 60, 200);

  constexpr std::size_t kOthers = 2; // Lab before the stages, pooling after them
  std::array<std::vector<double>, kStageNames.size() + kOthers> times;
  for (int i = 0; i < warm_up + frames; i++) {
    std::size_t next = 0;
    double begin = cpu_ms();
    const auto lap = [&] {
      if (i >= warm_up)
        times[next++].push_back(cpu_ms() - begin);
      begin = cpu_ms();
    };
    converter.lab(small_frame(samples), 0, 0);
    lap();
    analyzer.set_observer([&](saliency::Stage, const cv::Mat &) { lap(); });
    const auto &found
        = analyzer.analyze(film.view(static_cast<std::size_t>(i)), i * kFrame, kFrame);
    pool(found, mapping, map);
    lap();
  }

  StageTimes medians;
  medians.lab = profile.exact ? std::nan("") : median(times.front());
  for (std::size_t i = 0; i < medians.stages.size(); i++)
    medians.stages[i] = median(times[1 + i]);
  medians.pooling = median(times.back());
  return medians;
}

} // namespace bench
