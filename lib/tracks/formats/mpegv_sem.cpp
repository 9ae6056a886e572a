// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/mpegv_sem.h"

#include "tracks/text_cue.h"

#include <libxml/parser.h>
#include <libxml/tree.h>
#include <libxml/xmlerror.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr const char *kSedl = "urn:mpeg:mpeg-v:2010:01-SEDL-NS";
constexpr const char *kSev = "urn:mpeg:mpeg-v:2010:01-SEV-NS";
constexpr const char *kMpeg7 = "urn:mpeg:mpeg7:schema:2004";
constexpr const char *kSi = "urn:mpeg:mpeg21:2003:01-DIA-XSI-NS";
constexpr const char *kXsi = "http://www.w3.org/2001/XMLSchema-instance";
constexpr double kDefaultRate = 5;
constexpr int kTimescale = 1000;
/// Most bytes of a map's samples, and of those of all maps beyond one each. Longer maps have fewer
/// samples.
constexpr std::int64_t kMostOfMap = 8 << 20;
constexpr std::int64_t kMostSamples = 128 << 20;
constexpr std::ptrdiff_t kMostNodes = 4'000'000; ///< tags and attributes of a document

struct FreeXml
{
  void operator()(xmlDoc *document) const
  {
    xmlFreeDoc(document);
  }
  void operator()(xmlParserCtxt *context) const
  {
    xmlFreeParserCtxt(context);
  }
  void operator()(xmlChar *text) const
  {
    xmlFree(text);
  }
};
using Document = std::unique_ptr<xmlDoc, FreeXml>;
using Text = std::unique_ptr<xmlChar, FreeXml>;

const xmlChar *
xml(const char *text)
{
  return reinterpret_cast<const xmlChar *>(text);
}

/* ---- writing ---- */

class Writer
{
public:
  explicit Writer(const Track &track)
      : track_(track),
        samples_(std::max(
            1, static_cast<int>(std::ceil(track.rate() > 0 ? track.rate() : kDefaultRate))))
  {
  }

