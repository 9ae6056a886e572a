// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/catalogue.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

namespace listen {

namespace {

constexpr std::size_t kMostVotes = std::size_t{ 32 } << 20;
constexpr unsigned kDigit = 11; ///< bits
constexpr std::size_t kValues = std::size_t{ 1 } << kHashBits;

/// Sorts values of twice kDigit bits.
void
sort_by_radix(std::vector<std::uint32_t> &values, std::vector<std::uint32_t> &other)
{
  constexpr std::uint32_t kMask = (1U << kDigit) - 1;
  other.resize(values.size());
  for (const unsigned shift : { 0U, kDigit }) {
    std::array<std::uint32_t, kMask + 2> ends{};
    for (const std::uint32_t value : values)
      ends[(value >> shift & kMask) + 1]++;
    for (std::size_t i = 1; i < ends.size(); i++)
      ends[i] += ends[i - 1];
    for (const std::uint32_t value : values)
      other[ends[value >> shift & kMask]++] = value;
    values.swap(other);
  }
}

/// Votes for one place differ by less, in units.
constexpr std::uint32_t kSpread = 3;
/// Units of the time line whose votes are counted at once.
constexpr std::uint32_t kStretch = (1U << 2 * kDigit) - kSpread;

/// Adds the places with the most votes, which are distances from `from`, to a heap of at most
/// `most`, the least first.
void
count_votes(std::span<const std::uint32_t> votes, std::uint32_t from, std::size_t most,
            std::vector<std::pair<int, std::uint32_t>> &best)
{
  const auto greater = std::greater<std::pair<int, std::uint32_t>>();
  std::size_t begin = 0;
  for (std::size_t end = 0; end < votes.size(); end++) {
    while (votes[end] - votes[begin] >= kSpread)
      begin++;
    const auto count = static_cast<int>(end - begin + 1);
    if (count < 2 || (best.size() >= most && count <= best.front().first))
      continue;
    const std::uint32_t middle = from + votes[begin + (end - begin) / 2];
    const auto same = std::ranges::find_if(
        best, [&](const auto &one) { return middle - one.second + kSpread <= 2 * kSpread; });
    if (same != best.end()) {
      if (count > same->first)
        *same = { count, middle };
      std::ranges::make_heap(best, greater);
      continue;
    }
    if (best.size() >= most) {
      std::ranges::pop_heap(best, greater);
      best.pop_back();
    }
    best.emplace_back(count, middle);
    std::ranges::push_heap(best, greater);
  }
}

} // namespace

HashIndex::HashIndex(const std::vector<std::int64_t> &films, const Read &read,
                     std::size_t most_bytes)
{
  const auto fits = [most_bytes](std::int64_t seconds, unsigned rank) {
    return 4 * (static_cast<std::size_t>(seconds * kOfRank[rank]) + kValues) <= most_bytes;
  };
  std::int64_t seconds = 1;
  std::int64_t start = kGap;
  for (const std::int64_t frames : films) {
    const std::int64_t units = frames / kUnit + 1 + kGap;
    seconds += second_of(frames) + 1;
    if (start + units > std::int64_t{ 0xffff'ffff } || !fits(seconds, 0))
      break; // no room for more
    starts_.push_back(static_cast<std::uint32_t>(start));
    start += units;
  }
  end_ = static_cast<std::uint32_t>(start);
  const std::size_t count = starts_.size();
  unsigned rank = 0;
  while (rank + 1 < kRanks && fits(seconds, rank + 1))
    rank++;
  begins_.resize(kValues + 1);
  for (std::size_t film = 0; film < count; film++)
    for (const RankedHash &hash : read(film, rank))
      begins_[hash.value + 1]++;
  for (std::size_t value = 0; value < kValues; value++)
    begins_[value + 1] += begins_[value];
  places_.resize(begins_.back());
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t film = 0; film < count; film++)
    for (const RankedHash &hash : read(film, rank))
      if (std::uint32_t &at = next[hash.value]; at < begins_[hash.value + 1]) // the file may change
        places_[at++] = starts_[film] + static_cast<std::uint32_t>(hash.frame / kUnit);
  common_ = std::max<std::size_t>(64, 12 * places_.size() / kValues);
}

HashIndex::Found
HashIndex::search(std::span<const Hash> heard, std::size_t most) const
{
  if (places_.empty())
    return {};
  const auto places_of = [this](const Hash &hash) {
    return std::span(places_).subspan(begins_[hash.value],
                                      begins_[hash.value + 1] - begins_[hash.value]);
  };
  std::size_t common = common_;
  std::size_t count = 0;
  for (;; common /= 2) {
    count = 0;
    for (const Hash &hash : heard)
      if (const std::size_t places = places_of(hash).size(); places <= common)
        count += places;
    if (count <= kMostVotes)
      break;
  }
  std::vector<std::pair<int, std::uint32_t>> best; // a heap, the least first
  struct Line
  {
    const std::uint32_t *next; ///< the first place that was not counted
    const std::uint32_t *end;
    std::uint32_t ago;
  };
  std::vector<Line> lines;
  for (const Hash &hash : heard) {
    const auto places = places_of(hash);
    const auto ago = static_cast<std::uint32_t>(hash.frame / kUnit);
    if (places.size() <= common)
      lines.push_back({ .next = std::to_address(std::ranges::lower_bound(places, ago)),
                        .end = std::to_address(places.end()),
                        .ago = ago });
  }
  // Stretches of the time line one after another, so that their votes are near in memory.
  std::vector<std::uint32_t> votes;
  std::vector<std::uint32_t> buffer;
  for (std::uint64_t from = 0; from < end_; from += kStretch) {
    votes.clear();
    for (Line &line : lines) {
      const std::uint64_t first = from + line.ago;
      for (; line.next != line.end && *line.next - first < kStretch; line.next++)
        votes.push_back(static_cast<std::uint32_t>(*line.next - first));
      for (const std::uint32_t *at = line.next; at != line.end && *at - first < kStretch + kSpread;
           at++)
        votes.push_back(static_cast<std::uint32_t>(*at - first));
    }
    sort_by_radix(votes, buffer);
    count_votes(votes, static_cast<std::uint32_t>(from), most, best);
  }
  const auto greater = std::greater<std::pair<int, std::uint32_t>>();
  Found found{ .votes = count };
  std::ranges::sort(best, greater);
  for (const auto &[fitting, place] : best) {
    // A place may be before the beginning of its film, but nearer to it than to the film before.
    const auto film = std::ranges::upper_bound(starts_, place + kGap / 2) - starts_.begin();
    if (film > 0)
      found.places.push_back(
          { .film = static_cast<std::size_t>(film - 1),
            .frame = kUnit
                     * (static_cast<std::int64_t>(place)
                        - static_cast<std::int64_t>(starts_[static_cast<std::size_t>(film - 1)])),
            .votes = fitting });
  }
  return found;
}

Catalogue::Catalogue(std::vector<Entry> films, std::size_t most_bytes,
                     const std::function<bool()> &stops)
    : films_(std::move(films))
{
  remove_copies(stops);
  if (films_.size() > kMostFilms)
    films_.erase(films_.begin() + kMostFilms, films_.end());
  std::vector<std::int64_t> frames;
  frames.reserve(films_.size());
  for (const Entry &film : films_)
    frames.push_back(static_cast<std::int64_t>(film.steps() * Onsets::kHop / PeakFinder::kHop));
  index_ = HashIndex(
      frames,
      [&](std::size_t film, unsigned rank) {
        return stops && stops() ? std::vector<RankedHash>{} : films_[film].hashes(rank);
      },
      most_bytes);
  if (const std::size_t left = films_.size() - index_.films(); left > 0)
    complaints_.push_back(std::to_string(left) + " of " + std::to_string(films_.size())
                          + " films are not listened for, as the memory for the others is full");
}

/// Films with the same sound cannot be distinguished: the first one counts.
void
Catalogue::remove_copies(const std::function<bool()> &stops)
{
  // The sound at 16 moments, of 1 s each.
  const auto sample = [](const Entry &film) {
    constexpr std::size_t kMoments = 16;
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < kMoments; i++)
      if (const auto moment = film.reference(static_cast<std::int64_t>(film.steps() * i / kMoments),
                                             Onsets::kOnsetRate))
        bytes.insert(bytes.end(), moment->begin(), moment->end());
    return std::hash<std::string_view>()(
        { reinterpret_cast<const char *>(bytes.data()), bytes.size() });
  };
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> kept; // by steps and sample
  std::vector<Entry> films;
  films.reserve(films_.size());
  for (Entry &film : films_) {
    if (stops && stops())
      break;
    const auto [first, is_new] = kept.try_emplace({ film.steps(), sample(film) }, films.size());
    if (!is_new) {
      complaints_.push_back("'" + film.film() + "' with '" + film.track_name()
                            + "' has the sound of '" + films[first->second].film() + "' with '"
                            + films[first->second].track_name()
                            + "', which comes first; keep only one of the two entries");
      continue;
    }
    films.push_back(std::move(film));
  }
  films_ = std::move(films);
}

} // namespace listen
