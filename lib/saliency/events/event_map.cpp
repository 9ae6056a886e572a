// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/event_map.h"

#include <algorithm>
#include <cmath>

namespace saliency {

namespace {

constexpr double kLag = 2.4;           ///< frames at 30 fps between the compared pictures
constexpr double kShortestStep = 0.45; ///< frames at 30 fps between stored pictures
constexpr float kMost = 31;            ///< ΔE of a sample: an event is larger, not brighter
constexpr double kSmoothing = 3;       ///< half-life of the map, frames at 30 fps
constexpr double kEnergyHalf = 1.5;    ///< half-life of the energy, frames at 30 fps
constexpr double kBlur = 0.0375;       ///< σ in widths of the picture
// Where text moves, as much gets brighter as darker within kFine of the blur's σ. A share of up to
// kOpposite loses nothing; above about 4/5, nothing is left.
constexpr double kFine = 0.5;
constexpr float kOpposite = 0.15F;
constexpr float kLoss = 1.5F;
// A thing that appears and stands is held for kHeld frames at 30 fps, more weakly toward the end,
// while all other events are weaker than kAlone in ΔE.
constexpr double kHeld = 15;
constexpr double kFades = 0.8; ///< share of the weight that is gone at the end
constexpr float kAlone = 1.6F;
// A thing has gone where less than kGone of its contrast above kLeast is left.
constexpr float kGone = 0.3F;
constexpr float kLeast = 1;
// While the camera moves, weak events are its parallax: the map is divided by 1 + the camera's way
// in units of 1/kUnitsOfWidth of the width and, the more the camera travels, by a term of the
// misfit.
constexpr double kUnitsOfWidth = 160;
constexpr double kTravel = 20;        ///< per sample of misfit
constexpr double kLeastMisfit = 0.08; ///< samples
constexpr double kLeastWay = 0.3;     ///< in these units: a camera that travels

/// cv::Mat::setTo allocates.
void
clear(cv::Size size, cv::Mat &map)
{
  map.create(size, CV_32FC1);
  std::fill_n(map.ptr<float>(), map.total(), 0.0F);
}

/// The mean way of a sample, in kUnitsOfWidth of the width.
double
displacement(const Similarity &motion, cv::Size size)
{
  double sum = 0;
  for (const double x : { 0.25, 0.75 })
    for (const double y : { 0.25, 0.75 })
      sum += std::hypot(motion.x(x * size.width, y * size.height) - x * size.width,
                        motion.y(x * size.width, y * size.height) - y * size.height);
  return sum / 4 * kUnitsOfWidth / size.width;
}

double
blur_sigma(cv::Size map)
{
  return std::max(0.5, kBlur * std::max(map.width, map.height));
}

} // namespace

void
EventMap::reset()
{
  count_ = 0;
  energy_ = 0;
  change_ = 0;
  most_held_ = 0;
  noise_.reset();
}

void
EventMap::rebase(const Similarity &view)
{
  for (Picture &picture : past_)
    picture.pose = view * picture.pose;
}

void
EventMap::age(double elapsed)
{
  for (Picture &picture : past_)
    picture.age += elapsed;
}

void
EventMap::keep(const LabImage &shown, const cv::Mat &contrast, const Similarity &pose)
{
  if (count_ > 0 && past_[latest_].age < kShortestStep)
    return;
  past_.resize(kMostPictures);
  latest_ = (latest_ + 1) % kMostPictures;
  count_ = std::min(count_ + 1, kMostPictures);
  Picture &picture = past_[latest_];
  picture.age = 0;
  for (std::size_t c = 0; c < 3; ++c)
    shown.planes[c].copyTo(picture.lab.planes[c]);
  contrast.copyTo(picture.contrast);
  picture.pose = pose;
}

const cv::Mat &
EventMap::stay(double elapsed)
{
  age(elapsed);
  if (count_ > 0)
    keep(past_[latest_].lab, past_[latest_].contrast, past_[latest_].pose);
  for (std::size_t i = 0; i < held_age_.total(); ++i)
    held_age_.ptr<float>()[i] += static_cast<float>(elapsed);
  clear(map_.size(), now_);
  return settle(1, true, elapsed);
}

/// The picture whose age is nearest to the lag.
const EventMap::Picture *
EventMap::picture_before(double lag) const
{
  const Picture *best = nullptr;
  for (std::size_t i = 0; i < count_; ++i) {
    const Picture &picture = past_[(latest_ + kMostPictures - i) % kMostPictures];
    if (!best || std::abs(picture.age - lag) < std::abs(best->age - lag))
      best = &picture;
  }
  return best;
}

/// Lowers the difference that a thing leaves when it has gone, which is where little contrast is
/// left.
void
EventMap::weigh_onsets(const Look &look, const Picture &then, const Similarity &before,
                       cv::Mat &map)
{
  const Similarity back = before.in_units_of(std::ldexp(1.0, look.octaves));
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const int px = std::clamp(static_cast<int>(std::lround(back.x(x, y))), 0, map.cols - 1);
      const int py = std::clamp(static_cast<int>(std::lround(back.y(x, y))), 0, map.rows - 1);
      const float gone = kGone * then.contrast.ptr<float>(py)[px];
      const float left = look.contrast.ptr<float>(y)[x] + kLeast - gone;
      map.ptr<float>(y)[x] *= std::clamp(left / (gone + kLeast), 0.0F, 1.0F);
    }
}

