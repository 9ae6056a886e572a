// SPDX-License-Identifier: LGPL-2.1-or-later
//
// center-weight, sensitivity and density of saliencytactile, set and driven by controllers.
// libs/tactile_mapping and density test what they compute.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "painted_frame.h"
#include "support/tolerance.h"
#include <gst/controller/gstdirectcontrolbinding.h>
#include <gst/controller/gstinterpolationcontrolsource.h>

#include "support/check_tests.h"

namespace {

/// The contrast in ΔE that gives a level, and the level of a contrast, of 0.2 + 0.8 (1 − exp(−(e −
/// 4) / 25)).
double
contrast_of(gfloat level)
{
  return 4 - 25 * std::log(1 - (static_cast<double>(level) - 0.2) / 0.8);
}

double
level_of(double contrast)
{
  return 0.2 + 0.8 * (1 - std::exp(-(contrast - 4) / 25));
}

/// A square that is faint enough not to saturate.
Paint
faint_square()
{
  return square(160, 120, 24, 180);
}

/// The strength that gives a level of a film, and the level of a strength, of 0.3 + 0.7 (1 + ln
/// strength / ln 30).
double
strength_of(gfloat level)
{
  return std::pow(30, (static_cast<double>(level) - 0.3) / 0.7 - 1);
}

double
relative_level(double strength)
{
  return 0.3 + 0.7 * std::clamp(1 + std::log(strength) / std::log(30), 0.0, 1.0);
}

/// The middle level when the faint square has appeared, or is there.
gfloat
level(const std::string &properties)
{
  Analysis analysis("saliencytactile " + properties, kCaps);
  for (guint i = 0; i < 12; i++)
    analysis.felt(frame(i, nothing));
  gfloat level = 0;
  for (guint i = 12; i < 14; i++)
    level = analysis.felt(frame(i, faint_square()))[4];
  return level;
}

/// Sets a property by a controller: values at seconds, linear between them.
void
control(GstElement *element, const char *property,
        const std::vector<std::pair<double, double>> &values)
{
  g_autoptr(GstControlSource) source = gst_interpolation_control_source_new();
  g_object_set(source, "mode", GST_INTERPOLATION_MODE_LINEAR, nullptr);
  for (const auto &[seconds, value] : values)
    fail_unless(gst_timed_value_control_source_set(
        GST_TIMED_VALUE_CONTROL_SOURCE(source),
        static_cast<GstClockTime>(std::llround(seconds * GST_SECOND)), value));
  fail_unless(gst_object_add_control_binding(
      GST_OBJECT(element),
      gst_direct_control_binding_new_absolute(GST_OBJECT(element), property, source)));
}

} // namespace

/// Of two equal squares that of the middle wins more the higher the weight; by default less on
/// films.
CHECK_TEST(test_center_weight)
{
  const Paint two = both(square(53, 120, 24), square(160, 120, 24));
  const auto ratio = [&](const std::string &properties) {
    Analysis analysis("saliencytactile threshold=0 " + properties, kCaps);
    for (guint i = 0; i < 12; i++)
      analysis.felt(frame(i, nothing));
    std::vector<gfloat> levels;
    for (guint i = 12; i < 14; i++)
      levels = analysis.felt(frame(i, two));
    fail_unless(levels[4] > 0);
    return static_cast<double>(levels[3]) / static_cast<double>(levels[4]);
  };
  for (const std::string profile : { "", "temporal=false " }) {
    const double even = ratio(profile + "center-weight=0");
    for (const double weight :
         { 0.5, 0.7, 1.0 }) // the Gaussian at a third of the width is 0.411112
      fail_unless_near(ratio(profile + "center-weight=" + std::to_string(weight)),
                       even * (1 - weight * (1 - 0.411112)), 1e-5);
    const double own = profile.empty() ? 0.4 : 0.7;
    fail_unless_near(ratio(profile), even * (1 - own * (1 - 0.411112)), 1e-5);
  }
}

/// Sensitivity is a factor on an event's contrast, for its level and for the floor.
CHECK_TEST(test_sensitivity)
{
  const std::string still = "temporal=false ";
  const double floor = 4;
  const double contrast = contrast_of(level(still));
  fail_unless(contrast > 1.2 * floor && contrast < 60, "%g", contrast);
  for (const double factor : { 0.1, 0.6, 1.0, 1.7, 10.0 }) {
    const gfloat got = level(still + "sensitivity=" + std::to_string(factor));
    const double felt = factor * contrast;
    fail_unless_near(got, felt > floor ? level_of(felt) : 0, 1e-4);
  }
  // A floor that is set is in ΔE as perceived, too.
  const std::string higher = still + "floor=" + std::to_string(1.2 * contrast) + " sensitivity=";
  fail_unless(level(higher + "1.1") == 0);
  fail_unless_near(level(higher + "1.3"), level_of(1.3 * contrast), 1e-4);

  // In films, of an event's strength.
  const double strength = strength_of(level(""));
  fail_unless(strength > 0.1 && strength < 0.9, "%g", strength);
  for (const double factor : { 0.8, 1.0, 1.7, 10.0 })
    fail_unless_near(level("sensitivity=" + std::to_string(factor)),
                     relative_level(factor * strength), 1e-4);
  fail_unless(level("sensitivity=0.1") == 0);
  int felt = 0;
  for (const double of : { 5.0, 10.0, 20.0, 40.0, 80.0, 160.0 }) {
    const gfloat plain = level("floor=" + std::to_string(of));
    const gfloat both = level("floor=" + std::to_string(2 * of) + " sensitivity=2");
    fail_unless((plain > 0) == (both > 0), "floor %g", of);
    felt += plain > 0 ? 1 : 0;
  }
  fail_unless(felt > 0 && felt < 6);
  // The paper has neither floor nor gain.
  fail_unless(level("profile=paper") > 0);
  for (const char *factor : { "0.1", "10" })
    fail_unless(level(std::string("profile=paper sensitivity=") + factor)
                == level("profile=paper"));
}

