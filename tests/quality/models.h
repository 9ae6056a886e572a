// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "films.h"
#include "peers.h"
#include "tactile/tactile_map.h"

#include <memory>
#include <string>
#include <utility>

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

  /// Whether the camera counts as moving.
  virtual bool camera_moves() const
  {
    return false;
  }

private:
  std::string name_;
};

/// This project's models.
std::unique_ptr<Model> paper_model();
std::unique_ptr<Model> tuned_model();

/// A peer's map with what is decided by this project's means: half of the maximum as the threshold,
/// values kept, pooled by exact area. With `weighted`, it is multiplied by colour rarity before.
/// It never decides that nothing happens, unless its map is 0. Throws std::runtime_error if the peer
/// is not available.
std::unique_ptr<Model> peer_model(Peer peer, bool weighted);

} // namespace quality
