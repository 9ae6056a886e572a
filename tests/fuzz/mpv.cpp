// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes what mpv says at its socket, in pieces of any length, and what is made of it.
#include "follow/players/line_buffer.h"
#include "follow/players/mpv_conversation.h"
#include "follow/position_estimator.h"
#include "fuzz.h"

#include <string_view>

using namespace follow;

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const std::string_view bytes(reinterpret_cast<const char *>(data), size);
  constexpr std::size_t kPiece = 100;
  LineBuffer lines;
  MpvConversation talk;
  PositionEstimator estimator;
  Time now{ 0 };
  for (std::size_t at = 0; at < size; at += kPiece) {
    if (!lines.add(bytes.substr(at, kPiece)))
      return 0;
    while (const auto line = lines.next()) {
      now += std::chrono::milliseconds(10);
      const auto report = talk.received(*line, now);
      if (!report)
        continue;
      expect(report->received == now && report->film.size() <= 9000);
      expect(!report->position
             || (*report->position >= Time(0)
                 && *report->position <= PositionEstimator::kLongestFilm));
      estimator.report(*report);
      if (const auto estimate = estimator.at(now + std::chrono::milliseconds(5)))
        expect(estimate->rate >= 0 && estimate->rate <= PositionEstimator::kMostRate
               && estimate->error >= Time(0));
    }
  }
  return 0;
}
