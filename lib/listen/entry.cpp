// SPDX-License-Identifier: LGPL-2.1-or-later
//
// An entry: a head of ten 32-bit numbers, all little-endian, then the name of the film, the name of
// the track, the track, the hashes of 32 bits, and the reference. A hash has 19 bits of its value,
// 3 of its rank and 10 of the frames since the hash before; numbers of rank kNoHash bridge longer
// waits.
#include "listen/entry.h"

#include "files/regular_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <sys/stat.h>
#include <unistd.h>

namespace listen {

namespace {

using Error = tl::unexpected<std::string>;

constexpr std::string_view kMagic = "VTheard1";
constexpr std::size_t kHead = 40;
constexpr std::size_t kLongestName = 1024;
constexpr std::uint64_t kLongest = 360'000'000'000'000; ///< ns: 100 hours, as of tracks
constexpr unsigned kNoHash = 7;                         ///< rank
constexpr std::int64_t kMostWait = 1023;

void
put(std::string &bytes, std::uint32_t value)
{
  for (int i = 0; i < 4; i++)
    bytes += static_cast<char>(value >> (8 * i) & 0xffU);
}

std::uint32_t
number(std::string_view bytes, std::size_t at)
{
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; i++)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

bool
is_name(std::string_view name)
{
  return name.size() <= kLongestName && std::ranges::none_of(name, [](char c) {
           return static_cast<unsigned char>(c) < ' ' || c == '\x7f' || c == '/';
         });
}

} // namespace

tl::expected<std::string, std::string>
write_entry(const NewEntry &entry)
{
  if (!is_name(entry.film) || !is_name(entry.track_name))
    return Error("expected names of at most 1024 bytes without '/' and control characters");
  if (entry.duration.count() < 0 || static_cast<std::uint64_t>(entry.duration.count()) > kLongest)
    return Error("expected a film of at most 100 hours");
  std::string hashes;
  std::int64_t frame = 0;
  for (const RankedHash &hash : entry.sound.hashes) {
    for (; hash.frame - frame > kMostWait; frame += kMostWait)
      put(hashes, kNoHash << 19U | static_cast<std::uint32_t>(kMostWait) << 22U);
    put(hashes,
        hash.value | hash.rank << 19U | static_cast<std::uint32_t>(hash.frame - frame) << 22U);
    frame = hash.frame;
  }
  std::string bytes(kMagic);
  const auto duration = static_cast<std::uint64_t>(entry.duration.count());
  put(bytes, static_cast<std::uint32_t>(duration));
  put(bytes, static_cast<std::uint32_t>(duration >> 32U));
  for (const std::size_t size : { entry.film.size(), entry.track_name.size(), entry.track.size(),
                                  hashes.size() / 4, entry.sound.reference.size() })
    put(bytes, static_cast<std::uint32_t>(size));
  put(bytes, 0);
  bytes += entry.film + entry.track_name + entry.track + hashes;
  bytes.append(entry.sound.reference.begin(), entry.sound.reference.end());
  if (bytes.size() > kMostEntry)
    return Error("expected at most " + std::to_string(kMostEntry) + " bytes, got "
                 + std::to_string(bytes.size()));
  return bytes;
}

Entry::Version
Entry::version(int descriptor)
{
  struct stat found
  {
  };
  if (fstat(descriptor, &found) != 0)
    return {};
  return { .device = found.st_dev,
           .number = found.st_ino,
           .size = found.st_size,
           .changed
           = std::int64_t{ found.st_mtim.tv_sec } * 1'000'000'000 + found.st_mtim.tv_nsec };
}

tl::expected<Entry, std::string>
Entry::open(const std::string &path)
{
  const auto file = files::open_regular(path);
  if (!file)
    return Error(file.error().reason);
  Entry entry;
  entry.path_ = path;
  entry.version_ = version(file->descriptor());
  const auto read = entry.read_head(static_cast<std::size_t>(entry.version_.size));
  if (!read)
    return Error(read.error());
  return entry;
}

tl::expected<Entry, std::string>
Entry::of(std::string bytes)
{
  Entry entry;
  entry.bytes_ = std::move(bytes);
  const auto read = entry.read_head(entry.bytes_.size());
  if (!read)
    return Error(read.error());
  return entry;
}

tl::expected<void, std::string>
Entry::read_head(std::size_t size)
{
  if (size > kMostEntry)
    return Error("expected at most " + std::to_string(kMostEntry) + " bytes, got "
                 + std::to_string(size));
  const auto head = size >= kHead ? read(0, kHead) : std::nullopt;
  if (!head || !head->starts_with(kMagic))
    return Error("expected an entry of tactile-track learn, which begins with "
                 + std::string(kMagic));
  const auto size_at = [&](std::size_t at) {
    return static_cast<std::size_t>(number(*head, at));
  };
  const std::uint64_t duration
      = number(*head, 8) | static_cast<std::uint64_t>(number(*head, 12)) << 32U;
  const std::size_t film = size_at(16);
  const std::size_t name = size_at(20);
  track_size_ = size_at(24);
  hash_count_ = size_at(28);
  steps_ = size_at(32);
  if (film > kLongestName || name > kLongestName || track_size_ > size || hash_count_ > size
      || steps_ > size || duration > kLongest)
    return Error("expected sizes within the file's");
  track_at_ = kHead + film + name;
  hashes_at_ = track_at_ + track_size_;
  reference_at_ = hashes_at_ + 4 * hash_count_;
  if (reference_at_ + steps_ != size)
    return Error("expected " + std::to_string(reference_at_ + steps_)
                 + " bytes as its head says, got " + std::to_string(size) + "; fetch it again");
  const auto names = read(kHead, film + name);
  if (!names)
    return Error("cannot be read");
  film_ = names->substr(0, film);
  track_name_ = names->substr(film);
  if (!is_name(film_) || !is_name(track_name_))
    return Error("expected names without '/' and control characters");
  duration_ = Time(static_cast<Time::rep>(duration));
  return {};
}

std::optional<std::string>
Entry::read(std::size_t from, std::size_t count) const
{
  if (path_.empty())
    return bytes_.substr(std::min(from, bytes_.size()), count);
  const auto file = files::open_regular(path_);
  if (!file || version(file->descriptor()) != version_)
    return std::nullopt;
  std::string bytes(count, '\0');
  std::size_t done = 0;
  while (done < count) {
    const ssize_t piece = pread(file->descriptor(), bytes.data() + done, count - done,
                                static_cast<off_t>(from + done));
    if (piece < 0 && errno == EINTR)
      continue;
    if (piece <= 0)
      return std::nullopt;
    done += static_cast<std::size_t>(piece);
  }
  return bytes;
}

std::optional<std::string>
Entry::track() const
{
  return read(track_at_, track_size_);
}

std::vector<RankedHash>
Entry::hashes(unsigned rank) const
{
  const std::string bytes = read(hashes_at_, 4 * hash_count_).value_or("");
  const auto last = static_cast<std::int64_t>(steps_ * Onsets::kHop / PeakFinder::kHop);
  std::vector<RankedHash> hashes;
  std::int64_t frame = 0;
  std::int64_t second = -1;
  int count = 0;
  for (std::size_t at = 0; at + 4 <= bytes.size(); at += 4) {
    const std::uint32_t word = number(bytes, at);
    frame += word >> 22U;
    if (frame > last)
      break;
    const unsigned of = word >> 19U & 7U;
    if (of > rank || of >= kRanks)
      continue;
    if (std::exchange(second, second_of(frame)) != second_of(frame))
      count = 0;
    if (count++ < kOfRank[rank])
      hashes.push_back({ .frame = frame, .value = word & ((1U << kHashBits) - 1), .rank = of });
  }
  return hashes;
}

std::optional<std::vector<std::uint8_t>>
Entry::reference(std::int64_t from, std::size_t steps) const
{
  std::vector<std::uint8_t> reference(steps);
  const auto size = static_cast<std::int64_t>(steps_);
  const std::int64_t begin = std::clamp<std::int64_t>(from, 0, size);
  const std::int64_t end
      = std::clamp<std::int64_t>(from + static_cast<std::int64_t>(steps), begin, size);
  const auto bytes = read(reference_at_ + static_cast<std::size_t>(begin),
                          static_cast<std::size_t>(end - begin));
  if (!bytes)
    return std::nullopt;
  for (std::size_t i = 0; i < bytes->size(); i++)
    reference[static_cast<std::size_t>(begin - from) + i] = static_cast<std::uint8_t>((*bytes)[i]);
  return reference;
}

} // namespace listen
