// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/simulation.h"

#include "random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace study {

namespace {

using visuotactile::Random;

double
normal(Random &random)
{
  const double radius = std::sqrt(-2 * std::log(random.uniform(0x1p-53, 1)));
  return radius * std::cos(2 * std::numbers::pi * random.uniform(0, 1));
}

/// From −0.5, the factor's first level, to 0.5, the last.
double
position(const Participant &participant, int session, const std::string &name)
{
  const std::vector<Factor> &factors = participant.study().factors;
  const auto factor
      = name.empty() ? factors.begin() : std::ranges::find(factors, name, &Factor::name);
  if (factor == factors.end())
    return 0;
  const Settings &levels = factor->between || session < 1 ? participant.group().levels
                                                          : participant.condition(session).levels;
  const auto chosen = levels.find(factor->name);
  if (chosen == levels.end())
    return 0;
  const auto level = std::ranges::find(factor->levels, chosen->second, &Level::name);
  return static_cast<double>(level - factor->levels.begin())
             / static_cast<double>(factor->levels.size() - 1)
         - 0.5;
}

std::string
answer_of(const Question &question, double deviation)
{
  if (question.kind == Question::Kind::text)
    return "A simulated answer.";
  const bool is_slider = question.kind == Question::Kind::slider;
  const double low = is_slider ? question.low : 1;
  const double high = is_slider ? question.high : static_cast<double>(question.labels.size());
  const double step = is_slider ? question.step : 1;
  // The effect is in points of a scale of 100.
  const double wanted = (low + high) / 2 + deviation * (high - low) / 100;
  const double last = std::floor((high - low) / step + 1e-9); // step of the scale
  const double value = low + std::clamp(std::round((wanted - low) / step), 0.0, last) * step;
  return write_number(value);
}

} // namespace

tl::expected<void, std::string>
simulate_participant(Folder &folder, const Simulation &simulation)
{
  const auto started = folder.start("simulated");
  if (!started)
    return tl::unexpected(started.error());
  Participant &participant = **started;
  Random random(visuotactile::mix_bits(simulation.seed) + folder.participants().size());
  const double person = simulation.spread * normal(random);
  std::int64_t at = now();
  constexpr std::int64_t kStep = 3000; // ms
  constexpr std::int64_t kCommands = 600;
  constexpr std::int64_t kFrames = 1800;
  while (participant.state() == Participant::State::running) {
    const Step step = participant.step();
    at += step.kind == Step::Kind::rest ? participant.rest_left(at) : kStep;
    tl::expected<void, std::string> added;
    if (step.kind == Step::Kind::film) {
      const Settings settings = participant.settings(step.session);
      const auto film = settings.find("film");
      added = folder
                  .add(participant, Event("play", at)
                                        .add("step", step.name)
                                        .add("film", film == settings.end() ? "" : film->second)
                                        .add("program", std::string("simulated")))
                  .and_then([&] {
                    return folder.add(participant, Event("played", at)
                                                       .add("step", step.name)
                                                       .add("outcome", std::string("ended"))
                                                       .add("commands", kCommands)
                                                       .add("frames", kFrames));
                  });
    } else {
      const double deviation
          = person + simulation.effect * position(participant, step.session, simulation.factor)
            + simulation.spread * normal(random);
      const std::string answer = step.question ? answer_of(*step.question, deviation)
                                 : step.kind == Step::Kind::consent
                                     ? participant.study().consent_version
                                     : "";
      const auto event = participant.answer(step.name, answer, kStep, at);
      added = event ? folder.add(participant, *event) : tl::unexpected(event.error());
    }
    if (!added)
      return added;
  }
  return {};
}

} // namespace study
