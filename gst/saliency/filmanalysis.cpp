// SPDX-License-Identifier: LGPL-2.1-or-later
#include "filmanalysis.h"

#include "frame/front_end.h"
#include "framemapping.h"
#include "people/cascade_module.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace {

tactile::MappingSettings
make_mapping(const SaliencySettings &settings)
{
  using tactile::MappingSettings;
  MappingSettings mapping = settings.profile == ProfileName::paper ? MappingSettings::paper()
                            : settings.temporal                    ? MappingSettings::tuned()
                                                : MappingSettings::tuned_spatial();
  mapping.threshold = settings.threshold;
  if (settings.center_weight >= 0)
    mapping.center_weight = settings.center_weight;
  if (settings.floor >= 0)
    mapping.floor = settings.floor * mapping.units_per_delta_e;
  mapping.floor /= settings.sensitivity;
  mapping.units_per_delta_e /= settings.sensitivity;
  mapping.sensitivity = settings.sensitivity;
  return mapping;
}

/// Time between two analyses; 0 without a limit.
saliency::Time
analysis_period(double max_rate)
{
  return saliency::Time(max_rate > 0 ? static_cast<gint64>(std::min(1e9 / max_rate, 1e15)) : 0);
}

/// The rectangle of the map that the frame's pixels fill. `picture` is that of the view's samples,
/// whose outer ones may reach beyond the frame.
cv::Rect2d
rectangle_of(const ReadFrame &read, const FrameMapping &mapping, const cv::Rect2d &picture)
{
  if (!read.window)
    return picture;
  const double x_step = picture.width / mapping.view().width;
  const double y_step = picture.height / mapping.view().height;
  return { picture.x + (read.window->x - mapping.left()) * x_step,
           picture.y + (read.window->y - mapping.top()) * y_step, read.window->width * x_step,
           read.window->height * y_step };
}

/// The way of the camera since the last analysis: the picture moves the other way.
tactile::CameraWay
way_of(const saliency::Saliency &found)
{
  const double x = found.picture.x + found.picture.width / 2;
  const double y = found.picture.y + found.picture.height / 2;
  return { .right = (x - found.motion.x(x, y)) / found.picture.width,
           .down = (y - found.motion.y(x, y)) / found.picture.height,
           .ahead = std::log(std::hypot(found.motion.a, found.motion.b)) };
}

} // namespace

void
FilmAnalysis::forget()
{
  if (analyzer_) {
    analyzer_->reset();
    top_down_->reset();
  }
  if (people_)
    people_->reset();
  viewport_.reset();
  camera_wave_.reset();
  limiter_.reset();
}

void
FilmAnalysis::reset()
{
  forget();
  density_.reset();
  map_ = {};
  saliency_.map.clear();
  next_analysis_.reset();
}

void
FilmAnalysis::stop()
{
  analyzer_.reset();
  people_.reset();
  people_kind_ = {};
  reset();
}

bool
FilmAnalysis::turn(tactile::Orientation orientation)
{
  if (orientation == orientation_)
    return false;
  orientation_ = orientation;
  limiter_.reset();
  return true;
}

bool
FilmAnalysis::is_due(const SaliencySettings &settings, saliency::Time time)
{
  // Time stamps are rounded: three times a third of 100 ms is less than 100 ms.
  constexpr saliency::Time kSameTime = std::chrono::milliseconds(1);

  if (map_.rows != settings.rows || map_.columns != settings.columns || !analyzer_
      || kind_ != kind_of(settings) || orientation_ != map_orientation_)
    return true;
  const bool back = time < std::exchange(last_time_, time);
  if (next_analysis_ && !back && settings.max_rate > 0 && time + kSameTime < *next_analysis_)
    return false;
  const saliency::Time period = analysis_period(settings.max_rate);
  const bool on_grid = next_analysis_ && !back && time - *next_analysis_ < period;
  next_analysis_ = (on_grid ? *next_analysis_ : time) + period;
  return true;
}

FilmAnalysis::Kind
FilmAnalysis::kind_of(const SaliencySettings &settings)
{
  return { settings.profile, settings.temporal, settings.exact };
}

void
FilmAnalysis::make_analyzer(const Kind &kind)
{
  using saliency::Profile;
  if (analyzer_ && kind_ == kind)
    return;
  kind_ = kind;
  Profile profile = kind.profile == ProfileName::paper ? Profile::paper()
                    : kind.temporal                    ? Profile::tuned()
                                                       : Profile::tuned_spatial();
  profile.exact = profile.exact || kind.exact;
  top_down_.emplace(profile, kind.temporal);
  analyzer_.emplace(profile);
}

void
FilmAnalysis::make_people(const SaliencySettings &settings)
{
  using people::Effort;
  const PeopleKind kind{ settings.profile == ProfileName::paper ? PeopleMode::off : settings.people,
                         settings.temporal };
  if (people_kind_ == kind)
    return;
  people_kind_ = kind;
  people_.reset();
  if (kind.mode != PeopleMode::off)
    people_.emplace(people::cascade_detector(),
                    kind.mode == PeopleMode::thorough ? Effort::thorough : Effort::fast,
                    kind.temporal);
}