  std::string operator()()
  {
    xmlNode *root = xmlNewDocNode(document_.get(), nullptr, xml("SEM"), nullptr);
    xmlDocSetRootElement(document_.get(), root);
    xmlSetNs(root, xmlNewNs(root, xml(kSedl), nullptr));
    sev_ = xmlNewNs(root, xml(kSev), xml("sev"));
    mpeg7_ = xmlNewNs(root, xml(kMpeg7), xml("mpeg7"));
    si_ = xmlNewNs(root, xml(kSi), xml("si"));
    xsi_ = xmlNewNs(root, xml(kXsi), xml("xsi"));
    xmlNewProp(root, xml("autoExtraction"), xml("visual"));
    xmlNewNsProp(root, si_, xml("absTimeScheme"), xml("mp7t"));
    xmlNewNsProp(root, si_, xml("timeScale"), xml(std::to_string(kTimescale).c_str()));
    xmlNewNsProp(root, si_, xml("puMode"), xml("ancestorsDescendants"));
    const std::string grid
        = " tactile " + write_grid({ track_.rows(), track_.columns() }, track_.rate()) + " ";
    xmlAddChild(root, xmlNewDocComment(document_.get(), xml(grid.c_str())));

    const Track rounded = at_resolution(track_, std::chrono::milliseconds(1), 0);
    const auto &entries = rounded.entries();
    for (std::size_t i = 0; i < entries.size(); i++) {
      const bool is_last = i + 1 == entries.size();
      const Time end = is_last ? rounded.end() : entries[i + 1].time;
      if (end > entries[i].time && (is_last || !is_silent(entries[i].map)))
        add_effect(root, entries[i].time, end, entries[i].map);
    }

    xmlChar *text = nullptr;
    int length = 0;
    xmlDocDumpFormatMemoryEnc(document_.get(), &text, &length, "UTF-8", 1);
    const Text owned(text);
    return { reinterpret_cast<const char *>(text), static_cast<std::size_t>(length) };
  }

private:
  void add_effect(xmlNode *root, Time begin, Time end, const TactileMap &map)
  {
    using std::chrono::milliseconds;
    const auto ms = [](Time time) {
      return std::chrono::floor<milliseconds>(time).count();
    };
    xmlNode *effect = xmlNewChild(root, nullptr, xml("Effect"), nullptr);
    xmlNewNsProp(effect, xsi_, xml("type"), xml("sev:TactileType"));
    xmlNewProp(effect, xml("activate"), xml("true"));
    xmlNewNsProp(effect, si_, xml("pts"), xml(std::to_string(ms(begin)).c_str()));
    xmlNewProp(effect, xml("duration"), xml(std::to_string(ms(end - begin)).c_str()));
    xmlNewProp(effect, xml("timeSamples"), xml(std::to_string(samples_).c_str()));
    xmlNewProp(effect, xml("tactileEffect"),
               xml("urn:mpeg:mpeg-v:01-SI-TactileEffectCS-NS:vibration"));
    xmlNewProp(effect, xml("location"), xml("urn:mpeg:mpeg-v:01-SI-LocationCS-NS:back"));

    std::string row;
    for (const float level : map.levels) {
      std::array<char, 64> digits;
      row += row.empty() ? "" : " ";
      row.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), level,
                                              std::chars_format::fixed)
                                    .ptr);
    }
    row += '\n';
    const auto size = static_cast<std::int64_t>(row.size());
    const auto rows
        = std::clamp<std::int64_t>((ms(end - begin) * samples_ + kTimescale - 1) / kTimescale, 1,
                                   1 + std::min(kMostOfMap, left_) / size);
    left_ -= (rows - 1) * size;
    std::string text = "\n";
    for (std::int64_t i = 0; i < rows; i++)
      text += row;
    xmlNode *array = xmlNewChild(effect, sev_, xml("ArrayIntensity"), xml(text.c_str()));
    xmlNewNsProp(array, mpeg7_, xml("dim"),
                 xml((std::to_string(rows) + " " + std::to_string(map.levels.size())).c_str()));
  }

  const Track &track_;
  int samples_;
  std::int64_t left_ = kMostSamples;
  Document document_{ xmlNewDoc(xml("1.0")) };
  xmlNs *sev_ = nullptr;
  xmlNs *mpeg7_ = nullptr;
  xmlNs *si_ = nullptr;
  xmlNs *xsi_ = nullptr;
};

/* ---- reading ---- */

std::size_t
line_of(const xmlNode *node)
{
  return static_cast<std::size_t>(std::max(xmlGetLineNo(node), 1L));
}

bool
is_element(const xmlNode *node, const char *ns, const char *name)
{
  return node->type == XML_ELEMENT_NODE && xmlStrEqual(node->name, xml(name)) && node->ns
         && xmlStrEqual(node->ns->href, xml(ns));
}

/// Typed access to a document. A missing or invalid value sets `error` and reads as the minimum or
/// nothing.
class Contents
{
public:
  void fail(const xmlNode *node, std::string reason)
  {
    error.set(FormatError::at_line(line_of(node), std::move(reason)));
  }

  /// An integer attribute; if it is missing, `otherwise`, or an error if there is no default.
  std::int64_t integer(const xmlNode *node, const char *ns, const char *name, std::int64_t least,
                       std::int64_t most, std::optional<std::int64_t> otherwise = std::nullopt)
  {
    const Text text(ns ? xmlGetNsProp(node, xml(name), xml(ns)) : xmlGetNoNsProp(node, xml(name)));
    if (!text && otherwise)
      return *otherwise;
    std::int64_t value = 0;
    const char *begin = text ? reinterpret_cast<const char *>(text.get()) : "";
    const char *end = begin + std::strlen(begin);
    const auto [stop, problem] = std::from_chars(begin, end, value);
    if (problem == std::errc() && stop == end && value >= least && value <= most)
      return value;
    fail(node, std::string("expected a whole number '") + name + "' from " + std::to_string(least)
                   + " to " + std::to_string(most));
    return least;
  }

