// SPDX-License-Identifier: LGPL-2.1-or-later
#include "decoderchoice.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <vector>

namespace {

struct FreeFeatures
{
  void operator()(GList *list) const
  {
    gst_plugin_feature_list_free(list);
  }
};
using Features = std::unique_ptr<GList, FreeFeatures>;

/// jpegdec, which decodes films of JPEG pictures, is for images.
constexpr GstElementFactoryListType kVideo
    = GST_ELEMENT_FACTORY_TYPE_MEDIA_VIDEO | GST_ELEMENT_FACTORY_TYPE_MEDIA_IMAGE;

using Factories = std::vector<GstElementFactory *>;

/// The list without visuotactiledecoder, the best first.
Factories
by_rank(GList *list)
{
  Factories found;
  for (GList *item = list; item != nullptr; item = item->next)
    if (g_strcmp0(GST_OBJECT_NAME(item->data), "visuotactiledecoder") != 0)
      found.push_back(GST_ELEMENT_FACTORY(item->data));
  std::ranges::stable_sort(found, [](GstElementFactory *a, GstElementFactory *b) {
    return gst_plugin_feature_rank_compare_func(a, b) < 0;
  });
  return found;
}

Features
list_factories(GstElementFactoryListType type)
{
  return Features(gst_element_factory_list_get_elements(type, GST_RANK_MARGINAL));
}

Features
list_decoders()
{
  return list_factories(GST_ELEMENT_FACTORY_TYPE_DECODER | kVideo);
}

Features
list_parsers()
{
  return list_factories(GST_ELEMENT_FACTORY_TYPE_PARSER | kVideo);
}

/// The caps of the factory's pads of this direction. Transfer full.
GstCaps *
template_caps(GstElementFactory *factory, GstPadDirection direction)
{
  GstCaps *all = gst_caps_new_empty();
  for (const GList *item = gst_element_factory_get_static_pad_templates(factory); item != nullptr;
       item = item->next) {
    auto *pad = static_cast<GstStaticPadTemplate *>(item->data);
    if (pad->direction == direction)
      gst_caps_append(all, gst_static_caps_get(&pad->static_caps));
  }
  return all;
}

/// Whether one can be made of the other: a parser changes fields, and keeps the media type.
bool
can_feed(GstElementFactory *parser, GstElementFactory *decoder)
{
  g_autoptr(GstCaps) given = template_caps(parser, GST_PAD_SRC);
  g_autoptr(GstCaps) taken = template_caps(decoder, GST_PAD_SINK);
  return gst_caps_can_intersect(given, taken);
}

/// Pairs of a parser, NULL where none is needed, and a decoder; the best comes first.
std::vector<std::pair<GstElementFactory *, GstElementFactory *>>
candidates(const Features &decoders, const Features &parsers, GstCaps *caps)
{
  std::vector<std::pair<GstElementFactory *, GstElementFactory *>> found;
  const Factories all = by_rank(decoders.get());
  for (GstElementFactory *decoder : all)
    if (gst_element_factory_can_sink_all_caps(decoder, caps))
      found.emplace_back(nullptr, decoder);
  for (GstElementFactory *parser : by_rank(parsers.get()))
    if (found.empty() && gst_element_factory_can_sink_all_caps(parser, caps))
      for (GstElementFactory *decoder : all)
        if (can_feed(parser, decoder))
          found.emplace_back(parser, decoder);
  return found;
}

/// A bin of both, with their outer pads.
GstElement *
join(GstElement *parser, GstElement *decoder)
{
  GstElement *bin = gst_bin_new(nullptr);
  gst_bin_add_many(GST_BIN(bin), parser, decoder, nullptr);
  gst_element_link(parser, decoder);
  for (const auto &[element, name] : { std::pair{ parser, "sink" }, std::pair{ decoder, "src" } }) {
    g_autoptr(GstPad) target = gst_element_get_static_pad(element, name);
    if (target)
      gst_element_add_pad(bin, gst_ghost_pad_new(name, target));
  }
  return bin;
}

GstElement *
make(GstElementFactory *parser, GstElementFactory *decoder)
{
  GstElement *made = gst_element_factory_create(decoder, nullptr);
  GstElement *before = parser && made ? gst_element_factory_create(parser, nullptr) : nullptr;
  return before ? join(before, made) : made;
}

bool
has_pads(GstElement *element)
{
  g_autoptr(GstPad) sink = gst_element_get_static_pad(element, "sink");
  g_autoptr(GstPad) src = gst_element_get_static_pad(element, "src");
  return sink && src;
}

/// Whether the decoder itself agrees: a hardware decoder knows its limits only in READY.
bool
accepts(GstElement *element, GstCaps *caps)
{
  g_autoptr(GstPad) sink = gst_element_get_static_pad(element, "sink");
  return gst_pad_query_accept_caps(sink, caps);
}

GstCaps *
find_decodable_caps()
{
  g_autoptr(GstCaps) decoded = gst_caps_new_empty();
  const Features decoders = list_decoders();
  for (GstElementFactory *decoder : by_rank(decoders.get()))
    decoded = gst_caps_merge(decoded, template_caps(decoder, GST_PAD_SINK));
  GstCaps *all = gst_caps_ref(decoded);
  const Features parsers = list_parsers();
  for (GstElementFactory *parser : by_rank(parsers.get())) {
    g_autoptr(GstCaps) given = template_caps(parser, GST_PAD_SRC);
    if (gst_caps_can_intersect(given, decoded))
      all = gst_caps_merge(all, template_caps(parser, GST_PAD_SINK));
  }
  return all;
}

} // namespace

GstCaps *
decodable_caps()
{
  static std::mutex mutex;
  static GstCaps *known = nullptr;
  static guint32 known_at = 0;

  std::lock_guard lock(mutex);
  const guint32 now = gst_registry_get_feature_list_cookie(gst_registry_get());
  if (known == nullptr || now != known_at)
    gst_caps_take(&known, find_decodable_caps());
  known_at = now;
  return gst_caps_ref(known);
}

GstElement *
choose_decoder(GstCaps *caps)
{
  const Features decoders = list_decoders();
  const Features parsers = list_parsers();
  g_autoptr(GstBus) bus = gst_bus_new(); // that one cannot be used is no error of the film
  gst_bus_set_flushing(bus, TRUE);
  for (const auto &[parser, decoder] : candidates(decoders, parsers, caps)) {
    GstElement *made = make(parser, decoder);
    if (made == nullptr)
      continue;
    gst_element_set_bus(made, bus);
    const bool usable = has_pads(made)
                        && gst_element_set_state(made, GST_STATE_READY) == GST_STATE_CHANGE_SUCCESS
                        && accepts(made, caps);
    gst_element_set_state(made, GST_STATE_NULL);
    gst_element_set_bus(made, nullptr);
    if (usable)
      return made;
    gst_object_unref(gst_object_ref_sink(made));
  }
  return nullptr;
}
