// SPDX-License-Identifier: LGPL-2.1-or-later
#include "analysis.h"
#include "frame/thread_pool.h"
#include "frame_loop.h"
#include "literal_paper.h"
#include "opencv_rewrite.h"
#include "quality/peers.h"
#include "race.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>

namespace bench {

namespace {

/// Keeps the compiler from removing the work.
std::atomic<std::uint64_t> sink = 0;

std::uint64_t
word_at(const uchar *bytes)
{
  std::uint64_t word;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

/// Four independent sums, so that the loop is limited by memory, not by the latency of additions.
std::uint64_t
sum_of_words(const uchar *begin, std::size_t size)
{
  std::uint64_t sum0 = 0;
  std::uint64_t sum1 = 0;
  std::uint64_t sum2 = 0;
  std::uint64_t sum3 = 0;
  const std::size_t count = size / 32;
  for (std::size_t i = 0; i < count; i++) {
    const uchar *words = begin + 32 * i;
    sum0 += word_at(words);
    sum1 += word_at(words + 8);
    sum2 += word_at(words + 16);
    sum3 += word_at(words + 24);
  }
  return sum0 + sum1 + sum2 + sum3;
}

std::size_t
frame_bytes(const FrameLoop &film)
{
  return film.bytes(0).total() * film.bytes(0).elemSize();
}

Contender
reading(std::shared_ptr<FrameLoop> film, Format format, int threads)
{
  auto pool = std::make_shared<saliency::ThreadPool>();
  return { .method = kReading,
           .input = name(format),
           .threads = threads,
           .frame_bytes = frame_bytes(*film),
           .work = [=](std::size_t i) {
             const std::size_t part = frame_bytes(*film) / static_cast<std::size_t>(threads);
             pool->run(threads, [&](int thread) {
               const auto *begin = film->bytes(i).data + static_cast<std::size_t>(thread) * part;
               sink += sum_of_words(begin, part);
             });
           } };
}

Contender
ours(const std::string &method, const saliency::Profile &profile,
     const tactile::MappingSettings &mapping, std::shared_ptr<FrameLoop> film, Format format,
     int threads, double rest = 0)
{
  auto analysis = std::make_shared<Analysis>(profile, mapping, cv::Size(3, 3), threads, rest);
  return { .method = method,
           .input = name(format),
           .threads = threads,
           .frame_bytes = frame_bytes(*film),
           .history = 70, // the longest window is 64
           .work = [=](std::size_t i) {
             analysis->frame(film->view(i), i);
           } };
}

Contender
peer(quality::Peer which, std::shared_ptr<FrameLoop> film)
{
  auto model = std::make_shared<quality::PeerSaliency>(which);
  auto bgr = std::make_shared<cv::Mat>();
  const int width = quality::scaled_for(which, film->size()).width;
  const std::string reduced
      = width < film->size().width ? " (" + std::to_string(width) + " wide)" : "";
  return { .method = quality::name(which) + reduced,
           .input = "I420",
           .frame_bytes = frame_bytes(*film),
           .work = [=](std::size_t i) {
             cv::cvtColor(film->bytes(i), *bgr, cv::COLOR_YUV2BGR_I420);
             model->compute(*bgr);
           } };
}

} // namespace

std::vector<Contender>
contenders(cv::Size size)
{
  const auto film = std::make_shared<FrameLoop>(size, Scene::disc);
  const auto pan = std::make_shared<FrameLoop>(size, Scene::pan);
  const auto tuned = saliency::Profile::tuned();
  auto exact = tuned;
  exact.exact = true;
  const auto mapping = tactile::MappingSettings::tuned();

  std::vector<Contender> all;
  for (const Format format : kFormats) {
    const auto in_format
        = format == Format::i420 ? film : std::make_shared<FrameLoop>(size, Scene::disc, format);
    for (const int threads : { 1, 2 })
      if (threads == 1 || format == Format::i420 || format == Format::rgbx)
        all.push_back(reading(in_format, format, threads));
    for (const int threads : thread_counts())
      if (threads <= 2 || format == Format::i420)
        all.push_back(ours("tuned", tuned, mapping, in_format, format, threads));
  }
  for (const int threads : thread_counts())
    all.push_back(ours("exact", exact, mapping, film, Format::i420, threads));
  for (const int threads : { 1, 2 }) {
    all.push_back(ours(kPlayed, tuned, mapping, film, Format::i420, threads));
    all.back().played = true;
  }
  for (const Format format : { Format::i420, Format::rgbx }) {
    const auto two = std::make_shared<FrameLoop>(size, Scene::disc, format, 2);
    for (const int threads : { 1, 2 })
      all.push_back(ours(kTwoFrames, tuned, mapping, two, format, threads));
  }
  all.push_back(ours("tuned, camera moving", tuned, mapping, pan, Format::i420, 1));
  constexpr double kFloor = 0.8; // as elements have it
  for (const auto &[name, scene] :
       { std::pair("stills", Scene::still), std::pair("talking head", Scene::head) })
    all.push_back(ours(std::string("tuned, ") + name, tuned, mapping,
                       std::make_shared<FrameLoop>(size, scene), Format::i420, 1, kFloor));
  all.push_back(ours("paper", saliency::Profile::paper(), tactile::MappingSettings::paper(), film,
                     Format::i420, 1));

  const auto literal = std::make_shared<LiteralPaper>();
  all.push_back({ .method = "literal paper",
                  .input = "I420",
                  .frame_bytes = frame_bytes(*film),
                  .work = [=](std::size_t i) {
                    literal->frame(film->bytes(i));
                  } });
  for (const bool decimate_first : { false, true }) {
    const auto rewrite = std::make_shared<OpencvRewrite>(size, decimate_first);
    all.push_back(
        { .method = decimate_first ? "OpenCV rewrite, decimating first" : "OpenCV rewrite",
          .input = "I420",
          .frame_bytes = frame_bytes(*film),
          .work = [=](std::size_t i) {
            rewrite->frame(film->bytes(i));
          } });
  }
  for (const quality::Peer which : quality::kPeers)
    if (quality::is_available(which) && which != quality::Peer::frame_difference)
      all.push_back(peer(which, film));
  return all;
}

std::vector<Contender>
own_contenders(cv::Size size)
{
  const auto tuned = saliency::Profile::tuned();
  const auto mapping = tactile::MappingSettings::tuned();
  return { ours("tuned", tuned, mapping, std::make_shared<FrameLoop>(size, Scene::disc),
                Format::i420, 1),
           ours("tuned, camera moving", tuned, mapping,
                std::make_shared<FrameLoop>(size, Scene::pan), Format::i420, 1) };
}

std::vector<int>
thread_counts()
{
  return { 1, 2, 4 };
}

} // namespace bench
