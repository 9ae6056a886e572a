// SPDX-License-Identifier: LGPL-2.1-or-later
/// Raw I420 film → its saliency maps and tactile maps, as bytes: the same on every machine.
/// Usage: maps PROFILE WIDTH HEIGHT <FILM >MAPS
/// Plays 30 frames a second on 3 x 3 tactors; prints the levels on standard error, a frame a line.
#include "saliency/analyzer.h"
#include "tactile/tactile_mapping.h"

#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

int
main(int argc, char **argv)
{
  if (argc != 4)
    return 2;
  const bool paper = std::string_view(argv[1]) == "paper";
  const int width = std::atoi(argv[2]);
  const int height = std::atoi(argv[3]);
  const int half_width = (width + 1) / 2;
  const int half_height = (height + 1) / 2;

  saliency::Analyzer analyzer(paper ? saliency::Profile::paper() : saliency::Profile::tuned());
  const tactile::MappingSettings settings
      = paper ? tactile::MappingSettings::paper() : tactile::MappingSettings::tuned();
  tactile::TactileMap map(3, 3);
  const std::size_t luma = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::size_t chroma
      = static_cast<std::size_t>(half_width) * static_cast<std::size_t>(half_height);
  std::vector<std::uint8_t> frame(luma + 2 * chroma);
  saliency::FrameView view{ .width = width, .height = height, .matrix = saliency::kBt601 };
  view.components = { saliency::Component{ frame.data(), width, 1, width, height },
                      { frame.data() + luma, half_width, 1, half_width, half_height },
                      { frame.data() + luma + chroma, half_width, 1, half_width, half_height } };

  constexpr saliency::Time kPeriod(1'000'000'000 / 30);
  for (int i = 0; std::fread(frame.data(), frame.size(), 1, stdin) == 1; i++) {
    const saliency::Saliency &found = analyzer.analyze(view, i * kPeriod, kPeriod, true);
    for (int y = 0; y < found.map.rows; y++)
      std::fwrite(found.map.ptr(y), sizeof(float), static_cast<std::size_t>(found.map.cols),
                  stdout);
    tactile::map_saliency({ .values = found.map.ptr<float>(),
                            .width = found.map.cols,
                            .height = found.map.rows,
                            .stride = static_cast<std::ptrdiff_t>(found.map.step1()),
                            .horizontal = { found.picture.x, found.picture.width },
                            .vertical = { found.picture.y, found.picture.height } },
                          settings, map);
    for (const float level : map.levels)
      std::fprintf(stderr, "%a ", static_cast<double>(level));
    std::fwrite(map.levels.data(), sizeof(float), map.levels.size(), stdout);
    std::fputc('\n', stderr);
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
