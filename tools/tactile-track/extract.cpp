// SPDX-License-Identifier: LGPL-2.1-or-later
//
// extract: the track of a film's file.
#include "commands.h"

#include "film/film.h"
#include "tracks/formats/track_file.h"
#include "translation.h"
#include "visuotactile-follow/map_source.h"

#include <gst/gst.h>

namespace {

/// Transport streams count in 90 000 Hz.
tactile::Time
rounded(tactile::Time time)
{
  constexpr tactile::Time kTick = std::chrono::microseconds(100);
  return (time + kTick / 2) / kTick * kTick;
}

/// Cues come one after the other, with silence between them.
class Extracted
{
public:
  void add(const tactile::Cue &cue)
  {
    if (!track_)
      track_.emplace(cue.map.rows, cue.map.columns);
    const tactile::Time begin = rounded(cue.begin);
    if (begin > end_ + tactile::CueBuilder::kSeam)
      or_throw(track_->append(end_, tactile::TactileMap(cue.map.rows, cue.map.columns)));
    or_throw(track_->append(begin, cue.map));
    end_ = std::max(end_, rounded(cue.end));
  }

  std::optional<tactile::Track> track()
  {
    if (track_)
      or_throw(track_->set_end(end_));
    return track_;
  }

private:
  std::optional<tactile::Track> track_;
  tactile::Time end_{ 0 };
};

} // namespace

int
extract(int argc, char **argv)
{
  TextOption output;
  CommonOptions common;
  const GOptionEntry entries[]
      = { { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
            N_("The track to write or replace; its name selects the format"), "TRACK" },
          {} };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM -o TRACK",
        .summary = N_("Copies the track of a film's file to TRACK: text cues in subtitles, also "
                      "WebVTT, or\nKLV. The film's file does not change."),
        .least = 1,
        .most = 1 });
  if (!output.is_set())
    throw UsageError(_("expected -o TRACK"));
  or_throw(tactile::written_format(output.text()));
  gst_init(nullptr, nullptr);
  const std::string path = film_path(names[0]);
  refuse_same_file(path, output.text());
  const std::unique_ptr<follow::MapSource> source
      = open_embedded(path, discover_film(path).start.stream);
  Extracted extracted;
  while (!source->is_ended()) {
    if (const std::optional<tactile::Cue> cue = source->take())
      extracted.add(*cue);
    else if (source->failure().empty())
      g_usleep(1000);
    else
      break;
  }
  if (const std::string failure = source->failure(); !failure.empty())
    throw std::runtime_error(in_text("cannot read '{}': {}", path, failure));
  const std::optional<tactile::Track> track = extracted.track();
  if (!track)
    throw std::runtime_error(
        in_text("'{}' carries no track; expected subtitles that are text cues, or KLV", path));
  write_track_file(*track, output.text());
  return 0;
}