  bool boolean(const xmlNode *node, const char *name, bool otherwise)
  {
    const Text text(xmlGetNoNsProp(node, xml(name)));
    if (!text)
      return otherwise;
    const std::string_view word = reinterpret_cast<const char *>(text.get());
    const bool value = word == "true" || word == "1";
    if (!value && word != "false" && word != "0")
      fail(node, std::string("expected '") + name + "' to be true or false");
    return value;
  }

  std::vector<double> numbers(const xmlNode *node, const char *text, double least, double most)
  {
    std::vector<double> values;
    const char *end = text + std::strlen(text);
    for (;;) {
      while (text < end && std::strchr(" \t\r\n", *text))
        text++;
      if (text == end)
        return values;
      double value = 0;
      const auto [stop, problem] = std::from_chars(text, end, value);
      if (problem != std::errc() || !(value >= least && value <= most)
          || (stop < end && !std::strchr(" \t\r\n", *stop))) {
        const auto length = std::min<std::size_t>(static_cast<std::size_t>(end - text), 12);
        fail(node, "expected numbers in the range of what they stand for, got '"
                       + std::string(text, length) + "'");
        return {};
      }
      if (values.size() >= Track::kMaxLevels) {
        fail(node, "too many numbers");
        return {};
      }
      values.push_back(value);
      text = stop;
    }
  }

  FirstError error;
};

