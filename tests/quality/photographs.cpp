// SPDX-License-Identifier: LGPL-2.1-or-later
#include "photographs.h"

#include "decode.h"
#include "fixations.h"
#include "frame/front_end.h"
#include "models.h"
#include "parallel.h"
#include "peers.h"
#include "people/cascade_module.h"
#include "people/people.h"
#include "saliency/analyzer.h"
#include "saliency/rarity.h"
#include "saliency/spatial_saliency.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

namespace quality {

namespace {

using tactile::MappingSettings;

const cv::Size kPicture(800, 600);
const cv::Size kGrid(200, 150);
constexpr double kBlur = 6; ///< samples of the grid
constexpr double kBorder = 0.1;
constexpr int kSide = 3; ///< rows and columns of the chair

enum Split
{
  train,
  validation,
};
constexpr std::array kSplitNames{ "train", "validation" };

struct Photograph
{
  std::string name;
  Split split = train;
  Fixations fixations;                ///< of all people, in samples of the grid
  std::array<Fixations, 2> of_halves; ///< of every other person
};

/// The pictures with fixations, by name.
std::vector<Photograph>
list_photographs(const std::filesystem::path &directory)
{
  std::vector<Photograph> photographs;
  for (const auto &[name, people] : read_fixations(directory / "fixations.csv", kPicture)) {
    int number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error != std::errc{} || std::string_view(end) != ".jpg"
        || (number % 4 != 1 && number % 4 != 3))
      throw std::runtime_error("fixations.csv: expected pictures ODD-NUMBER.jpg, not " + name);
    Photograph &photograph = photographs.emplace_back(
        Photograph{ name, number % 4 == 1 ? train : validation, {}, {} });
    std::size_t half = 0;
    for (const auto &[person, fixations] : people) {
      for (const auto &fixation : fixations)
        photograph.of_halves[half].emplace_back(fixation.x * kGrid.width / kPicture.width,
                                                fixation.y * kGrid.height / kPicture.height);
      half = 1 - half;
    }
    for (const Fixations &fixations : photograph.of_halves)
      photograph.fixations.insert(photograph.fixations.end(), fixations.begin(), fixations.end());
  }
  return photographs;
}

/// A decoded picture.
class Picture
{
public:
  Picture(const std::filesystem::path &file, const char *format) : decoder_(file, "jpegdec", format)
  {
    if (!decoder_.next())
      throw std::runtime_error(file.string() + ": no picture in it");
    if (view().width != kPicture.width || view().height != kPicture.height)
      throw std::runtime_error(file.string() + ": expected 800 x 600 pixels");
  }

