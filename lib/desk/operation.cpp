// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/operation.h"

#include "tracks/track_edit.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>

namespace desk {

namespace {

using tactile::Time;
using tactile::Track;
using Edited = tl::expected<Track, tactile::FormatError>;
using std::chrono::milliseconds;

Time
seconds(double value)
{
  return Time(std::llround(value * 1e9));
}

/// The cells and the time of a change.
struct Part
{
  Time begin;
  Time end;
  const std::vector<int> &cells;
};

Track
silent_like(const Track &track)
{
  Track silent(track.rows(), track.columns());
  (void)silent.set_end(track.end());
  return silent;
}

Edited
moved(const Track &track, const Part &part, Time by)
{
  return shift(track, by).and_then([&](const Track &shifted) {
    return replace(track, silent_like(track), part.begin, part.end, part.cells)
        .and_then([&](const Track &rest) {
          return replace(rest, shifted, part.begin + by, part.end + by, part.cells);
        });
  });
}

/// The value that an operation takes.
struct Known
{
  std::string_view name;
  double least = 0; ///< of the value; none if `most` is not above
  double most = 0;
  Edited (*run)(const Track &, const Track *draft, const Operation &, const Part &);
};

constexpr double kLongest = 360'000; ///< s

constexpr std::array kOperations = {
  Known{ "prune-shorter", 0, kLongest,
         [](const Track &track, const Track *, const Operation &operation, const Part &) {
           return Edited(prune_short(track, seconds(operation.value)));
         } },
  Known{ "prune-weaker", 0, 100,
         [](const Track &track, const Track *, const Operation &operation, const Part &) {
           return Edited(prune_weak(track, static_cast<float>(operation.value / 100)));
         } },
  Known{ "merge", 0, 100,
         [](const Track &track, const Track *, const Operation &operation, const Part &) {
           return Edited(merge_equal(track, static_cast<float>(operation.value / 100)));
         } },
  Known{ "limit", 0, kLongest,
         [](const Track &track, const Track *, const Operation &operation, const Part &) {
           return limit_events(track, { .max_duration = seconds(operation.value),
                                        .refractory = seconds(operation.second) });
         } },
  Known{ "shift", -kLongest, kLongest,
         [](const Track &track, const Track *, const Operation &operation, const Part &part) {
           return moved(track, part, seconds(operation.value));
         } },
  Known{ "scale", 0, 100,
         [](const Track &track, const Track *, const Operation &operation, const Part &) {
           return Edited(scale(track, static_cast<float>(operation.value)));
         } },
  Known{ "silence", 0, 0,
         [](const Track &track, const Track *, const Operation &, const Part &) {
           return Edited(silent_like(track));
         } },
  Known{ "quantize", 1, 1000,
         [](const Track &track, const Track *, const Operation &operation, const Part &) {
           return Edited(quantize(track, static_cast<int>(operation.value)));
         } },
  Known{ "draft", 0, 0,
         [](const Track &track, const Track *draft, const Operation &, const Part &) {
           return resample(*draft, track.rows(), track.columns());
         } },
  Known{ "draft-max", 0, 0,
         [](const Track &track, const Track *draft, const Operation &, const Part &) {
           return overlay(track, *draft, tactile::Mix::max);
         } },
  Known{ "draft-replace", 0, 0,
         [](const Track &track, const Track *draft, const Operation &, const Part &) {
           return overlay(track, *draft, tactile::Mix::replace);
         } },
};

tl::expected<const Known *, std::string>
known(const Operation &operation, const Track *draft)
{
  const auto *const found = std::ranges::find(kOperations, operation.name, &Known::name);
  if (found == kOperations.end()) {
    std::string names;
    for (const Known &one : kOperations)
      names += (names.empty() ? "" : ", ") + std::string(one.name);
    return tl::unexpected("expected an operation of " + names);
  }
  const auto fits = [&](double value) {
    return value >= found->least && value <= found->most;
  };
  if (found->least < found->most
      && !(fits(operation.value) && (operation.second == 0 || fits(operation.second))))
    return tl::unexpected(operation.name + ": expected a value from "
                          + std::to_string(std::lround(found->least)) + " to "
                          + std::to_string(std::lround(found->most)));
  if (found->name.starts_with("draft") && draft == nullptr)
    return tl::unexpected(std::string("there is no draft yet; wait for it, or author one"));
  return found;
}

/// Collects splices in one pass over the cues.
class Splicer
{
public:
  void keep()
  {
    at_++;
    is_open_ = false;
  }
  void remove()
  {
    open().remove++;
  }
  void insert(Cue cue)
  {
    open().insert.push_back(std::move(cue));
    at_++;
  }
  std::vector<Splice> finish() &&
  {
    return std::move(splices_);
  }

private:
  Splice &open()
  {
    if (!is_open_)
      splices_.push_back({ .at = at_, .remove = 0, .insert = {} });
    is_open_ = true;
    return splices_.back();
  }

  std::size_t at_ = 0; ///< in the new cues
  bool is_open_ = false;
  std::vector<Splice> splices_;
};

} // namespace

std::vector<Splice>
splices_to(const Document &document, const Track &track)
{
  const std::vector<Cue> &before = document.cues();
  const std::vector<Cue> after = cues_of(track, before);
  Splicer splicer;
  auto old = before.begin();
  for (const Cue &cue : after) {
    for (; old != before.end() && old->start <= cue.start && *old != cue; ++old)
      splicer.remove();
    if (old != before.end() && *old == cue) {
      ++old;
      splicer.keep();
    } else {
      splicer.insert(cue);
    }
  }
  for (; old != before.end(); ++old)
    splicer.remove();
  return std::move(splicer).finish();
}

tl::expected<std::vector<Splice>, std::string>
operate(const Document &document, const Track *draft, const Operation &operation)
{
  const auto found = known(operation, draft);
  if (!found)
    return tl::unexpected(found.error());
  const Track track = document.track();
  const Selection &selection = operation.selection;
  const Time longest = std::max(track.end(), draft ? draft->end() : Time(0));
  const Part part{ .begin = milliseconds(selection.from.value_or(0)),
                   .end = selection.to ? Time(milliseconds(*selection.to)) : longest,
                   .cells = selection.cells };
  Edited edited = (*found)->run(track, draft, operation, part);
  if (edited && operation.name != "shift")
    edited = replace(track, *edited, part.begin, part.end, part.cells);
  if (!edited)
    return tl::unexpected(operation.name + ": " + edited.error().text());
  return splices_to(document, *edited);
}

} // namespace desk
