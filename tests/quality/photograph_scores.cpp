// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Prints how well each model tells where people look on photographs, as a Markdown table.
// Usage: photograph_scores DIRECTORY (of OSIE's pictures and fixations.csv)
#include "peers.h"
#include "photographs.h"

#include <gst/gst.h>

#include <cstdio>
#include <exception>

int
main(int argc, char **argv)
{
  gst_init(&argc, &argv);
  if (argc != 2) {
    std::fprintf(stderr, "usage: photograph_scores DIRECTORY\n");
    return 2;
  }
  try {
    const auto rows = quality::score_photographs(argv[1]);
    std::printf("| model | split | pictures | NSS | AUC-Judd | shuffled AUC | CC |\n"
                "|---|---|---|---|---|---|---|\n");
    for (const auto &row : rows)
      std::printf("| %s | %s | %d | %.3f | %.3f | %.3f | %.3f |\n", row.model.c_str(),
                  row.split.c_str(), row.pictures, row.scores.nss, row.scores.auc_judd,
                  row.scores.shuffled_auc, row.scores.cc);
    for (const auto peer : quality::kPeers)
      if (!quality::is_available(peer))
        std::printf("(%s left out: tools/setup.sh quality, then configure again)\n",
                    quality::name(peer));
  } catch (const std::exception &error) {
    std::fprintf(stderr, "photograph_scores: %s\n", error.what());
    return 1;
  }
  return 0;
}
