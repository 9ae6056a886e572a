// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "films.h"
#include "saliency/analyzer.h"
#include "tactile/tactile_mapping.h"

#include <string>

namespace quality {

/// One way from frames to tactile maps.
class Model
{
public:
  explicit Model(std::string name) : name_(std::move(name))
  {
  }
  virtual ~Model() = default;
  Model(const Model &) = delete;
  Model &operator=(const Model &) = delete;

  const std::string &name() const
  {
    return name_;
  }

  /// The next frame of a film, shown during [time, time + duration).
  virtual void frame(const Frame &frame, Time time, Time duration, tactile::TactileMap &map) = 0;

private:
  std::string name_;
};

/// This project's.
class AnalyzerModel : public Model
{
public:
  AnalyzerModel(std::string name, const saliency::Profile &profile,
                const tactile::MappingSettings &mapping)
      : Model(std::move(name)), analyzer_(profile), mapping_(mapping)
  {
  }

  void frame(const Frame &frame, Time time, Time duration, tactile::TactileMap &map) override
  {
    this->frame(frame.view(), time, duration, map);
  }

  /// The same for any frame; returns what was found, valid until the next one.
  const saliency::Saliency &frame(const saliency::FrameView &frame, Time time, Time duration,
                                  tactile::TactileMap &map)
  {
    const auto &found = analyzer_.analyze(frame, time, duration);
    const tactile::SaliencyView view{ .values = found.map.ptr<float>(),
                                      .width = found.map.cols,
                                      .height = found.map.rows,
                                      .stride = static_cast<std::ptrdiff_t>(found.map.step1()),
                                      .horizontal = { found.picture.x, found.picture.width },
                                      .vertical = { found.picture.y, found.picture.height } };
    tactile::map_saliency(view, mapping_, map);
    return found;
  }

private:
  saliency::Analyzer analyzer_;
  tactile::MappingSettings mapping_;
};

} // namespace quality