int
EventMap::reach(cv::Size map)
{
  return static_cast<int>(std::ceil(2.5 * blur_sigma(map)));
}

/// Gaussian, with nothing outside. Most of a map is 0.
void
EventMap::blur(double sigma, cv::Mat &map)
{
  const int reach = static_cast<int>(std::ceil(2.5 * sigma));
  if (sigma != sigma_) {
    sigma_ = sigma;
    weights_.clear();
    double sum = 0;
    for (int i = -reach; i <= reach; ++i)
      sum += std::exp(-0.5 * i * i / (sigma * sigma));
    for (int i = -reach; i <= reach; ++i)
      weights_.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum));
  }
  clear(map.size(), along_rows_);
  rows_.assign(static_cast<std::size_t>(map.rows), {});
  for (int y = 0; y < map.rows; ++y) {
    const auto *in = map.ptr<float>(y);
    const auto *end = in + map.cols;
    const int first = static_cast<int>(std::find_if(in, end, [](float v) { return v != 0; }) - in);
    int last = map.cols; // of the samples that are not 0, plus one
    while (last > first && in[last - 1] == 0)
      --last;
    auto *out = along_rows_.ptr<float>(y);
    for (int i = -reach; first < last && i <= reach; ++i) {
      const float weight = weights_[static_cast<std::size_t>(i + reach)];
      for (int x = std::max(0, first - i); x < std::min(map.cols, last - i); ++x)
        out[x] += weight * in[x + i];
    }
    if (first < last)
      rows_[static_cast<std::size_t>(y)]
          = { std::max(0, first - reach), std::min(map.cols, last + reach) };
  }
  clear(map.size(), map);
  for (int y = 0; y < map.rows; ++y) {
    const auto *in = along_rows_.ptr<float>(y);
    const cv::Range row = rows_[static_cast<std::size_t>(y)];
    for (int i = std::max(-reach, -y); i <= std::min(reach, map.rows - 1 - y); ++i) {
      const float weight = weights_[static_cast<std::size_t>(i + reach)];
      auto *out = map.ptr<float>(y + i);
      for (int x = row.start; x < row.end; ++x)
        out[x] += weight * in[x];
    }
  }
}

/// The map from samples of now to samples of `then`.
Similarity
EventMap::motion_since(const Picture &then, const Look &look) const
{
  return then.pose == look.pose ? Similarity{} : then.pose.inverse() * look.pose;
}

/// A change at the level of the map.
void
EventMap::pool(const cv::Mat &change, int octaves, cv::Mat &pooled)
{
  const cv::Mat *finer = &change;
  for (int i = 0; i < octaves; ++i) {
    cv::Mat &coarser = i + 1 < octaves ? finer_[static_cast<std::size_t>(i)] : pooled;
    reductions_[static_cast<std::size_t>(i)](*finer, coarser);
    finer = &coarser;
  }
  if (octaves == 0)
    change.copyTo(pooled);
}

/// Lowers fine texture that moves, such as text, by `weight`: as much of it gets brighter as
/// darker, side by side, while a thing has one sign over its size. The outside of the picture
/// counts as texture.
void
EventMap::weigh_coherence(const Look &look, float weight, cv::Mat &map)
{
  unexplained_.split(look.picture, rises_, falls_);
  pool(rises_, look.octaves, brighter_);
  pool(falls_, look.octaves, darker_);
  const double sigma = kFine * blur_sigma(map.size());
  if (inside_.size() != map.size()) {
    inside_ = cv::Mat(map.size(), CV_32FC1, cv::Scalar(1));
    blur(sigma, inside_);
  }
  for (cv::Mat *part : { &around_, &brighter_, &darker_ })
    blur(sigma, *part);
  for (std::size_t i = 0; i < map.total(); ++i) {
    const float brighter = brighter_.ptr<float>()[i];
    const float darker = darker_.ptr<float>()[i];
    const float inside = inside_.ptr<float>()[i];
    const float opposite
        = inside * 2 * std::min(brighter, darker) + (1 - inside) * (brighter + darker);
    const float all = around_.ptr<float>()[i];
    if (opposite > kOpposite * all)
      map.ptr<float>()[i] *= 1 - weight * std::min(1.0F, kLoss * (opposite / all - kOpposite));
  }
}

