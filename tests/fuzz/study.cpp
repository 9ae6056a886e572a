// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes study files, and the journals of participants: a file that is read has orders and steps,
// and each step of a participant takes what it says.
#include "fuzz.h"
#include "study/page.h"
#include "study/participant.h"

#include <algorithm>
#include <string>
#include <vector>

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const std::string text(reinterpret_cast<const char *>(data), size);
  static const std::string kStudy = study::paper_study("a.mkv");
  if (const auto study = study::read_study(text)) {
    const auto square = study->square();
    expect(square.size() >= study->conditions().size() && !study->groups().empty());
    const auto participant
        = study::Participant::read("P01", text, { study::Participant::start({}, "1").line() });
    expect(participant && (*participant)->steps().size() >= 3);
    expect(!study::page_state(*study, participant->get(), study::Phase::ready).empty());
  } else {
    expect(!study.error().empty());
  }
  // Lines of a journal.
  std::vector<std::string> lines{ study::Participant::start({}, "1").line() };
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    const auto participant = study::Participant::read("P01", kStudy, lines);
    if (!participant) {
      expect(!participant.error().empty());
      lines.pop_back();
      continue;
    }
    const study::Step &step = (*participant)->step();
    expect((*participant)->answers().size() <= (*participant)->steps_done());
    (*participant)->answer(step.name, text, 1);
    for (int session = 0; session <= (*participant)->sessions(); session++)
      (*participant)->marks(session);
  }
  return 0;
}
