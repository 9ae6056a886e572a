// SPDX-License-Identifier: LGPL-2.1-or-later
#include "glshrinker.h"

#include <gst/gl/gstglfuncs.h>

#include <gmodule.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <string>
#include <utility>

namespace {

constexpr const char *kVertexShader = R"(
IN vec2 position;
void main() { gl_Position = vec4(position, 0.0, 1.0); }
)";

/// A bilinear sample at 1.2 pixels from the center weighs its two pixels 4 : 1.
constexpr const char *kHalveShader = R"(
uniform sampler2D source;
uniform vec2 size;
vec2 mirrored(vec2 pixel) { return size - 1.0 - abs(size - 1.0 - abs(pixel)); }
vec4 at(vec2 pixel) { return SAMPLE(source, (mirrored(pixel) + 0.5) / size); }
vec4 row(vec2 pixel)
{
  vec2 step = vec2(1.2, 0.0);
  return (5.0 * (at(pixel - step) + at(pixel + step)) + 6.0 * at(pixel)) / 16.0;
}
void main()
{
  vec2 pixel = 2.0 * floor(gl_FragCoord.xy);
  vec2 step = vec2(0.0, 1.2);
  COLOR = (5.0 * (row(pixel - step) + row(pixel + step)) + 6.0 * row(pixel)) / 16.0;
}
)";

/// Four pixels' values of one component become one pixel.
constexpr const char *kPackShader = R"(
uniform sampler2D source;
uniform vec2 size;
uniform vec2 origin;
uniform vec4 weights;
float at(vec2 pixel)
{
  return dot(vec4(SAMPLE(source, (min(pixel, size - 1.0) + 0.5) / size).rgb, 1.0), weights);
}
void main()
{
  vec2 pixel = (floor(gl_FragCoord.xy) - origin) * vec2(4.0, 1.0);
  vec2 next = vec2(1.0, 0.0);
  COLOR = vec4(at(pixel), at(pixel + next), at(pixel + 2.0 * next), at(pixel + 3.0 * next));
}
)";

/// The changes that the shaders above need for the language of the context.
struct Language
{
  GstGLSLVersion version;
  GstGLSLProfile profile;
  const char *vertex;
  const char *fragment;
};

Language
language_of(GstGLContext *context)
{
  const GstGLAPI api = gst_gl_context_get_gl_api(context);
  if (api & GST_GL_API_OPENGL3)
    return { GST_GLSL_VERSION_150, GST_GLSL_PROFILE_CORE, "#version 150\n#define IN in\n",
             "#version 150\n#define SAMPLE texture\n#define COLOR color\nout vec4 color;\n" };
  if (api & GST_GL_API_OPENGL)
    return { GST_GLSL_VERSION_120, GST_GLSL_PROFILE_COMPATIBILITY,
             "#version 120\n#define IN attribute\n",
             "#version 120\n#define SAMPLE texture2D\n#define COLOR gl_FragColor\n" };
  return {
    GST_GLSL_VERSION_100, GST_GLSL_PROFILE_ES, "#version 100\n#define IN attribute\n",
    "#version 100\nprecision highp float;\n#define SAMPLE texture2D\n#define COLOR gl_FragColor\n"
  };
}

GstGLShader *
compile_shader(GstGLContext *context, const char *fragment)
{
  const Language language = language_of(context);
  const auto stage = [&](guint type, const char *head, const char *body) {
    return gst_glsl_stage_new_with_string(context, type, language.version, language.profile,
                                          (std::string(head) + body).c_str());
  };
  g_autoptr(GError) error = nullptr;
  GstGLShader *shader = gst_gl_shader_new_link_with_stages(
      context, &error, stage(GL_VERTEX_SHADER, language.vertex, kVertexShader),
      stage(GL_FRAGMENT_SHADER, language.fragment, fragment), nullptr);
  if (shader == nullptr)
    GST_WARNING_OBJECT(context, "a shader is refused: %s", error ? error->message : "no reason");
  return shader;
}

/// Such a renderer shrinks on the CPU, more slowly than whole frames are read. Tests have no other.
bool
is_software(GstGLContext *context)
{
  const auto *name = reinterpret_cast<const char *>(context->gl_vtable->GetString(GL_RENDERER));
  if (name == nullptr || g_getenv("VISUOTACTILE_GL_IN_SOFTWARE") != nullptr)
    return false;
  const auto is = [name](const char *renderer) {
    return std::strstr(name, renderer) != nullptr;
  };
  return is("llvmpipe") || is("softpipe") || is("SwiftShader");
}