class Reader
{
public:
  tl::expected<Track, FormatError> operator()(const xmlNode *root)
  {
    if (!is_element(root, kSedl, "SEM"))
      in_.fail(root, "expected a SEM of MPEG-V");
    // The schema defines no default unit, and other readers differ.
    timescale_ = in_.integer(root, kSi, "timeScale", 1, 1'000'000'000);
    for (const xmlNode *node = root->children; node && !in_.error; node = node->next) {
      if (node->type == XML_COMMENT_NODE && node->content)
        read_comment(node);
      if (node->type == XML_ELEMENT_NODE && !is_element(node, kSedl, "DescriptionMetadata"))
        read_effect(node);
    }
    if (!track_ && !grid_.grid)
      in_.fail(root, "there is no effect");
    if (endless_)
      in_.fail(endless_, "the last vibration has no end");
    if (!track_)
      track_ = grid_.grid ? Track(grid_.grid->rows, grid_.grid->columns) : Track();
    track_->set_rate(grid_.rate);
    (void)track_->set_end(end_);
    return std::move(in_.error).unless_set(std::move(*track_));
  }

private:
  void read_comment(const xmlNode *node)
  {
    std::string_view text = reinterpret_cast<const char *>(node->content);
    if (track_ || !text.starts_with(" tactile "))
      return;
    const tl::expected<GridHeader, FormatError> grid = read_grid(text.substr(9), line_of(node));
    if (grid)
      grid_ = *grid;
    else
      in_.error.set(grid.error());
  }

  Time to_time(const xmlNode *node, std::int64_t units)
  {
    const double ns = static_cast<double>(units) * 1e9 / static_cast<double>(timescale_);
    if (ns <= static_cast<double>(Track::kMaxEnd.count()))
      return Time(static_cast<Time::rep>(std::llround(ns)));
    in_.fail(node, "the effect is beyond 100 hours");
    return Time(0);
  }

  /// Duration of an effect.
  Time duration_of(const xmlNode *node)
  {
    return to_time(node, in_.integer(node, nullptr, "duration", 1, LLONG_MAX));
  }

  void read_effect(const xmlNode *node)
  {
    const Text type(xmlGetNsProp(node, xml("type"), xml(kXsi)));
    const char *name = type ? reinterpret_cast<const char *>(type.get()) : "";
    const char *colon = std::strchr(name, ':');
    const std::string kind = colon ? colon + 1 : name;
    if (!is_element(node, kSedl, "Effect") || (kind != "TactileType" && kind != "VibrationType"))
      in_.fail(node, "only effects of TactileType or VibrationType can be a track, with no groups "
                     "around them");
    if (xmlHasProp(node, xml("fade")) || xmlHasNsProp(node, xml("timeScale"), xml(kSi)))
      in_.fail(node, "effects with a fade or a timeScale of their own are not read");
    const bool is_active = in_.boolean(node, "activate", true);
    const Time begin = to_time(node, in_.integer(node, kSi, "pts", 0, LLONG_MAX));
    endless_ = nullptr;
    if (in_.error)
      return;
    if (kind == "VibrationType")
      return read_vibration(node, is_active, begin);
    const Time end = begin + duration_of(node);
    const std::int64_t samples = in_.integer(node, nullptr, "timeSamples", 1, 1'000'000, 1);
    const xmlNode *array = nullptr;
    for (const xmlNode *child = node->children; child; child = child->next)
      if (child->type == XML_ELEMENT_NODE) {
        if (!is_element(child, kSev, "ArrayIntensity") || array)
          in_.fail(child, "expected one ArrayIntensity");
        array = child;
      }
    if (!array)
      in_.fail(node, "expected an ArrayIntensity");
    if (begin < end_)
      in_.fail(node, "the effect overlaps the one before");
    if (!in_.error)
      read_array(array, is_active, begin, end, samples);
  }

  /// An attribute of `count` numbers.
  std::vector<double> attribute(const xmlNode *node, const char *name, const char *otherwise,
                                std::size_t count)
  {
    const Text text(xmlGetNoNsProp(node, xml(name)));
    std::vector<double> values = in_.numbers(
        node, text ? reinterpret_cast<const char *>(text.get()) : otherwise, -1e9, 1e9);
    if (values.size() != count)
      in_.fail(node, std::string("expected ") + name + " of numbers: " + std::to_string(count));
    values.resize(count);
    return values;
  }

  /// Reads one motor for the whole body, as other tools write it. It runs for its duration or, if
  /// it has none, until the next effect.
  void read_vibration(const xmlNode *node, bool is_active, Time begin)
  {
    const std::vector<double> range = attribute(node, "intensity-range", "0 1", 2);
    const double value = attribute(node, "intensity-value", is_active ? "1" : "0", 1)[0];
    const bool has_value = xmlHasProp(node, xml("intensity-value"));
    if (!(range[0] < range[1]) || (has_value && !(value >= range[0] && value <= range[1])))
      in_.fail(node, "expected intensity-value within intensity-range");
    if (begin < end_)
      in_.fail(node, "the effect overlaps the one before");
    begin_track(node, 1);
    if (in_.error)
      return;
    const double share = has_value ? (value - range[0]) / (range[1] - range[0]) : value;
    TactileMap map(1, 1);
    map.levels[0] = is_active ? static_cast<float>(share) : 0.0F;
    const bool has_end = xmlHasProp(node, xml("duration"));
    end_ = has_end ? begin + duration_of(node) : begin;
    endless_ = !has_end && map.levels[0] > 0 ? node : nullptr;
    append(node, begin, map);
    if (has_end)
      append(node, end_, TactileMap(1, 1));
  }

  void read_array(const xmlNode *node, bool is_active, Time begin, Time end, std::int64_t samples)
  {
    const Text dim(xmlGetNsProp(node, xml("dim"), xml(kMpeg7)));
    const std::vector<double> sizes
        = in_.numbers(node, dim ? reinterpret_cast<const char *>(dim.get()) : "", 1, 1e9);
    const Text content(xmlNodeGetContent(node));
    const std::vector<double> levels
        = in_.numbers(node, reinterpret_cast<const char *>(content.get()), 0, 1);
    const bool is_whole = std::ranges::all_of(sizes, [](double d) { return d == std::floor(d); });
    if (sizes.size() != 2 || !is_whole || sizes[0] * sizes[1] != static_cast<double>(levels.size()))
      return in_.fail(node, "expected dim=\"SAMPLES TACTORS\" and as many levels, got "
                                + std::to_string(levels.size()));
    const auto tactors = static_cast<std::size_t>(sizes[1]);
    begin_track(node, tactors);
    if (in_.error)
      return;
    TactileMap map(track_->rows(), track_->columns());
    for (std::size_t row = 0; row * tactors < levels.size() && !in_.error; row++) {
      const Time time = begin + Time(std::chrono::seconds(row)) / samples;
      if (time >= end)
        break;
      for (std::size_t i = 0; i < tactors; i++)
        map.levels[i] = is_active ? static_cast<float>(levels[row * tactors + i]) : 0.0F;
      append(node, time, map);
    }
    append(node, end, TactileMap(track_->rows(), track_->columns()));
    end_ = end;
  }

  void append(const xmlNode *node, Time time, const TactileMap &map)
  {
    if (const auto appended = track_->append(time, map); !appended)
      in_.fail(node, appended.error().reason);
  }

  /// Starts a track with this many tactors, or sets an error.
  void begin_track(const xmlNode *node, std::size_t tactors)
  {
    if (!track_) {
      const auto count = static_cast<int>(std::min<std::size_t>(tactors, INT_MAX));
      const int side = static_cast<int>(std::lround(std::sqrt(count)));
      Grid grid{ 1, count };
      if (grid_.grid)
        grid = *grid_.grid;
      else if (side <= kMaxGridSide && side * side == count)
        grid = { side, side };
      if (grid.columns > kMaxGridSide)
        return in_.fail(node, "a row of more than 64 tactors");
      track_.emplace(grid.rows, grid.columns);
    }
    if (static_cast<std::size_t>(track_->rows()) * static_cast<std::size_t>(track_->columns())
        != tactors)
      in_.fail(node, "expected " + std::to_string(track_->rows() * track_->columns())
                         + " tactors, got " + std::to_string(tactors));
  }

  Contents in_;
  std::int64_t timescale_ = kTimescale; ///< units per second
  GridHeader grid_;
  std::optional<Track> track_;
  Time end_{ 0 };
  const xmlNode *endless_ = nullptr; ///< the last effect, if it is active and has no duration
};

} // namespace

