// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/event_map.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/events/event_map.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/vectors-inl.h"

#ifndef SALIENCY_EVENT_MAP_ONCE
#define SALIENCY_EVENT_MAP_ONCE
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

} // namespace
} // namespace saliency
#endif

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
HWY_INLINE float
greatest(D d, hn::Vec<D> values)
{
  return hn::GetLane(hn::MaxOfLanes(d, values));
}

/// Limits the change around each sample, and lowers it where `gone`, the contrast then, has gone.
void
weigh_onsets(const float *around, const float *contrast, const float *gone, std::size_t n,
             float *map)
{
  cover<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto least = hn::Set(d, kLeast);
    const auto before = hn::Mul(hn::Set(d, kGone), hn::LoadU(d, gone + i));
    const auto left = hn::Sub(hn::Add(hn::LoadU(d, contrast + i), least), before);
    const auto share
        = hn::Min(hn::Max(hn::Div(left, hn::Add(before, least)), hn::Zero(d)), hn::Set(d, 1.0F));
    const auto change = hn::Min(hn::Set(d, kMost), hn::LoadU(d, around + i));
    hn::StoreU(hn::Mul(change, share), d, map + i);
  });
}

/// out[x] = Σ weights[i] · in[x + i · step], in this order.
void
weighted(const float *in, std::ptrdiff_t step, const float *weights, int count, std::size_t n,
         float *out)
{
  cover<float>(n, [&](auto d, std::size_t x) HWY_ATTR {
    auto sum = hn::Zero(d);
    for (int i = 0; i < count; ++i)
      sum = hn::Add(sum, hn::Mul(hn::Set(d, weights[i]), hn::LoadU(d, in + x + i * step)));
    hn::StoreU(sum, d, out + x);
  });
}

void
weigh_coherence(const float *brighter, const float *darker, const float *inside,
                const float *around, float weight, std::size_t n, float *map)
{
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto one = hn::Set(d, 1.0F);
    const auto rises = hn::LoadU(d, brighter + i);
    const auto falls = hn::LoadU(d, darker + i);
    const auto within = hn::LoadU(d, inside + i);
    const auto all = hn::LoadU(d, around + i);
    const auto opposite = hn::Add(hn::Mul(hn::Mul(within, hn::Set(d, 2.0F)), hn::Min(rises, falls)),
                                  hn::Mul(hn::Sub(one, within), hn::Add(rises, falls)));
    const auto beyond = hn::Sub(hn::Div(opposite, all), hn::Set(d, kOpposite));
    const auto lost = hn::Mul(hn::Set(d, weight), hn::Min(one, hn::Mul(hn::Set(d, kLoss), beyond)));
    const auto value = hn::LoadU(d, map + i);
    const auto loses = hn::Gt(opposite, hn::Mul(hn::Set(d, kOpposite), all));
    hn::StoreU(hn::IfThenElse(loses, hn::Mul(value, hn::Sub(one, lost)), value), d, map + i);
  });
}

/// The strongest event now and the strongest one held.
std::array<float, 2>
hold(const float *now, float elapsed, std::size_t n, float *held, float *held_age)
{
  std::array<float, 2> most{};
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto present = hn::LoadU(d, now + i);
    const auto past = hn::LoadU(d, held + i);
    const auto age = hn::Add(hn::LoadU(d, held_age + i), hn::Set(d, elapsed));
    const auto begins
        = hn::Or(hn::Ge(present, past), hn::Gt(age, hn::Set(d, static_cast<float>(kHeld))));
    const auto stronger = hn::IfThenElse(begins, present, past);
    hn::StoreU(stronger, d, held + i);
    hn::StoreU(hn::IfThenZeroElse(begins, age), d, held_age + i);
    most = { std::max(most[0], greatest(d, present)), std::max(most[1], greatest(d, stronger)) };
  });
  return most;
}