/// The saliency map, raised where people are, multiplied by the weights of regions.
const cv::Mat &
FilmAnalysis::weigh(const SaliencySettings &settings, GstBuffer *frame, const Placement &placement,
                    const saliency::FrameView &view, const saliency::Saliency &found,
                    saliency::Time time)
{
  raised_ = found;
  if (people_) {
    people_->wait(wait_for_people_);
    raised_.map = people_->raise(
        { found, analyzer_->picture(), view, people_of_interest(frame, placement) }, time);
  }
  if (!settings.roi_weights)
    return raised_.map;
  return top_down_->compute(raised_, { view.width, view.height },
                            regions_of_interest(frame, placement, *settings.roi_weights), time);
}

/// The maximum of interpolated samples is lower than that of the samples. The floor is lowered by
/// the same factor, so that both maps exceed it alike.
void
FilmAnalysis::keep_saliency(const tactile::SaliencyView &view, double floor)
{
  saliency_.map.sample(view);
  const double peak = view.peak();
  saliency_.floor = static_cast<gfloat>(peak > 0 ? floor * saliency_.map.peak() / peak : floor);
}

int
FilmAnalysis::halvings(const SaliencySettings &settings, int width, int height)
{
  make_analyzer(kind_of(settings));
  return saliency::preceding_halvings(analyzer_->profile(), { width, height });
}

tactile::TactileMap
FilmAnalysis::map(const SaliencySettings &settings, bool silent, saliency::Time time)
{
  tactile::TactileMap map = silent ? tactile::TactileMap(settings.rows, settings.columns) : map_;
  limiter_.limit(map, time, settings.cue_limits);
  return map;
}

bool
FilmAnalysis::analyze(const SaliencySettings &settings, const ReadFrame *read, GstBuffer *frame,
                      saliency::Time time, saliency::Time duration)
{
  make_analyzer(kind_of(settings));
  make_people(settings);
  analyzer_->set_threads(settings.n_threads);
  tactile::MappingSettings how = make_mapping(settings);
  // Weights and faces may raise what is far below the floor, and an attached map is read by others.
  const bool may_rest = settings.skip_unchanged && !settings.roi_weights
                        && !(people_ && people_->follows()) && !settings.attach_saliency;
  analyzer_->set_rest(may_rest ? how.floor : 0);
  saliency_.map.clear();
  map_orientation_ = orientation_;
  unchanged_ = false;
  std::optional<FrameMapping> mapping;
  if (read)
    mapping.emplace(read->info, read->buffer);
  if (!mapping || !*mapping || !saliency::fault_of(mapping->view()).empty()) {
    map_ = tactile::TactileMap(settings.rows, settings.columns);
    return false;
  }

  const saliency::Saliency &found = analyzer_->analyze(
      mapping->view(), time, std::max(duration, analysis_period(settings.max_rate)),
      settings.temporal);
  unchanged_ = found.unchanged;
  if (found.cut) { // the finds of the last shot are gone
    top_down_->reset();
    viewport_.reset();
    camera_wave_.reset();
  }
  Placement placement = read->placement; // of the frame in the analyzed picture
  placement.offset_x -= mapping->left();
  placement.offset_y -= mapping->top();
  const cv::Mat &saliency = weigh(settings, frame, placement, mapping->view(), found, time);
  const cv::Rect2d shown = rectangle_of(*read, *mapping, found.picture);
  tactile::SaliencyView view{ .values = saliency.ptr<float>(),
                              .width = saliency.cols,
                              .height = saliency.rows,
                              .stride = static_cast<std::ptrdiff_t>(saliency.step1()),
                              .horizontal = { shown.x, shown.width },
                              .vertical = { shown.y, shown.height },
                              .strength = found.strength };
  // Weights of regions and people change how strong the strongest is. A map below the floor is
  // noise, which people raise to an event of their own.
  if (const double peak = std::max(found.peak, how.floor); peak > 0)
    view.strength *= view.peak() / peak;
  how.floor = density_.follow(view, how.floor, settings.density, time);
  tactile::Viewport viewport;
  if (settings.viewport == ViewportMode::adaptive)
    viewport = viewport_.follow(view, how.floor, how.threshold, time);
  else
    viewport_.reset();
  // The grid is that of the screen; saliency, regions and viewport are in the pixels of the frame.
  const int rows = orientation_.transposed ? settings.columns : settings.rows;
  const int columns = orientation_.transposed ? settings.rows : settings.columns;
  if (stored_map_.rows != rows || stored_map_.columns != columns)
    stored_map_ = tactile::TactileMap(rows, columns);
  tactile::map_saliency(view, how, stored_map_, viewport);
  if (settings.camera == CameraMode::gentle)
    camera_wave_.follow(way_of(found), time, stored_map_);
  tactile::turn(stored_map_, orientation_, map_);
  if (settings.attach_saliency)
    keep_saliency(view, how.floor);
  return true;
}