/// R'G'B'1 → component (ITU-R BT.709, full range).
constexpr std::array<float, 4> kLuma{ 0.2126F, 0.7152F, 0.0722F, 0 };
constexpr float kMiddle = 128.0F / 255;
constexpr std::array<float, 4> kBlueDifference{ -0.2126F / 1.8556F, -0.7152F / 1.8556F,
                                                (1 - 0.0722F) / 1.8556F, kMiddle };
constexpr std::array<float, 4> kRedDifference{ (1 - 0.2126F) / 1.5748F, -0.7152F / 1.5748F,
                                               -0.0722F / 1.5748F, kMiddle };

/// Pixels of four bytes that hold a row of so many.
int
packed_width(int samples)
{
  return (samples + 3) / 4;
}

void
run_on(GstGLContext *context, const std::function<void()> &work)
{
  gst_gl_context_thread_add(
      context,
      [](GstGLContext *, gpointer data) { (*static_cast<const std::function<void()> *>(data))(); },
      const_cast<std::function<void()> *>(&work));
}

} // namespace

/// The input of a shader.
struct GlShrinker::Source
{
  guint texture;
  int width;
  int height;
};

/// An RGBA texture of our own.
struct GlShrinker::Texture
{
  Texture(GstGLContext *context, int width_, int height_) : width(width_), height(height_)
  {
    GstVideoInfo info;
    gst_video_info_set_format(&info, GST_VIDEO_FORMAT_RGBA, static_cast<guint>(width),
                              static_cast<guint>(height));
    g_autoptr(GstGLMemoryAllocator) allocator = gst_gl_memory_allocator_get_default(context);
    GstGLVideoAllocationParams *params = gst_gl_video_allocation_params_new(
        context, nullptr, &info, 0, nullptr, GST_GL_TEXTURE_TARGET_2D, GST_GL_RGBA8);
    memory = GST_MEMORY_CAST(
        gst_gl_base_memory_alloc(GST_GL_BASE_MEMORY_ALLOCATOR(allocator),
                                 reinterpret_cast<GstGLAllocationParams *>(params)));
    gst_gl_allocation_params_free(reinterpret_cast<GstGLAllocationParams *>(params));
  }
  Texture(Texture &&other) noexcept
      : memory(std::exchange(other.memory, nullptr)), width(other.width), height(other.height)
  {
  }
  Texture &operator=(Texture &&) = delete;
  ~Texture()
  {
    if (memory)
      gst_memory_unref(memory);
  }

  Source source() const
  {
    return { gst_gl_memory_get_texture_id(reinterpret_cast<GstGLMemory *>(memory)), width, height };
  }

  GstMemory *memory; ///< NULL if the GPU has none
  int width;
  int height;
};

const GlShrinker::Texture &
GlShrinker::luma() const
{
  return levels_[levels_.size() - 2];
}

GlShrinker::GlShrinker(GstCaps *caps, int halvings)
    : caps_(gst_caps_copy(caps)), halvings_(halvings)
{
}

GlShrinker::~GlShrinker()
{
  end();
  gst_caps_unref(caps_);
}

/// Makes what lives as long as the context is in use.
bool
GlShrinker::begin(GstGLContext *context)
{
  context_ = GST_GL_CONTEXT(gst_object_ref(context));
  GstStructure *format = gst_caps_get_structure(caps_, 0);
  if (!gst_structure_has_field(format, "texture-target"))
    gst_structure_set(format, "texture-target", G_TYPE_STRING, "2D", nullptr);
  g_autoptr(GstCaps) rgba = gst_caps_copy(caps_);
  gst_caps_set_simple(rgba, "format", G_TYPE_STRING, "RGBA", "texture-target", G_TYPE_STRING, "2D",
                      "colorimetry", G_TYPE_STRING, "sRGB", nullptr);
  gst_structure_remove_field(gst_caps_get_structure(rgba, 0), "chroma-site");
  to_rgba_ = gst_gl_color_convert_new(context);
  if (!gst_gl_color_convert_set_caps(to_rgba_, caps_, rgba))
    return false;
  bool done = false;
  run_on(context_, [&] { done = compile(); });
  return done;
}

