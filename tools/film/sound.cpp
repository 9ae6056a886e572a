// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound.h"

#include "command_line.h"

#include <array>
#include <string_view>
#include <vector>

const fusion::Profile *
sound_profile(const std::string &name)
{
  if (const fusion::Profile *profile = fusion::find_profile(name))
    return profile;
  std::vector<std::string_view> names{ "off" };
  for (const fusion::Profile &known : fusion::profiles())
    names.emplace_back(known.name);
  expect_one_of("--sound", name, names);
  return nullptr;
}

std::string
heard_sound(const std::string &queue, const fusion::Profile *profile)
{
  std::string line = " film. ! " + queue + " name=heard ! audioconvert name=sound ! ";
  if (profile == nullptr)
    return line;
  std::array<char, G_ASCII_DTOSTR_BUF_SIZE> gain{};
  g_ascii_dtostr(gain.data(), static_cast<gint>(gain.size()), profile->gain_db);
  return line + "soundtactile name=ear gain=" + gain.data() + " impacts="
         + (profile->impacts ? "true" : "false") + " rumble=" + (profile->rumble ? "true" : "false")
         + " ear.tactile ! queue ! both.tactile" + " ear.src ! " + queue + " ! audioconvert ! ";
}

std::string
joined_sound(const std::string &queue, const fusion::Profile *profile)
{
  if (profile == nullptr)
    return "";
  return " ! " + queue + " ! tactilecombiner name=both mix=" + tactile::name_of(profile->mix);
}

bool
end_missing_sound(GstElement *pipeline)
{
  const Owned<GstElement> queue(gst_bin_get_by_name(GST_BIN(pipeline), "heard"));
  const Owned<GstPad> pad(gst_element_get_static_pad(queue.get(), "sink"));
  if (gst_pad_is_linked(pad.get()))
    return false;
  // matroskamux of GStreamer 1.26 never goes on with a stream that ends without caps.
  if (const Owned<GstElement> mux{ gst_bin_get_by_name(GST_BIN(pipeline), "mux") })
    if (const Owned<GstPad> unheard{ gst_element_get_static_pad(mux.get(), "audio_0") })
      gst_element_release_request_pad(mux.get(), unheard.get());
  gst_pad_send_event(pad.get(), gst_event_new_stream_start("no sound"));
  gst_pad_send_event(pad.get(), gst_event_new_eos());
  return true;
}