  const saliency::FrameView &view() const
  {
    return decoder_.view();
  }

private:
  Decoder decoder_;
};

/// Resamples a map to the grid. `picture` is the picture's rectangle in the map.
cv::Mat
on_grid(const cv::Mat &map, const cv::Rect2d &picture)
{
  const double x = picture.width / kGrid.width;
  const double y = picture.height / kGrid.height;
  // From sample center to sample center: i + ½ on the grid is picture.x + x (i + ½) in the map.
  const cv::Matx23d transform(x, 0, picture.x + 0.5 * x - 0.5, 0, y, picture.y + 0.5 * y - 0.5);
  cv::Mat grid;
  cv::warpAffine(map, grid, transform, kGrid, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return grid;
}

/// Resamples a map that covers exactly the picture.
cv::Mat
on_grid(const cv::Mat &map)
{
  cv::Mat grid;
  const bool finer = map.cols > kGrid.width && map.rows > kGrid.height;
  cv::resize(map, grid, kGrid, 0, 0, finer ? cv::INTER_AREA : cv::INTER_LINEAR);
  return grid;
}

/// What a model makes of a picture.
struct Found
{
  cv::Mat map; ///< on the grid
  tactile::TactileMap felt{ kSide, kSide };
};

/// What would be felt of a map that the whole picture fills.
Found
felt_of(const cv::Mat &map)
{
  Found found{ map };
  map_peer(map, found.felt);
  return found;
}

/// The models and their buffers.
class Models
{
public:
  static std::vector<std::string> names(bool with_people)
  {
    std::vector<std::string> names{ "center",
                                    "paper literal",
                                    "tuned film",
                                    "tuned film × R·B²",
                                    "tuned spatial",
                                    "tuned spatial, no center weight",
                                    "tuned spatial, threshold first" };
    if (with_people)
      names.emplace_back("tuned spatial + people");
    for (const Peer peer : still_peers()) {
      const std::string own = name(peer);
      names.insert(names.end(), { own, own + " × R", own + " × R·B²" });
    }
    return names;
  }

  explicit Models(bool with_people)
  {
    if (with_people)
      people_.emplace(people::cascade_detector(), people::Effort::thorough, false);
    for (const Peer peer : still_peers())
      peers_.emplace_back(peer);
  }

  /// Their maps on the grid, in the order of names().
  std::vector<Found> maps(const std::filesystem::path &file)
  {
    const Picture i420(file, "I420");
    const Picture bgr(file, "BGR");
    const cv::Mat rarity = weight(i420.view(), rarity_);
    const cv::Mat border_rarity = weight(i420.view(), border_rarity_);
    const cv::Mat sketch = rarity.mul(border_rarity).mul(border_rarity);

    std::vector<Found> maps{ felt_of(center_) };
    maps.push_back(own(paper_, MappingSettings::paper(), i420.view()));
    maps.push_back(own(film_, MappingSettings::tuned(), i420.view()));
    maps.push_back(felt_of(maps.back().map.mul(sketch)));
    maps.push_back(own(spatial_, MappingSettings::tuned_spatial(), i420.view()));
    MappingSettings even = MappingSettings::tuned_spatial();
    even.center_weight = 0;
    maps.push_back(own(spatial_, even, i420.view()));
    even.order = tactile::Order::threshold_first;
    maps.push_back(own(spatial_, even, i420.view()));
    if (people_)
      maps.push_back(own(spatial_, MappingSettings::tuned_spatial(), i420.view(), &*people_));
    for (auto &peer : peers_) {
      const cv::Mat map = on_grid(peer.compute_still(as_mat(bgr.view())));
      maps.insert(maps.end(), { felt_of(map), felt_of(map.mul(rarity)), felt_of(map.mul(sketch)) });
    }
    return maps;
  }

private:
  static std::vector<Peer> still_peers()
  {
    std::vector<Peer> peers;
    std::copy_if(kPeers.begin(), kPeers.end(), std::back_inserter(peers),
                 [](Peer peer) { return is_available(peer) && !needs_motion(peer); });
    return peers;
  }

  static Found own(saliency::Analyzer &analyzer, const tactile::MappingSettings &mapping,
                   const saliency::FrameView &view, people::People *people = nullptr)
  {
    analyzer.reset();
    saliency::Saliency saliency = analyzer.analyze(view, {}, {}, false);
    if (people) {
      people->reset();
      saliency.map = people->raise({ saliency, analyzer.picture(), view }, {});
      if (const std::string failure = people->failure(); !failure.empty())
        throw std::runtime_error("no people: " + failure);
    }
    Found found{ on_grid(saliency.map, saliency.picture) };
    tactile::map_saliency(view_of(saliency), mapping, found.felt);
    return found;
  }

  /// A Gaussian in the middle of the picture, σ a quarter of each side.
  static cv::Mat center_map()
  {
    const cv::Mat across = cv::getGaussianKernel(kGrid.width, kGrid.width / 4.0, CV_32F);
    const cv::Mat down = cv::getGaussianKernel(kGrid.height, kGrid.height / 4.0, CV_32F);
    return down * across.t();
  }

  /// Rarity at the level of the profile for single pictures.
  cv::Mat weight(const saliency::FrameView &view, saliency::Rarity &rarity)
  {
    const int level = saliency::frame_levels(spatial_.profile(), kPicture).coarsest;
    cv::Mat map;
    rarity(saliency::to_float(
               front_end_.lab(view, level, saliency::decimation_level(kPicture, level))),
           map);
    const double step = 1 << level;
    return on_grid(
        map, { 0.5 - 0.5 / step, 0.5 - 0.5 / step, kPicture.width / step, kPicture.height / step });
  }

  cv::Mat center_ = center_map();
  saliency::Analyzer paper_{ saliency::Profile::paper() };
  saliency::Analyzer film_{ saliency::Profile::tuned() };
  saliency::Analyzer spatial_{ saliency::Profile::tuned_spatial() };
  std::optional<people::People> people_;
  saliency::FrontEnd front_end_;
  saliency::Rarity rarity_;
  saliency::Rarity border_rarity_{ kBorder };
  std::vector<PeerSaliency> peers_;
};

/// In samples of the levels.
Fixations
in_cells(const Fixations &fixations)
{
  Fixations cells;
  for (const auto &fixation : fixations)
    cells.emplace_back(fixation.x * kSide / kGrid.width, fixation.y * kSide / kGrid.height);
  return cells;
}

/// What people look at, as a model's map and as levels.
Found
found_by(const Fixations &fixations)
{
  Found found{ fixation_density(kGrid, fixations, 0) };
  const cv::Mat looked = fixation_density({ kSide, kSide }, in_cells(fixations), 0);
  std::copy(looked.begin<float>(), looked.end<float>(), found.felt.levels.begin());
  return found;
}

/// How well a model finds the fixations; `others` are those on other pictures.
PhotographScores
score(const Found &found, const Fixations &fixations, const Fixations &others)
{
  cv::Mat map;
  cv::GaussianBlur(found.map, map, {}, kBlur);
  const cv::Mat levels(kSide, kSide, CV_32FC1, const_cast<float *>(found.felt.levels.data()));
  const Fixations cells = in_cells(fixations);
  const cv::Mat looked = fixation_density({ kSide, kSide }, cells, 0);
  cv::Point strongest;
  cv::Point most;
  cv::minMaxLoc(levels, nullptr, nullptr, nullptr, &strongest);
  cv::minMaxLoc(looked, nullptr, nullptr, nullptr, &most);
  return { .nss = nss(map, fixations),
           .auc_judd = auc_judd(map, fixations),
           .shuffled_auc = shuffled_auc(map, fixations, others),
           .cc = correlation(map, fixation_density(kGrid, fixations, kBlur)),
           .cell_right = strongest == most ? 1.0 : 0.0,
           .cell_cc = correlation(levels, looked),
           .felt_nss = nss(levels, cells) };
}

constexpr std::array kScores{ &PhotographScores::nss,          &PhotographScores::auc_judd,
                              &PhotographScores::shuffled_auc, &PhotographScores::cc,
                              &PhotographScores::cell_right,   &PhotographScores::cell_cc,
                              &PhotographScores::felt_nss };

PhotographScores
mean_of(std::span<const PhotographScores> all)
{
  PhotographScores mean;
  for (const auto score : kScores) {
    for (const PhotographScores &one : all)
      mean.*score += one.*score;
    mean.*score /= static_cast<double>(all.size());
  }
  return mean;
}

} // namespace

PhotographScores
PhotographRow::mean() const
{
  return mean_of(pictures);
}

std::vector<PhotographRow>
score_photographs(const std::filesystem::path &directory, int threads)
{
  const auto photographs = list_photographs(directory);
  std::vector<std::vector<PhotographScores>> scores(photographs.size());
  const bool with_people = finds_people();
  const auto judge = [&](std::size_t i, Models &models) {
    const auto &photograph = photographs[i];
    Fixations others;
    for (const auto &other : photographs)
      if (other.split == photograph.split && other.name != photograph.name)
        others.insert(others.end(), other.fixations.begin(), other.fixations.end());
    if (others.empty())
      throw std::runtime_error("fixations.csv: a split needs two pictures or more");
    for (const auto &found : models.maps(directory / photograph.name))
      scores[i].push_back(score(found, photograph.fixations, others));
    const auto &[one, other] = photograph.of_halves;
    if (one.empty() || other.empty())
      throw std::runtime_error("fixations.csv: a picture needs two people or more");
    scores[i].push_back(mean_of(
        std::array{ score(found_by(one), other, others), score(found_by(other), one, others) }));
  };
  in_parallel_each(
      threads, photographs.size(),
      [&]() -> Work {
        return [&judge, models = std::make_shared<Models>(with_people)](std::size_t i) {
          judge(i, *models);
        };
      },
      "photographs");

  std::vector<PhotographRow> rows;
  auto names = Models::names(with_people);
  names.emplace_back("people");
  for (std::size_t model = 0; model < names.size(); ++model)
    for (const Split split : { train, validation }) {
      PhotographRow row{ names[model], kSplitNames[split], {} };
      for (std::size_t i = 0; i < photographs.size(); ++i)
        if (photographs[i].split == split)
          row.pictures.push_back(scores[i][model]);
      if (!row.pictures.empty())
        rows.push_back(row);
    }
  return rows;
}

cv::Mat
read_photograph(const std::filesystem::path &file)
{
  return as_mat(Picture(file, "BGR").view()).clone();
}

} // namespace quality
