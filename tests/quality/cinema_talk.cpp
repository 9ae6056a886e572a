// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_talk.h"

#include "camera_path.h"
#include "check/elements/schematic_face.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace quality {

namespace {

constexpr double kTau = 2 * std::numbers::pi;
constexpr double kLength = std::chrono::duration<double>(kCinemaLength).count();
constexpr int kShift = 4;           ///< fractional bits of OpenCV's drawing functions
constexpr std::size_t kMouth = 9;   ///< of kSchematicFace
constexpr double kFaceHeight = 1.3; ///< half, in units of half the width

int
fixed_point(double length)
{
  return static_cast<int>(std::lround(std::ldexp(length, kShift)));
}

struct Phrase
{
  double begin;
  double end;
};

struct Person
{
  cv::Point2d face; ///< middle
  double unit;      ///< half the width of the face, pixels
  cv::Scalar skin;  ///< per gray
  cv::Scalar shirt;
  double rate; ///< of the mouth, Hz
  Tremor nod;
  Tremor loudness;
  std::vector<Phrase> phrases;

  bool talks(double t) const
  {
    return std::ranges::any_of(
        phrases, [t](const Phrase &phrase) { return t >= phrase.begin && t < phrase.end; });
  }

  /// How far the mouth is open, in [0, 1].
  double mouth(double t) const
  {
    return talks(t) ? (0.5 - 0.5 * std::cos(kTau * rate * t))
                          * std::clamp(0.8 + 0.3 * loudness.at(t), 0.3, 1.2)
                    : 0;
  }
};

void
draw_person(const Person &person, double t, cv::Mat &bgr)
{
  const auto ellipse = [&](cv::Point2d middle, double wide, double high, const cv::Scalar &color) {
    cv::ellipse(bgr, { fixed_point(middle.x), fixed_point(middle.y) },
                { fixed_point(wide), fixed_point(high) }, 0, 0, 360, color, cv::FILLED, cv::LINE_AA,
                kShift);
  };
  const double unit = person.unit;
  ellipse(person.face + cv::Point2d(0, 4.3 * unit), 2.3 * unit, 2.9 * unit, person.shirt);
  ellipse(person.face + cv::Point2d(0, 1.5 * unit), 0.5 * unit, 0.7 * unit, person.skin * 150);
  for (const double side : { -0.8, 0.8 }) // hands, folded before the chest
    ellipse(person.face + cv::Point2d(side * unit, 3.6 * unit), 0.5 * unit, 0.35 * unit,
            person.skin * 180);
  const cv::Point2d head = person.face + cv::Point2d(0, 0.03 * unit * person.nod.at(t));
  const bool blinks = std::fmod(t + person.rate, 3.7) < 0.15;
  for (std::size_t i = 0; i < kSchematicFace.size(); ++i) {
    FacePart part = kSchematicFace[i];
    if (i == kMouth)
      part.radius_y += 0.16 * person.mouth(t);
    const bool pupil = part.gray < 50;
    ellipse(head + cv::Point2d(part.x, part.y) * unit, part.radius_x * unit, part.radius_y * unit,
            person.skin * (pupil && blinks ? 110 : part.gray));
    if (i == kMouth && person.mouth(t) > 0.15) // the dark inside
      ellipse(head + cv::Point2d(part.x, part.y) * unit, part.radius_x * 0.75 * unit,
              0.15 * person.mouth(t) * unit, cv::Scalar(35, 25, 55));
  }
}

class TalkingFilm : public CinemaFilm
{
public:
  TalkingFilm(bool listener, const cv::Mat &picture, cv::Size size, std::uint64_t seed)
      : size_(size)
  {
    cv::resize(picture, picture_, size, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(picture_, picture_, {}, size.width / 60.0); // out of focus
    picture_ *= 0.6;
    Random random(seed * 59 + (listener ? 1 : 0));
    const double side = random.uniform(0, 1) < 0.5 ? -1 : 1;
    people_.push_back(person(random, 0.5 + side * random.uniform(0.2, 0.3)));
    if (listener)
      people_.push_back(person(random, 0.5 - side * random.uniform(0.2, 0.3)));
    for (double begin = random.uniform(1, 1.5); begin < kLength;) {
      const double end = begin + random.uniform(1.5, 3);
      people_[0].phrases.push_back({ begin, end });
      begin = end + random.uniform(0.3, 0.8);
    }
  }

  Expected draw(Time time, cv::Mat &bgr) override
  {
    const double t = std::chrono::duration<double>(time).count();
    picture_.copyTo(bgr);
    for (const Person &person : people_)
      draw_person(person, t, bgr);
    const Person &talker = people_[0];
    Expected expected;
    if (t < talker.phrases[0].begin)
      return anything();
    expected.events = 1;
    expected.verdict = Verdict::felt;
    const cv::Point2d half(talker.unit, talker.unit * kFaceHeight);
    expected.cells = cells_of({ talker.face - half, talker.face + half }, size_);
    return expected;
  }

private:
  /// At that share of the width.
  Person person(Random &random, double x) const
  {
    const double unit = size_.height * random.uniform(0.11, 0.15);
    const double tan = random.uniform(0.75, 1.15);
    return { { size_.width * x, size_.height * random.uniform(0.28, 0.36) },
             unit,
             cv::Scalar(0.72, 0.86, 1.08) * tan,
             { random.uniform(30, 120), random.uniform(30, 120), random.uniform(30, 120) },
             random.uniform(3, 5),
             Tremor(random, 0.3, 1),
             Tremor(random, 0.5, 2),
             {} };
  }

  cv::Size size_;
  cv::Mat picture_;
  std::vector<Person> people_; ///< the first talks
};

} // namespace

std::unique_ptr<CinemaFilm>
talking_film(bool listener, const cv::Mat &picture, cv::Size size, std::uint64_t seed)
{
  return std::make_unique<TalkingFilm>(listener, picture, size, seed);
}

} // namespace quality
