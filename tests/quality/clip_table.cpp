// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clip_table.h"

#include "clips.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

namespace quality {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What a method does on a set of films, over the spans of their labels.
struct ClipUnits
{
  std::vector<Mean> right;
  std::vector<Mean> place;
  std::vector<Mean> found;
  std::vector<Mean> quiet;
  std::array<std::vector<double>, 4> levels; ///< by strength
  Mean felt;                                 ///< frames
  Mean full;                                 ///< of the felt ones
  double longest = 0;

  void add(const ClipRow &row)
  {
    const auto append = [](auto &all, const auto &some) {
      all.insert(all.end(), some.begin(), some.end());
    };
    append(right, row.labels->right);
    append(place, row.labels->place);
    append(found, row.labels->found);
    append(quiet, row.labels->quiet);
    for (std::size_t i = 0; i < levels.size(); ++i)
      append(levels[i], row.labels->levels[i]);
    const double active = row.scores.active * row.scores.frames;
    felt.add({ active, static_cast<double>(row.scores.frames) });
    full.add({ row.labels->full * active, active });
    longest = std::max(longest, row.scores.longest);
  }

  std::vector<Mean> strong() const
  {
    return above(levels[3], levels[1]);
  }
};

using UnitsByMethod = std::vector<std::pair<std::string, ClipUnits>>;

/// Of the films with labels, in the order in which the methods first appear.
UnitsByMethod
units_of(const std::vector<ClipRow> &rows, bool unseen)
{
  UnitsByMethod all;
  for (const ClipRow &row : rows) {
    if (!row.labels || row.unseen != unseen)
      continue;
    auto known = std::ranges::find(all, row.model, &UnitsByMethod::value_type::first);
    if (known == all.end())
      known = all.insert(known, { row.model, {} });
    known->second.add(row);
  }
  return all;
}

/// Whether a row is on the page: ours at its default, and what it is compared with.
bool
is_compared(const std::string &model)
{
  return model == model_at(1) || model == kWithoutPeople || model == kFitted
         || !model.starts_with("tuned");
}

/// A figure of the summary; `ours` is the method that is judged as ours.
template <typename Units>
void
summarize(const UnitsByMethod &all, const char *set, const char *figure, const Units &units,
          Summary &summary, bool higher = true, const std::string &ours = model_at(1))
{
  UnitsByModel by_model;
  for (const auto &[model, found] : all)
    if (model == ours)
      by_model[model_at(1)] = units(found);
    else if (!model.starts_with("tuned"))
      by_model[model] = units(found);
  if (!by_model.contains(model_at(1)))
    return;
  summary.push_back(summary_row(set, figure, by_model));
  summary.back().higher = higher;
}

void
add_set(const UnitsByMethod &all, const char *set, Table &table)
{
  for (const auto &[model, units] : all)
    if (is_compared(model))
      table.add({ set, model, percent(units.felt.value()), percent_text(estimate(units.right)),
                  text(estimate(units.place), 2), percent_text(estimate(units.found)),
                  percent_text(estimate(units.quiet)), percent_text(estimate(units.strong())),
                  percent(units.full.value()), figure(units.longest, 1) });
}

} // namespace

Section
clip_section(const Extent &extent, Summary &summary)
{
  auto rows = score_clips(extent.clips, extent.quick ? Contenders::ours : Contenders::all,
                          extent.threads);
  std::ranges::move(fitted_elsewhere(rows), std::back_inserter(rows));
  Table table(
      "Real films",
      "Felt: share of the frames. Precision, recall, quiet time felt and strength are those "
      "of tests/quality/labels. Above chance: how much better than in any order the "
      "strongest cells are right, 1 if always. Full: share of the felt frames with a "
      "level above 0.9. Same share: only its strongest frames, as many as tuned has.",
      { "films", "method", "felt", "precision", "above chance", "recall", "quiet felt",
        "blow above gesture", "full", "longest, s" });
  for (const auto &[set, unseen] : { std::pair{ "unseen films", true }, { "real films", false } }) {
    const UnitsByMethod all = units_of(rows, unseen);
    if (all.empty())
      continue;
    summarize(
        all, set, "precision against labels", [](auto &u) { return u.right; }, summary);
    summarize(
        all, set, "place, above chance", [](auto &u) { return u.place; }, summary);
    summary.back().share = false;
    summarize(
        all, set, "recall against labels", [](auto &u) { return u.found; }, summary);
    summarize(
        all, set, "quiet time felt", [](auto &u) { return u.quiet; }, summary, false);
    summarize(
        all, set, "a blow feels stronger than a gesture", [](auto &u) { return u.strong(); },
        summary);
    if (!unseen) {
      summarize(
          all, set, "precision, fitted on the other films", [](auto &u) { return u.right; },
          summary, true, kFitted);
      summarize(
          all, set, "recall, fitted on the other films", [](auto &u) { return u.found; }, summary,
          true, kFitted);
    }
    add_set(all, set, table);
  }
  Table every("Real films", "",
              { "clip", "method", "frames", "felt", "tactors felt", "at a time", "longest, s",
                "longest of a tactor, s", "cues a minute", "camera moves", "cuts", "precision",
                "above chance", "recall", "quiet felt", "full" });
  for (const ClipRow &row : rows) {
    const ClipScores &s = row.scores;
    const std::optional<LabelScores> &labels = row.labels;
    Mean place;
    if (labels)
      for (const Mean &span : labels->place)
        place.add(span);
    every.add({ row.clip, row.model, std::to_string(s.frames), percent(s.active),
                percent(s.tactors), figure(s.tactors_active, 2), figure(s.longest, 1),
                figure(s.longest_tactor, 1), figure(s.cues_per_minute, 0), percent(s.camera_moves),
                std::to_string(s.cuts), figure(labels ? labels->precision : kNone, 2),
                figure(place.value(), 2), figure(labels ? labels->recall : kNone, 2),
                percent(labels ? labels->quiet_felt : kNone),
                percent(labels ? labels->full : kNone) });
  }
  return { table, every };
}

} // namespace quality
