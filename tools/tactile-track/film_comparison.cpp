// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_contents.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace {

/// Matroska has milliseconds: a time and the shift may each be off by half of one.
constexpr double kTolerance = 0.002;

/// Programs leave chapters where they are when they move packets by a codec's delay.
constexpr double kChapterTolerance = 0.05;

std::string
text_of(double seconds)
{
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f s", seconds);
  return text.data();
}

/// "stream 2 (subtitle, ass, 'Deutsch')"
std::string
name_of(int index, const FilmStream &stream)
{
  std::string name = "stream " + std::to_string(index) + " (" + stream.kind;
  if (!stream.codec.empty())
    name += ", " + stream.codec;
  for (const char *fact : { "title", "filename" })
    if (const auto found = stream.facts.find(fact); found != stream.facts.end())
      name += ", '" + found->second + "'";
  return name + ")";
}

/// The one that is compared with a stream of the film, -1: none. Streams keep their order.
class Matches
{
public:
  Matches(const FilmContents &copy, int track) : copy_(copy)
  {
    taken_.insert(track);
  }

  int of(const FilmStream &stream)
  {
    for (int i = 0; i < static_cast<int>(copy_.streams.size()); i++) {
      const FilmStream &other = copy_.streams[static_cast<std::size_t>(i)];
      if (!taken_.contains(i) && other.kind == stream.kind
          && (other.codec == stream.codec || (other.is_text() && stream.is_text()))) {
        taken_.insert(i);
        return i;
      }
    }
    return -1;
  }

private:
  const FilmContents &copy_;
  std::set<int> taken_;
};

using Packets = std::vector<FilmStream::Packet>;

bool
is_timed(const Packets &packets)
{
  return std::ranges::none_of(packets, [](const auto &one) { return std::isnan(one.time); });
}

/// Most by which a time is off, of packets that have one in the film.
double
worst(const Packets &film, const Packets &copy, double shift)
{
  double most = 0;
  for (std::size_t i = 0; i < std::min(film.size(), copy.size()); i++)
    if (!std::isnan(film[i].time)) {
      const double off = std::abs(copy[i].time - film[i].time - shift);
      most = std::isnan(off) ? HUGE_VAL : std::max(most, off);
    }
  return most;
}

/// Where the film has no times, the copy has to have one for each packet, each another.
bool
has_good_times(const Packets &packets)
{
  std::set<double> times;
  return std::ranges::all_of(packets, [&](const auto &one) {
    return !std::isnan(one.time) && times.insert(one.time).second;
  });
}

long
bytes_of(const Packets &packets)
{
  long sum = 0;
  for (const auto &one : packets)
    sum += one.size;
  return sum;
}

/// The fault of a copy of a stream's packets; empty: none.
std::string
fault(const FilmStream &film, const FilmStream &copy, double shift)
{
  if (film.packets.size() != copy.packets.size()) {
    // Sound without compression has packets of any length.
    if (film.codec.starts_with("pcm_") && bytes_of(film.packets) == bytes_of(copy.packets))
      return "";
    return std::to_string(copy.packets.size()) + " of " + std::to_string(film.packets.size())
           + " packets";
  }
  if (film.kind == "attachment" || film.facts.contains("flag attached_pic"))
    return "";
  if (!is_timed(film.packets))
    return has_good_times(copy.packets) ? "" : "packets without times of their own";
  const double off = worst(film.packets, copy.packets, shift);
  return off <= kTolerance ? ""
         : std::isinf(off) ? "packets without times"
                           : "times that are off by up to " + text_of(off);
}

double
shift_of(const Packets &film, const Packets &copy)
{
  for (std::size_t i = 0; i < std::min(film.size(), copy.size()); i++)
    if (!std::isnan(film[i].time) && !std::isnan(copy[i].time))
      return copy[i].time - film[i].time;
  return FilmStream::kNever;
}

void
compare_facts(const Facts &film, const Facts &copy, const std::string &of,
              std::vector<std::string> &lost)
{
  for (const auto &[name, text] : film) {
    const auto found = copy.find(name);
    const auto is = [&](const char *other) {
      const auto one = copy.find(other);
      return one != copy.end() && one->second == text;
    };
    if (is(name.c_str())
        || ((name == "title" || name == "handler") && (is("title") || is("handler"))))
      continue;
    lost.push_back(of + ": " + name + (text == "yes" ? "" : " '" + text + "'")
                   + (found == copy.end() ? "" : ", which is now '" + found->second + "'"));
  }
}

void
compare_stream(const FilmStream &film, const FilmStream &copy, const std::string &name,
               bool is_first, Differences &differences)
{
  const std::string wrong = fault(film, copy, differences.shift);
  if (!wrong.empty())
    (film.kind == "video" || film.kind == "audio" ? differences.broken : differences.lost)
        .push_back(name + ": " + wrong);
  if (film.is_text() && copy.codec != film.codec && (film.codec == "ass" || film.codec == "ssa"))
    differences.lost.push_back(name + ": its styles");
  Facts facts = film.facts;
  if (is_first)
    facts.erase("flag default"); // players choose the first one anyway
  if (film.is_text())            // of a window that is drawn
    for (const char *side : { "width", "height" })
      facts.erase(side);
  compare_facts(facts, copy.facts, name, differences.lost);
  if (copy.facts.contains("flag forced") && !film.facts.contains("flag forced"))
    differences.lost.push_back(name + ": that it is not forced");
}

void
compare_chapters(const FilmContents &film, const FilmContents &copy, Differences &differences)
{
  for (std::size_t i = 0; i < film.chapters.size(); i++) {
    const Chapter &chapter = film.chapters[i];
    const std::string name = "chapter " + std::to_string(i + 1)
                             + (chapter.title.empty() ? "" : " '" + chapter.title + "'");
    if (i >= copy.chapters.size())
      differences.lost.push_back(name);
    else if (copy.chapters[i].title != chapter.title
             || std::abs(copy.chapters[i].start - chapter.start - differences.shift)
                    > kChapterTolerance)
      differences.lost.push_back(name + ", which is now '" + copy.chapters[i].title + "' at "
                                 + text_of(copy.chapters[i].start));
  }
}

} // namespace

Differences
compare(const FilmContents &film, const std::vector<int> &taken_out, const FilmContents &copy,
        int track)
{
  Differences differences;
  Matches matches(copy, track);
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < static_cast<int>(film.streams.size()); i++)
    if (std::ranges::find(taken_out, i) == taken_out.end())
      pairs.emplace_back(i, matches.of(film.streams[static_cast<std::size_t>(i)]));
  const auto stream = [](const FilmContents &of, int index) -> const FilmStream & {
    return of.streams[static_cast<std::size_t>(index)];
  };

  differences.shift = copy.earliest() - film.earliest();
  for (const char *kind : { "audio", "video" }) // the picture's counts
    for (const auto &[mine, other] : pairs)
      if (other >= 0 && stream(film, mine).kind == kind)
        if (const double shift = shift_of(stream(film, mine).packets, stream(copy, other).packets);
            !std::isnan(shift)) {
          differences.shift = shift;
          break;
        }
  std::set<std::string> seen;
  for (const auto &[mine, other] : pairs) {
    const FilmStream &one = stream(film, mine);
    const bool is_first = seen.insert(one.kind).second;
    if (other >= 0) {
      compare_stream(one, stream(copy, other), name_of(mine, one), is_first, differences);
    } else {
      differences.left_out.push_back(mine);
      differences.lost.push_back(name_of(mine, one));
    }
  }
  compare_facts(film.facts, copy.facts, "the film", differences.lost);
  compare_chapters(film, copy, differences);
  return differences;
}