std::string
write_sem(const Track &track)
{
  return Writer(track)();
}

tl::expected<Track, FormatError>
read_sem(std::string_view text)
{
  const auto refused = [](std::string reason) {
    return tl::unexpected(FormatError{ .place = "document", .reason = std::move(reason) });
  };
  if (text.size() > INT_MAX)
    return refused("too large");
  // Each of these becomes a node of about 200 bytes.
  if (std::ranges::count_if(text, [](char c) { return c == '<' || c == '='; }) > kMostNodes)
    return refused("more than " + std::to_string(kMostNodes) + " tags and attributes");
  const std::unique_ptr<xmlParserCtxt, FreeXml> context(xmlNewParserCtxt());
  const Document document(
      xmlCtxtReadMemory(context.get(), text.data(), static_cast<int>(text.size()), nullptr, nullptr,
                        XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING
                            | XML_PARSE_BIG_LINES | XML_PARSE_NOCDATA));
  if (!document) {
    const xmlError *error = xmlCtxtGetLastError(context.get());
    std::string reason = error && error->message ? error->message : "no XML";
    while (!reason.empty() && reason.back() == '\n')
      reason.pop_back();
    return tl::unexpected(FormatError::at_line(
        static_cast<std::size_t>(error ? std::max(error->line, 1) : 1), std::move(reason)));
  }
  if (document->intSubset || document->extSubset)
    return tl::unexpected(FormatError::at_line(1, "documents with a DTD are not read"));
  return Reader()(xmlDocGetRootElement(document.get()));
}

} // namespace tactile
