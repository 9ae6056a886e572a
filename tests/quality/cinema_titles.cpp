// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_titles.h"

#include "layered_scene.h"
#include "random.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <string>

namespace quality {

namespace {

constexpr double kLength = std::chrono::duration<double>(kCinemaLength).count();

std::string
word(Random &random)
{
  std::string letters;
  const int count = static_cast<int>(random.uniform(3, 10));
  for (int i = 0; i < count; ++i)
    letters += static_cast<char>((i == 0 ? 'A' : 'a') + static_cast<int>(random.uniform(0, 26)));
  return letters;
}

/// A line of text, its middle at (x, y), in a CV_8UC1 of kTexels per pixel. `height` of a capital
/// letter in texels. Returns where it is.
cv::Rect
write(cv::Mat &mask, const std::string &text, int font, double x, double y, double height)
{
  const int thickness = std::max(1, static_cast<int>(height / 9));
  const double scale = cv::getFontScaleFromHeight(font, static_cast<int>(height), thickness);
  int below = 0;
  const cv::Size size = cv::getTextSize(text, font, scale, thickness, &below);
  const cv::Point left(static_cast<int>(x - size.width / 2.0),
                       static_cast<int>(y + size.height / 2.0));
  cv::putText(mask, text, left, font, scale, 255, thickness, cv::LINE_AA);
  return { left.x, left.y - size.height, size.width, size.height + below };
}

/// A title that stands, with its times in seconds.
struct StandingTitle
{
  double begin = 0;
  double stands = 0;
  double goes = 0;
  double gone = 0;
  cv::Mat alpha; ///< CV_8UC1
  cv::Rect2d box;
};

class TitleFilm : public CinemaFilm
{
public:
  TitleFilm(Title title, const cv::Mat &picture, cv::Size size, std::uint64_t seed)
      : title_(title), size_(size), random_(seed * 3571 + static_cast<std::uint64_t>(title)),
        picture_(size, CV_8UC3, cv::Scalar::all(0)), speed_(random_.uniform(1.0 / 8, 1.0 / 4))
  {
    if (!picture.empty()) {
      cv::resize(picture, picture_, size, 0, 0, cv::INTER_AREA);
      picture_ *= title == Title::credits ? 0.5 : 0.8;
    }
    if (title == Title::credits) {
      make_roll();
      return;
    }
    for (double begin = random_.uniform(1, 2); begin < kLength - 3;)
      begin = add_card(begin);
  }

  Expected draw(Time time, cv::Mat &bgr) override
  {
    const double t = std::chrono::duration<double>(time).count();
    picture_.copyTo(bgr);
    if (title_ != Title::credits)
      return draw_card(t, bgr);
    const double top = speed_ * size_.height * (t - kFirstLine); // pixels that have come in
    const cv::Matx23d to_texel(kTexels, 0, (kTexels - 1) / 2, 0, kTexels,
                               (kTexels - 1) / 2 + kTexels * (top - size_.height));
    cv::warpAffine(roll_, alpha_, to_texel, size_, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_CONSTANT);
    whiten(bgr, alpha_, 1);
    return t >= kFirstLine && t < kFirstLine + kAfter ? anything() : Expected{};
  }

private:
  static constexpr double kAfter = 1; ///< s
  static constexpr double kFirstLine = 1;

  void whiten(cv::Mat &bgr, const cv::Mat &alpha, double share)
  {
    cv::merge(std::array{ alpha, alpha, alpha }, alpha3_);
    cv::Mat rest;
    cv::subtract(cv::Scalar::all(255), bgr, rest);
    cv::multiply(rest, alpha3_, rest, share * 0.94 / 255);
    cv::add(bgr, rest, bgr);
  }

  Expected draw_card(double t, cv::Mat &bgr)
  {
    constexpr double kGone = 0.5;
    Expected expected;
    for (const StandingTitle &card : cards_) {
      if (t < card.begin || t >= card.gone + kGone)
        continue;
      const double in
          = card.stands > card.begin ? (t - card.begin) / (card.stands - card.begin) : 1;
      const double out = (card.gone - t) / (card.gone - card.goes);
      if (const double share = std::clamp(std::min(in, out), 0.0, 1.0); share > 0)
        whiten(bgr, card.alpha, share);
      if (t >= card.goes)
        return anything();
      if (t < card.stands + kAfter) {
        expected.verdict = Verdict::allowed;
        expected.cells = cells_of(card.box, size_);
      }
    }
    return expected;
  }

  double add_card(double begin)
  {
    StandingTitle card;
    card.begin = begin;
    card.stands = begin + (title_ == Title::fades ? random_.uniform(0.5, 1) : 0);
    card.goes = card.stands + random_.uniform(3, 4);
    card.gone = card.goes + random_.uniform(0.4, 0.8);
    cv::Mat mask(size_ * static_cast<int>(kTexels), CV_8UC1, cv::Scalar(0));
    const int lines = static_cast<int>(random_.uniform(1, 4));
    const double height = mask.rows * random_.uniform(0.05, 0.1);
    const int font = choose_font();
    cv::Rect box;
    for (int i = 0; i < lines; ++i) {
      const std::string text
          = word(random_) + (height < 0.07 * mask.rows ? " " + word(random_) : "");
      box |= write(mask, text, font, mask.cols / 2.0,
                   mask.rows / 2.0 + (i - (lines - 1) / 2.0) * 1.9 * height, height);
    }
    cv::resize(mask, card.alpha, size_, 0, 0, cv::INTER_AREA);
    card.box
        = cv::Rect2d(box.x / kTexels, box.y / kTexels, box.width / kTexels, box.height / kTexels);
    cards_.push_back(card);
    return card.gone + random_.uniform(1, 1.5);
  }

  /// All credits, beneath one another.
  void make_roll()
  {
    const double length = speed_ * (kLength - kFirstLine) + 0.2; // heights of the frame
    roll_ = cv::Mat(static_cast<int>(size_.height * length * kTexels),
                    static_cast<int>(size_.width * kTexels), CV_8UC1, cv::Scalar(0));
    const double height = size_.height * kTexels * random_.uniform(0.03, 0.045);
    const int font = choose_font();
    for (double y = height; y < roll_.rows; y += height * random_.uniform(1.8, 2.4)) {
      if (random_.uniform(0, 1) < 0.2) {
        y += 2 * height;
        continue;
      }
      write(roll_, word(random_), font, roll_.cols * 0.36, y, 0.8 * height);
      write(roll_, word(random_) + " " + word(random_), font, roll_.cols * 0.64, y, height);
    }
    cv::GaussianBlur(roll_, roll_, {}, kAperture * kTexels);
  }

  int choose_font()
  {
    constexpr std::array kFonts{ cv::FONT_HERSHEY_SIMPLEX, cv::FONT_HERSHEY_DUPLEX,
                                 cv::FONT_HERSHEY_COMPLEX, cv::FONT_HERSHEY_TRIPLEX };
    return kFonts[static_cast<std::size_t>(random_.uniform(0, 4))];
  }

  Title title_;
  cv::Size size_;
  Random random_;
  cv::Mat picture_;
  double speed_; ///< heights of the frame per second
  std::vector<StandingTitle> cards_;
  cv::Mat roll_; ///< CV_8UC1
  cv::Mat alpha_;
  cv::Mat alpha3_;
};

} // namespace

std::unique_ptr<CinemaFilm>
title_film(Title title, const cv::Mat &picture, cv::Size size, std::uint64_t seed)
{
  return std::make_unique<TitleFilm>(title, picture, size, seed);
}

} // namespace quality
