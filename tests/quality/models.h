// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "films.h"
#include "frame/front_end.h"
#include "peers.h"
#include "people/people.h"
#include "saliency/analyzer.h"
#include "saliency/rarity.h"
#include "tactile/tactile_map.h"
#include "tactile/tactile_mapping.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace quality {

/// A method that turns frames into tactile maps.
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

  /// Whether the camera counts as moving.
  virtual bool camera_moves() const
  {
    return false;
  }

private:
  std::string name_;
};

/// A view of the map for map_saliency().
tactile::SaliencyView view_of(const saliency::Saliency &found);

/// Whether the detector of faces works; prints why not.
bool finds_people();

/// This project's analyzer and mapping.
class AnalyzerModel : public Model
{
public:
  /// `with_people`: as by default, where finds_people().
  AnalyzerModel(std::string name, const saliency::Profile &profile,
                const tactile::MappingSettings &mapping, bool with_people = false);

  void frame(const Frame &frame, Time time, Time duration, tactile::TactileMap &map) override
  {
    camera_moves_ = this->frame(frame.view(), time, duration, map).camera_moves;
  }

  /// The same for any frame. Returns the saliency, valid until the next call.
  const saliency::Saliency &frame(const saliency::FrameView &frame, Time time, Time duration,
                                  tactile::TactileMap &map);

  /// The saliency of the next frame for map_saliency(), valid until the next call.
  tactile::SaliencyView look(const saliency::FrameView &frame, Time time, Time duration);

  /// The saliency of the last frame, raised where people are.
  const saliency::Saliency &found() const
  {
    return found_;
  }

  bool camera_moves() const override
  {
    return camera_moves_;
  }

private:
  saliency::Analyzer analyzer_;
  std::optional<people::People> people_;
  saliency::Saliency found_;
  tactile::MappingSettings mapping_;
  bool camera_moves_ = false;
};

std::unique_ptr<AnalyzerModel> paper_model();
std::unique_ptr<AnalyzerModel> tuned_model();

/// Caches a peer's saliency maps for the models that share them. Not thread-safe.
class PeerMaps
{
public:
  /// Throws std::runtime_error if the peer is not available.
  explicit PeerMaps(Peer peer) : peer_(peer), saliency_(peer)
  {
  }

  Peer peer() const
  {
    return peer_;
  }

  /// The map of the frame at `time`, computed once. A smaller time starts another film.
  const cv::Mat &of(const Frame &frame, Time time);

private:
  Peer peer_;
  PeerSaliency saliency_;
  std::optional<Time> time_;
  cv::Mat map_;
};

/// What would be felt of a peer's map: pooled by exact area, cells below half of the strongest
/// silent, no floor, no gain. Silent only if the map is 0.
void map_peer(const cv::Mat &saliency, tactile::TactileMap &map);

/// Caches color rarity, with which peers' maps are weighted, for the models that share it. Not
/// thread-safe.
class RarityMaps
{
public:
  /// The rarity of the frame at `time`, computed once, at `level`.
  const cv::Mat &of(const Frame &frame, Time time, int level);

private:
  saliency::FrontEnd front_end_;
  saliency::Rarity rarity_;
  std::optional<Time> time_;
  cv::Mat map_;
};

/// A peer with that mapping. Its maps are multiplied by the rarity first, if there is one.
std::unique_ptr<Model> peer_model(std::shared_ptr<PeerMaps> maps,
                                  std::shared_ptr<RarityMaps> rarity = nullptr);

} // namespace quality