/// A square that stays is felt until the floor has risen to it, and again after a gap, by the rates
/// of tactile::DensityControl. Jumps within the stream do not bring it back; a flush, a new segment
/// and new caps do.
CHECK_TEST(test_density)
{
  const double contrast = contrast_of(level("temporal=false"));
  // Off when ½ e^(0.5 · 0.9 t) · 0.8 = 1.
  const double off = std::log(2 / 0.8) / (0.5 * 0.9);
  const std::string line
      = "saliencytactile temporal=false density=0.1 floor=" + std::to_string(contrast / 2);
  Analysis analysis(line, kCaps);
  guint number = 0;
  const auto expect_new = [&](bool discont) {
    for (guint i = 0; i < 90; i++) {
      GstBuffer *buffer = frame(number++, faint_square());
      if (discont && i == 0)
        GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
      const double time = i / 30.0;
      if (std::abs(time - off) > 0.05)
        fail_unless(any(analysis.felt(buffer)) == (time < off), "%g s", time);
      else
        analysis.felt(buffer);
    }
  };
  expect_new(false);
  GstBuffer *jump = frame(number++, faint_square());
  GST_BUFFER_FLAG_SET(jump, GST_BUFFER_FLAG_DISCONT);
  fail_if(any(analysis.felt(jump)));
  analysis.push_segment();
  expect_new(false);
  analysis.flush();
  expect_new(true);
  analysis.set_caps(
      "video/x-raw,format=RGB,width=320,height=240,framerate=30/1,pixel-aspect-ratio=2/1");
  expect_new(false);
  number = 0; // back in time
  expect_new(false);
}

/// Controllers change the maps of the frames to which they apply.
CHECK_TEST(test_controllers)
{
  const double contrast = contrast_of(level("temporal=false"));
  Analysis analysis("saliencytactile temporal=false", kCaps);
  control(analysis.element, "sensitivity", { { 0, 0.1 }, { 1, 2.1 } });
  for (guint i = 0; i < 30; i++) {
    const double felt = (0.1 + 2 * i / 30.0) * contrast;
    const gfloat got = analysis.felt(frame(i, faint_square()))[4];
    if (std::abs(felt - 4) > 0.01)
      fail_unless_near(got, felt > 4 ? level_of(felt) : 0, 1e-4);
  }

  // Any of the time for a second, then a tenth.
  Analysis limited("saliencytactile temporal=false floor=" + std::to_string(contrast / 2), kCaps);
  control(limited.element, "density", { { 0, 0 }, { 0.99, 0 }, { 1, 0.1 }, { 9, 0.1 } });
  const double off = 1 + std::log(2 / 0.8) / (0.5 * 0.9);
  for (guint i = 0; i < 105; i++) {
    const bool is_felt = any(limited.felt(frame(i, faint_square())));
    if (std::abs(i / 30.0 - off) > 0.05)
      fail_unless(is_felt == (i / 30.0 < off), "frame %u", i);
  }

  Analysis centered("saliencytactile temporal=false threshold=0.5", kCaps);
  control(centered.element, "center-weight", { { 0, 0 }, { 1, 1 } });
  const Paint two = both(square(53, 120, 24), square(160, 120, 24));
  fail_unless(centered.felt(frame(0, two))[3] > 0);
  fail_unless(centered.felt(frame(30, two))[3] == 0);
}

/// Ranges, defaults, and that all three are controllable while playing.
CHECK_TEST(test_properties)
{
  const struct
  {
    const char *name;
    double least;
    double most;
    double value;
  } properties[]
      = { { "center-weight", -1, 1, -1 }, { "sensitivity", 0.1, 10, 1 }, { "density", 0, 1, 0 } };
  g_autoptr(GstElement) element = gst_element_factory_make("saliencytactile", nullptr);
  for (const auto &[name, least, most, value] : properties) {
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), name);
    fail_unless(spec != nullptr && G_IS_PARAM_SPEC_DOUBLE(spec));
    fail_unless_near(G_PARAM_SPEC_DOUBLE(spec)->minimum, least, 0);
    fail_unless_near(G_PARAM_SPEC_DOUBLE(spec)->maximum, most, 0);
    gdouble got = 99;
    g_object_get(element, name, &got, nullptr);
    fail_unless_near(got, value, 0);
    constexpr guint kFlags = GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING;
    ck_assert_uint_eq(spec->flags & kFlags, kFlags);
  }
}

CHECK_MAIN(saliencytactile_controls)