/// On the context's thread.
bool
GlShrinker::compile()
{
  if (is_software(context_))
    return false;
  const GstGLFuncs *gl = context_->gl_vtable;
  halve_ = compile_shader(context_, kHalveShader);
  pack_ = compile_shader(context_, kPackShader);
  if (!halve_ || !pack_)
    return false;
  constexpr std::array<GLfloat, 8> kCorners{ -1, -1, 1, -1, -1, 1, 1, 1 };
  gl->GenFramebuffers(1, &framebuffer_);
  gl->GenBuffers(1, &vertices_);
  gl->BindBuffer(GL_ARRAY_BUFFER, vertices_);
  gl->BufferData(GL_ARRAY_BUFFER, sizeof kCorners, kCorners.data(), GL_STATIC_DRAW);
  gl->BindBuffer(GL_ARRAY_BUFFER, 0);
  if (gl->GenVertexArrays)
    gl->GenVertexArrays(1, &vertex_array_);
  return true;
}

void
GlShrinker::end()
{
  packed_.reset();
  levels_.clear();
  width_ = height_ = 0;
  gst_clear_object(&to_rgba_);
  gst_clear_object(&halve_);
  gst_clear_object(&pack_);
  if (context_)
    run_on(context_, [this] {
      const GstGLFuncs *gl = context_->gl_vtable;
      gl->DeleteFramebuffers(1, &framebuffer_);
      gl->DeleteBuffers(1, &vertices_);
      if (vertex_array_)
        gl->DeleteVertexArrays(1, &vertex_array_);
    });
  framebuffer_ = vertices_ = vertex_array_ = 0;
  gst_clear_object(&context_);
}

bool
GlShrinker::make_textures(int width, int height)
{
  if (width == width_ && height == height_)
    return true;
  levels_.clear();
  packed_.reset();
  int w = width;
  int h = height;
  for (int n = 0; n <= halvings_; n++)
    levels_.emplace_back(context_, w = (w + 1) / 2, h = (h + 1) / 2);
  const Texture &chroma = levels_.back();
  packed_ = std::make_unique<Texture>(context_, 2 * packed_width(chroma.width),
                                      luma().height + chroma.height);
  const bool made = packed_->memory && std::ranges::all_of(levels_, &Texture::memory);
  width_ = made ? width : 0;
  height_ = made ? height : 0;
  return made;
}

/// Runs a shader over an area of the target. On the context's thread.
void
GlShrinker::fill(const Texture &target, GstGLShader *shader, const Source &source, const Area &area,
                 const std::array<float, 4> &weights)
{
  const GstGLFuncs *gl = context_->gl_vtable;
  GstMapInfo map;
  if (!gst_memory_map(target.memory, &map,
                      static_cast<GstMapFlags>(GST_MAP_WRITE | static_cast<guint>(GST_MAP_GL))))
    return;
  gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                           *reinterpret_cast<guint *>(map.data), 0);
  gl->Viewport(area.x, area.y, area.width, area.height);
  gst_gl_shader_use(shader);
  gl->ActiveTexture(GL_TEXTURE0);
  gl->BindTexture(GL_TEXTURE_2D, source.texture);
  gst_gl_shader_set_uniform_1i(shader, "source", 0);
  gst_gl_shader_set_uniform_2f(shader, "size", static_cast<float>(source.width),
                               static_cast<float>(source.height));
  if (shader == pack_) {
    gst_gl_shader_set_uniform_2f(shader, "origin", static_cast<float>(area.x),
                                 static_cast<float>(area.y));
    gst_gl_shader_set_uniform_4f(shader, "weights", weights[0], weights[1], weights[2], weights[3]);
  }
  const auto position
      = static_cast<GLuint>(gst_gl_shader_get_attribute_location(shader, "position"));
  if (vertex_array_)
    gl->BindVertexArray(vertex_array_);
  gl->BindBuffer(GL_ARRAY_BUFFER, vertices_);
  gl->EnableVertexAttribArray(position);
  gl->VertexAttribPointer(position, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  gl->DisableVertexAttribArray(position);
  gl->BindBuffer(GL_ARRAY_BUFFER, 0);
  if (vertex_array_)
    gl->BindVertexArray(0);
  gl->BindTexture(GL_TEXTURE_2D, 0);
  gst_gl_context_clear_shader(context_);
  gst_gl_context_clear_framebuffer(context_);
  gst_memory_unmap(target.memory, &map);
}

