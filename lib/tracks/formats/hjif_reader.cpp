// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/hjif.h"

#include "tracks/formats/json_document.h"
#include "tracks/formats/level_curves.h"
#include "tracks/text_cue.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr int kTimescale = 1000; ///< ticks per second, if the document has none
constexpr auto kMostCells
    = static_cast<std::size_t>(kMaxGridSide) * static_cast<std::size_t>(kMaxGridSide);

class Reader
{
public:
  tl::expected<Track, FormatError> operator()(const JsonDocument &document,
                                              std::vector<std::string> &ignored)
  {
    const JsonMembers root = document.root(error_);
    Track track = read(root);
    if (has_unread_frequency_)
      ignored.emplace_back("frequencies below 0 Hz, above 1000 Hz or out of order");
    if (curves_.has_lost_frequency())
      ignored.emplace_back("a frequency for each cell, as a map has one");
    if (root.has("description"))
      track.set_rate(description_rate(root));
    return std::move(error_).unless_set(std::move(track));
  }

private:
  Track read(const JsonMembers &root)
  {
    const double timescale = root.number("timescale", kTimescale);
    if (!(timescale >= 1 && timescale <= 48'000))
      root.fail("expected a timescale from 1 to 48000");
    curves_ = LevelCurves(timescale, 1);
    if (const std::size_t count = root.size("perceptions"); count != 1) {
      root.fail("expected one perception, got " + std::to_string(count));
      return Track();
    }
    const JsonMembers perception = root.element("perceptions", 0);
    if (perception.text("perception_modality") != "Vibrotactile")
      perception.fail("expected the modality Vibrotactile");
    const std::size_t channels = perception.size("channels");
    if (channels < 1 || channels > kMostCells) {
      perception.fail("expected 1 to " + std::to_string(kMostCells) + " channels");
      return Track();
    }
    find_grid(perception, channels);
    for (std::size_t i = 0; i < channels && !error_; i++)
      read_channel(perception.element("channels", i), i);
    if (error_)
      return Track();
    auto track = curves_.join(Track(grid_.rows, grid_.columns), cells_);
    if (!track)
      error_.set(std::move(track.error()).within("document"));
    return track.value_or(Track());
  }

  /// 0 if the description has no "rate=".
  static double description_rate(const JsonMembers &root)
  {
    const char *words = root.find_text("description");
    const tl::expected<GridHeader, FormatError> header = read_grid(words ? words : "", 1);
    return header ? header->rate : 0;
  }

  void find_grid(const JsonMembers &perception, std::size_t channels)
  {
    const JsonMembers first = perception.element("channels", 0);
    has_places_ = first.has("actuator_resolution") && first.has("actuator_target");
    if (has_places_) {
      const JsonMembers size = first.object("actuator_resolution");
      grid_ = { size.integer("Y", 1, kMaxGridSide), size.integer("X", 1, kMaxGridSide) };
      if (size.has("Z") && size.integer("Z", 0, 1) > 1)
        size.fail("expected tactors in one plane");
    } else if (channels <= static_cast<std::size_t>(kMaxGridSide)) {
      grid_ = { 1, static_cast<int>(channels) };
    } else {
      perception.fail("channels without actuator_resolution and actuator_target: at most 64");
    }
    cells_.resize(channels);
  }

  void read_channel(const JsonMembers &channel, std::size_t index)
  {
    if (has_places_)
      for (std::size_t i = 0; i < channel.size("actuator_target") && !error_; i++) {
        const JsonMembers place = channel.element("actuator_target", i);
        const int column = place.integer("X", 0, grid_.columns - 1);
        const int row = grid_.rows - 1 - place.integer("Y", 0, grid_.rows - 1);
        cells_[index].push_back(static_cast<std::size_t>(row * grid_.columns + column));
        if (++targets_ > kMostCells)
          channel.fail("expected at most " + std::to_string(kMostCells) + " targets in all");
      }
    else
      cells_[index].push_back(index);
    const double gain = channel.number("gain", 1);
    for (std::size_t b = 0; b < channel.size("bands") && !error_; b++) {
      const JsonMembers band = channel.element("bands", b);
      const std::string type = band.text("band_type");
      // The reference encoder always writes a band of transients, even an empty one.
      if (type == "Transient" && is_empty(band))
        continue;
      if (type != "Curve" && type != "VectorialWave")
        band.fail("bands of type " + type + " cannot be a track; only Curve and VectorialWave");
      for (std::size_t e = 0; !error_ && e < band.size("effects"); e++)
        read_effect(band.element("effects", e), index, gain, type == "VectorialWave");
    }
  }

  static bool is_empty(const JsonMembers &band)
  {
    for (std::size_t e = 0; e < band.size("effects"); e++) {
      const JsonMembers effect = band.element("effects", e);
      if (is_reference(effect) || effect.size("keyframes") > 0)
        return false;
    }
    return true;
  }

  static bool is_reference(const JsonMembers &effect)
  {
    return effect.has("effect_type") && effect.text("effect_type") != "Basis";
  }

  void read_effect(const JsonMembers &effect, std::size_t channel, double gain, bool is_wave)
  {
    if (is_reference(effect))
      effect.fail("only effects of type Basis can be a track");
    const double position = effect.number("position", 0);
    std::vector<LevelCurves::Point> points;
    std::vector<LevelCurves::Point> frequencies;
    const std::size_t count = effect.size("keyframes");
    for (std::size_t k = 0; k < count && !error_; k++) {
      const JsonMembers keyframe = effect.element("keyframes", k);
      const double at = position + keyframe.number("relative_position", 0);
      if (!(at >= 0 && at <= curves_.latest()) || at != std::floor(at))
        keyframe.fail("expected a whole position within 100 hours");
      if (!error_ && is_wave && keyframe.has("frequency_modulation"))
        add_frequency(static_cast<std::int64_t>(at), keyframe.number("frequency_modulation"),
                      frequencies);
      // A keyframe of a wave may set its frequency only.
      if (error_ || !keyframe.has("amplitude_modulation"))
        continue;
      if (!points.empty() && static_cast<double>(points.back().position) > at)
        keyframe.fail("the position is before that of the keyframe before");
      points.push_back({ static_cast<std::int64_t>(at),
                         std::min(std::abs(keyframe.number("amplitude_modulation") * gain), 1.0) });
    }
    if (error_)
      return;
    if (auto added = curves_.add(channel, points); !added)
      effect.fail(added.error().reason);
    for (std::size_t i = 1; i < frequencies.size() && !error_; i++)
      if (auto set = curves_.set_frequency(frequencies[i - 1], frequencies[i]); !set)
        effect.fail(set.error().reason);
  }

  /// Bounds a frequency; one before the one before it is left out.
  void add_frequency(std::int64_t at, double frequency, std::vector<LevelCurves::Point> &to)
  {
    const double bounded = std::clamp(frequency, 0.0, static_cast<double>(kHighestFrequency));
    const bool has_order = to.empty() || to.back().position <= at;
    has_unread_frequency_ |= bounded != frequency || !has_order;
    if (has_order)
      to.push_back({ at, bounded });
  }

  Grid grid_;
  bool has_places_ = false;
  std::vector<std::vector<std::size_t>> cells_; ///< per channel
  std::size_t targets_ = 0;                     ///< in cells_
  LevelCurves curves_{ kTimescale, 1 };
  bool has_unread_frequency_ = false;
  FirstError error_;
};

} // namespace

tl::expected<Track, FormatError>
read_hjif(std::string_view text, std::vector<std::string> &ignored)
{
  return JsonDocument::parse(text).and_then(
      [&](const JsonDocument &document) { return Reader()(document, ignored); });
}

} // namespace tactile
