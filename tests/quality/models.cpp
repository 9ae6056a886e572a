// SPDX-License-Identifier: LGPL-2.1-or-later
#include "models.h"

#include "people/cascade_module.h"
#include "saliency/spatial_saliency.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace quality {

namespace {

tactile::SaliencyView
view_of(const cv::Mat &map)
{
  return { .values = map.ptr<float>(),
           .width = map.cols,
           .height = map.rows,
           .stride = static_cast<std::ptrdiff_t>(map.step1()) };
}

class PeerModel : public Model
{
public:
  PeerModel(std::shared_ptr<PeerMaps> maps, std::shared_ptr<RarityMaps> rarity)
      : Model(std::string(quality::name(maps->peer())) + (rarity ? " × R" : "")),
        maps_(std::move(maps)), rarity_(std::move(rarity))
  {
  }

  void frame(const Frame &frame, Time time, Time, tactile::TactileMap &map) override
  {
    maps_->of(frame, time).copyTo(map_);
    if (rarity_) {
      const int level
          = saliency::frame_levels(saliency::Profile::tuned_spatial(), frame.size()).finest;
      // Sample i of the weight is centered on pixel 2ⁿ i. The map's samples fill the frame.
      const double step = 1 << level;
      const double x = frame.size().width / step / map_.cols;
      const double y = frame.size().height / step / map_.rows;
      cv::warpAffine(rarity_->of(frame, time, level), on_map_,
                     cv::Matx23d(x, 0, (x - 1 / step) / 2, 0, y, (y - 1 / step) / 2), map_.size(),
                     cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
      cv::multiply(map_, on_map_, map_);
    }
    map_peer(map_, map);
  }

private:
  std::shared_ptr<PeerMaps> maps_;
  std::shared_ptr<RarityMaps> rarity_;
  cv::Mat on_map_;
  cv::Mat map_;
};

} // namespace

tactile::SaliencyView
view_of(const saliency::Saliency &found)
{
  auto view = view_of(found.map);
  view.horizontal = { found.picture.x, found.picture.width };
  view.vertical = { found.picture.y, found.picture.height };
  view.strength = found.strength;
  return view;
}

bool
finds_people()
{
  const auto detector = people::cascade_detector()();
  if (!detector)
    std::fprintf(stderr, "people left out: %s\n", detector.error().c_str());
  return detector.has_value();
}

AnalyzerModel::AnalyzerModel(std::string name, const saliency::Profile &profile,
                             const tactile::MappingSettings &mapping, bool with_people)
    : Model(std::move(name)), analyzer_(profile), mapping_(mapping)
{
  if (with_people)
    people_.emplace(people::cascade_detector(), people::Effort::fast, true);
}

tactile::SaliencyView
AnalyzerModel::look(const saliency::FrameView &frame, Time time, Time duration)
{
  found_ = analyzer_.analyze(frame, time, duration);
  if (!people_)
    return view_of(found_);
  found_.map = people_->raise({ found_, analyzer_.picture(), frame }, time);
  if (const std::string failure = people_->failure(); !failure.empty())
    throw std::runtime_error("no people: " + failure);
  // As in saliencytactile.
  tactile::SaliencyView view = view_of(found_);
  if (const double peak = std::max(found_.peak, mapping_.floor); peak > 0)
    view.strength *= view.peak() / peak;
  return view;
}

const saliency::Saliency &
AnalyzerModel::frame(const saliency::FrameView &frame, Time time, Time duration,
                     tactile::TactileMap &map)
{
  tactile::map_saliency(look(frame, time, duration), mapping_, map);
  return found_;
}

std::unique_ptr<AnalyzerModel>
paper_model()
{
  return std::make_unique<AnalyzerModel>("paper", saliency::Profile::paper(),
                                         tactile::MappingSettings::paper());
}

std::unique_ptr<AnalyzerModel>
tuned_model()
{
  static const bool with_people = finds_people();
  return std::make_unique<AnalyzerModel>("tuned", saliency::Profile::tuned(),
                                         tactile::MappingSettings::tuned(), with_people);
}

const cv::Mat &
PeerMaps::of(const Frame &frame, Time time)
{
  if (time_ && time < *time_)
    saliency_.reset();
  if (time_ != time)
    saliency_.compute(frame.bgr()).copyTo(map_);
  time_ = time;
  return map_;
}

const cv::Mat &
RarityMaps::of(const Frame &frame, Time time, int level)
{
  if (time_ != time)
    rarity_(saliency::to_float(front_end_.lab(frame.view(), level,
                                              saliency::decimation_level(frame.size(), level))),
            map_);
  time_ = time;
  return map_;
}

void
map_peer(const cv::Mat &saliency, tactile::TactileMap &map)
{
  constexpr tactile::MappingSettings kMapping{ .order = tactile::Order::pool_first,
                                               .gain = tactile::Gain::none };
  tactile::map_saliency(view_of(saliency), kMapping, map);
}

std::unique_ptr<Model>
peer_model(std::shared_ptr<PeerMaps> maps, std::shared_ptr<RarityMaps> rarity)
{
  return std::make_unique<PeerModel>(std::move(maps), std::move(rarity));
}

} // namespace quality