/// Things that appeared since `then`, in ΔE.
void
EventMap::compare(const Look &look, const Picture &then, const Similarity &before, cv::Mat &map)
{
  pool(unexplained_(look.picture, then.lab, before), look.octaves, around_);
  map.create(look.contrast.size(), CV_32FC1);
  for (std::size_t i = 0; i < map.total(); ++i)
    map.ptr<float>()[i] = std::min(kMost, around_.ptr<float>()[i]);
  weigh_onsets(look, then, before, map);
  // Errors of the camera's motion have both signs, too.
  if (const double way = displacement(before, look.picture.size()); way < kLeastWay)
    weigh_coherence(look, static_cast<float>(1 - way / kLeastWay), map);
  blur(blur_sigma(map.size()), map);
}

/// A thing that appears is an event for half a second, as long as it stays, before a camera at
/// rest. All that moves has precedence.
void
EventMap::hold_onsets(const Look &look)
{
  float strongest = 0;
  most_held_ = 0;
  for (std::size_t i = 0; i < now_.total(); ++i) {
    const float now = now_.ptr<float>()[i];
    float &held = held_.ptr<float>()[i];
    float &age = held_age_.ptr<float>()[i];
    age += static_cast<float>(look.elapsed);
    if (now >= held || static_cast<double>(age) > kHeld) {
      held = now;
      age = 0;
    }
    strongest = std::max(strongest, now);
    most_held_ = std::max(most_held_, held);
  }
  const float alone = 1 - strongest / kAlone;
  if (alone <= 0 || most_held_ <= strongest)
    return;
  const Picture &then = *picture_before(kHeld);
  const Similarity before = motion_since(then, look);
  if (displacement(before, look.picture.size()) >= kLeastWay)
    return;
  compare(look, then, before, since_);
  for (std::size_t i = 0; i < now_.total(); ++i) {
    const float fades = static_cast<float>(kFades / kHeld) * held_age_.ptr<float>()[i];
    float &now = now_.ptr<float>()[i];
    now = std::max(now,
                   alone * (1 - fades) * std::min(held_.ptr<float>()[i], since_.ptr<float>()[i]));
  }
}

const cv::Mat &
EventMap::operator()(const Look &look)
{
  const cv::Size size = look.contrast.size();
  if (count_ > 0 && past_[latest_].lab.size() != look.picture.size())
    reset();
  age(look.elapsed);
  map_.create(size, CV_32FC1);
  const Picture *then = picture_before(kLag);
  if (!then) {
    for (cv::Mat *map : { &map_, &slow_, &held_, &held_age_ })
      clear(size, *map);
    keep(look.picture, look.contrast, look.pose);
    return map_;
  }
  const Similarity before = motion_since(*then, look);
  compare(look, *then, before, now_);
  const double way = displacement(before, look.picture.size());
  const double misfit = std::max(0.0, static_cast<double>(unexplained_.misfit()) - kLeastMisfit);
  hold_onsets(look);
  const double travel = 1 + kTravel * misfit * std::min(1.0, way / kLeastWay);
  settle(static_cast<float>(1 / ((1 + way) * travel)), way <= kLeastWay, look.elapsed);
  keep(look.picture, look.contrast, look.pose);
  return map_;
}

/// The map of the events `now_`.
const cv::Mat &
EventMap::settle(float scale, bool rests, double elapsed)
{
  const auto keeps = static_cast<float>(std::exp2(-elapsed / kSmoothing));
  float most = 0;
  change_ = 0;
  for (std::size_t i = 0; i < now_.total(); ++i) {
    const float now = now_.ptr<float>()[i];
    float &slow = slow_.ptr<float>()[i];
    slow = now + keeps * (slow - now);
    map_.ptr<float>()[i] = scale * (now + slow) / 2;
    most = std::max(most, now);
    change_ = std::max(change_, (now + slow) / 2);
  }
  if (rests)
    noise_.subtract(map_, elapsed);
  else
    noise_.reset(); // each place shows one thing after another
  energy_ = std::max(static_cast<double>(most), energy_ * std::exp2(-elapsed / kEnergyHalf));
  return map_;
}

} // namespace saliency
