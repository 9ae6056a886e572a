// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes what Kodi says at its JSON-RPC, in pieces of any length, and what is made of it.
#include "follow/players/json_stream.h"
#include "follow/players/kodi_conversation.h"
#include "follow/position_estimator.h"
#include "fuzz.h"

#include <string_view>

using namespace follow;

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const std::string_view bytes(reinterpret_cast<const char *>(data), size);
  constexpr std::size_t kPiece = 100;
  JsonStream objects;
  KodiConversation talk;
  PositionEstimator estimator;
  Time now{ 0 };
  talk.begin(now);
  for (std::size_t at = 0; at < size; at += kPiece) {
    if (!objects.add(bytes.substr(at, kPiece)))
      return 0;
    while (const auto object = objects.next()) {
      now += std::chrono::milliseconds(10);
      KodiConversation::is_pong(*object);
      const auto [report, questions] = talk.received(*object, now);
      expect(questions.size() < 1000 && talk.ask(now).size() < 1000);
      if (!report)
        continue;
      expect(report->received == now && report->film.size() <= 4096);
      expect(!report->position
             || (*report->position >= Time(0)
                 && *report->position <= PositionEstimator::kLongestFilm));
      expect(!report->asked || *report->asked <= now);
      estimator.report(*report);
      if (const auto estimate = estimator.at(now + std::chrono::milliseconds(5)))
        expect(estimate->rate >= 0 && estimate->rate <= PositionEstimator::kMostRate
               && estimate->error >= Time(0));
    }
  }
  return 0;
}