/// On the context's thread. The last call makes the GPU send the picture, without waiting for it.
bool
GlShrinker::draw(GstBuffer *rgba)
{
  GstMemory *frame = gst_buffer_peek_memory(rgba, 0);
  auto *texture = reinterpret_cast<GstGLMemory *>(frame);
  const int width = gst_gl_memory_get_texture_width(texture);
  const int height = gst_gl_memory_get_texture_height(texture);
  if (!make_textures(width, height))
    return false;
  if (GstGLSyncMeta *fence = gst_buffer_get_gl_sync_meta(rgba))
    gst_gl_sync_meta_wait(fence, context_);
  GstMapInfo map;
  if (!gst_memory_map(frame, &map,
                      static_cast<GstMapFlags>(GST_MAP_READ | static_cast<guint>(GST_MAP_GL))))
    return false;

  Source source{ *reinterpret_cast<guint *>(map.data), width, height };
  for (const Texture &target : levels_) {
    fill(target, halve_, source, { 0, 0, target.width, target.height });
    source = target.source();
  }
  const Source &y = luma().source();
  const Source &c = levels_.back().source();
  const int half = packed_->width / 2;
  fill(*packed_, pack_, y, { 0, 0, packed_->width, y.height }, kLuma);
  fill(*packed_, pack_, c, { 0, y.height, half, c.height }, kBlueDifference);
  fill(*packed_, pack_, c, { half, y.height, half, c.height }, kRedDifference);
  gst_memory_unmap(frame, &map);
  if (gst_is_gl_memory_pbo(packed_->memory))
    gst_gl_memory_pbo_download_transfer(reinterpret_cast<GstGLMemoryPBO *>(packed_->memory));
  return true;
}

/// The packed picture as I420, Cb and Cr side by side below Y.
GstBuffer *
GlShrinker::wrap(SmallPicture &picture) const
{
  const auto width = static_cast<guint>(luma().width);
  const auto height = static_cast<guint>(luma().height);
  gst_video_info_set_format(&picture.info, GST_VIDEO_FORMAT_I420, width, height);
  picture.info.colorimetry = { GST_VIDEO_COLOR_RANGE_0_255, GST_VIDEO_COLOR_MATRIX_BT709,
                               GST_VIDEO_TRANSFER_SRGB, GST_VIDEO_COLOR_PRIMARIES_BT709 };
  // Sample i is centered on pixel 2ʰ·i.
  const double scale = 1.0 / (1 << halvings_);
  const double offset = (1 - scale) / 2;
  picture.placement = { scale, scale, offset, offset };
  picture.frame_width = width_;
  picture.frame_height = height_;
  const gint stride = 4 * packed_->width;
  const gsize below = static_cast<gsize>(stride) * height;
  gsize offsets[] = { 0, below, below + static_cast<gsize>(stride / 2), 0 };
  gint strides[] = { stride, stride, stride, 0 };
  GstBuffer *buffer = gst_buffer_new();
  gst_buffer_append_memory(buffer, gst_memory_ref(packed_->memory));
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_I420, width,
                                 height, 3, offsets, strides);
  return buffer;
}

GstBuffer *
GlShrinker::shrink(GstBuffer *frame, SmallPicture &picture)
{
  GstMemory *memory = gst_buffer_n_memory(frame) > 0 ? gst_buffer_peek_memory(frame, 0) : nullptr;
  if (memory == nullptr || !gst_is_gl_memory(memory))
    return nullptr;
  GstGLContext *context = reinterpret_cast<GstGLBaseMemory *>(memory)->context;
  if (context != context_) {
    end();
    if (!begin(context)) {
      end();
      return nullptr;
    }
  }
  g_autoptr(GstBuffer) rgba = gst_gl_color_convert_perform(to_rgba_, frame);
  if (rgba == nullptr)
    return nullptr;
  bool drawn = false;
  run_on(context_, [&] { drawn = draw(rgba); });
  return drawn ? wrap(picture) : nullptr;
}

extern "C" G_MODULE_EXPORT FrameShrinker *
visuotactile_make_gl_shrinker(GstCaps *caps, int halvings)
{
  return new GlShrinker(caps, halvings);
}