/// The strongest event now, and the mean of it and its past.
std::array<float, 2>
settle(const float *now, float keeps, float scale, std::size_t n, float *slow, float *map)
{
  std::array<float, 2> most{};
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto half = hn::Set(d, 0.5F);
    const auto present = hn::LoadU(d, now + i);
    const auto past
        = hn::Add(present, hn::Mul(hn::Set(d, keeps), hn::Sub(hn::LoadU(d, slow + i), present)));
    const auto sum = hn::Add(present, past);
    hn::StoreU(past, d, slow + i);
    hn::StoreU(hn::Mul(hn::Mul(hn::Set(d, scale), sum), half), d, map + i);
    most = { std::max(most[0], greatest(d, present)),
             std::max(most[1], greatest(d, hn::Mul(sum, half))) };
  });
  return most;
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency {

HWY_EXPORT(weigh_onsets);
HWY_EXPORT(weighted);
HWY_EXPORT(weigh_coherence);
HWY_EXPORT(hold);
HWY_EXPORT(settle);

namespace {

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

/// Limits the change, and lowers the difference that a thing leaves when it has gone, which is
/// where little contrast is left.
void
EventMap::weigh_onsets(const Look &look, const Picture &then, const Similarity &before,
                       cv::Mat &map)
{
  map.create(look.contrast.size(), CV_32FC1);
  const cv::Mat *gone = &then.contrast;
  if (before != Similarity{}) {
    gone_.create(map.size(), CV_32FC1);
    gone = &gone_;
    const Similarity back = before.in_units_of(std::ldexp(1.0, look.octaves));
    const auto place = [](double position, int length) {
      return static_cast<int>(std::clamp(position + 0.5, 0.0, length - 0.5));
    };
    for (int y = 0; y < map.rows; ++y)
      for (int x = 0; x < map.cols; ++x)
        gone_.ptr<float>(y)[x] = then.contrast.ptr<float>(
            place(back.y(x, y), map.rows))[place(back.x(x, y), map.cols)];
  }
  HWY_DYNAMIC_DISPATCH(weigh_onsets)
  (around_.ptr<float>(), look.contrast.ptr<float>(), gone->ptr<float>(), map.total(),
   map.ptr<float>());
}

int
EventMap::reach(cv::Size map)
{
  return static_cast<int>(std::ceil(2.5 * blur_sigma(map)));
}

/// Gaussian, with nothing outside.
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
  const auto width = static_cast<std::size_t>(map.cols);
  padded_.assign(width + 2 * static_cast<std::size_t>(reach), 0);
  along_rows_.create(map.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y) {
    std::copy_n(map.ptr<float>(y), width, padded_.data() + reach);
    HWY_DYNAMIC_DISPATCH(weighted)
    (padded_.data(), 1, weights_.data(), 2 * reach + 1, width, along_rows_.ptr<float>(y));
  }
  for (int y = 0; y < map.rows; ++y) {
    const int first = std::max(0, y - reach);
    const int last = std::min(map.rows - 1, y + reach);
    HWY_DYNAMIC_DISPATCH(weighted)
    (along_rows_.ptr<float>(first), map.cols,
     &weights_[static_cast<std::size_t>(first - y + reach)], last - first + 1, width,
     map.ptr<float>(y));
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
  HWY_DYNAMIC_DISPATCH(weigh_coherence)
  (brighter_.ptr<float>(), darker_.ptr<float>(), inside_.ptr<float>(), around_.ptr<float>(), weight,
   map.total(), map.ptr<float>());
}

/// Things that appeared since `then`, in ΔE.
void
EventMap::compare(const Look &look, const Picture &then, const Similarity &before, cv::Mat &map)
{
  pool(unexplained_(look.picture, then.lab, before), look.octaves, around_);
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
  const auto [strongest, most_held]
      = HWY_DYNAMIC_DISPATCH(hold)(now_.ptr<float>(), static_cast<float>(look.elapsed),
                                   now_.total(), held_.ptr<float>(), held_age_.ptr<float>());
  most_held_ = most_held;
  const float alone = 1 - strongest / kAlone;
  if (alone <= 0 || most_held_ <= strongest)
    return;
  const Picture &then = *picture_before(kHeld);
  const Similarity before = motion_since(then, look);
  if (displacement(before, look.picture.size()) >= kLeastWay)
    return;
  compare(look, then, before, since_);
  for (std::size_t i = 0, total = now_.total(); i < total; ++i) {
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
  const auto [most, change] = HWY_DYNAMIC_DISPATCH(settle)(
      now_.ptr<float>(), keeps, scale, now_.total(), slow_.ptr<float>(), map_.ptr<float>());
  change_ = change;
  if (rests)
    noise_.subtract(map_, elapsed);
  else
    noise_.reset(); // each place shows one thing after another
  energy_ = std::max(static_cast<double>(most), energy_ * std::exp2(-elapsed / kEnergyHalf));
  return map_;
}

} // namespace saliency
#endif
