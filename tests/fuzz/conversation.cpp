// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes what servers of vests and of Intiface's devices send: the conversation takes any messages,
// one a line, keeps its limits and terminates. `TALK` is the conversation.
#include "fuzz.h"
#include "tactor/drivers/websocket/bhaptics_conversation.h"
#include "tactor/drivers/websocket/buttplug_conversation.h"

#include <string_view>
#include <vector>

using namespace tactor;
using State = Conversation::State;

namespace {

[[maybe_unused]] BhapticsConversation
bhaptics_talk()
{
  return { "server", suit_parts().at(2) };
}

[[maybe_unused]] ButtplugConversation
buttplug_talk()
{
  return { "server", "Test Vibrator" };
}

/// Sends all there is. Levels change meanwhile.
void
turn(Conversation &talk, Time now)
{
  static double level = 0;
  level = level > 0.9 ? 0 : level + 0.3;
  talk.set_levels(std::vector(64, level));
  int messages = 0;
  while (const std::optional<std::string> text = talk.next(now)) {
    expect(text->size() < 32'768 && (text->front() == '[' || text->front() == '{'));
    expect(++messages <= 4);
  }
  const std::optional<Time> deadline = talk.deadline();
  expect(!deadline || *deadline > now);
  expect(talk.take_warnings().size() <= Conversation::kMostWarnings);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  std::string_view rest(reinterpret_cast<const char *>(data), size);
  auto talk = TALK();
  Time now{ 0 };
  talk.begin(now);
  turn(talk, now);
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    talk.received(rest.substr(0, end), now);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    now += std::chrono::milliseconds(60);
    turn(talk, now);
    if (talk.state() == State::failed)
      expect(!talk.failure().text.empty() && talk.failure().text.size() < 16'384);
    if (talk.state() == State::playing) {
      const ServedDevice device = talk.device();
      expect(device.tactors >= 1 && device.tactors <= 64 && device.step > 0 && device.step <= 1);
      expect(device.layout.tactors() == device.tactors);
    }
  }
  // Without an answer it ends by its deadlines.
  talk.close(now);
  turn(talk, now);
  for (int i = 0; talk.state() != State::closed; i++) {
    expect(i < 2 && talk.deadline().has_value());
    now = *talk.deadline();
    turn(talk, now);
  }
  return 0;
}
