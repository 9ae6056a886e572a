// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "gst/saliency/frameshrinker.h"

#include <gst/gl/gl.h>

#include <array>
#include <memory>
#include <vector>

/// Shrinks frames in OpenGL textures on the GPU and reads the small pictures alone, as Y'CbCr 4:2:0
/// (BT.709, full range): 1.5 bytes a pixel. Each halving is that of the pyramid, [1 4 6 4 1]/16
/// with mirrored borders, so that maps are those of the frame itself but for rounding.
///
/// Where OpenGL is Mesa's software renderer, no frame is shrunk, unless
/// $VISUOTACTILE_GL_IN_SOFTWARE is set.
///
/// OpenGL is called on the thread of the frames' context. The reading begins there, and mapping the
/// picture waits for its end.
class GlShrinker : public FrameShrinker
{
public:
  /// `caps` are the frames', with the feature memory:GLMemory; at least one halving.
  GlShrinker(GstCaps *caps, int halvings);
  ~GlShrinker() override;
  GlShrinker(const GlShrinker &) = delete;
  GlShrinker &operator=(const GlShrinker &) = delete;

  GstBuffer *shrink(GstBuffer *frame, SmallPicture &picture) override;

private:
  struct Source;
  struct Texture;
  struct Area
  {
    int x;
    int y;
    int width;
    int height;
  };

  bool begin(GstGLContext *context);
  void end();
  bool compile();
  bool draw(GstBuffer *rgba);
  bool make_textures(int width, int height);
  void fill(const Texture &target, GstGLShader *shader, const Source &source, const Area &area,
            const std::array<float, 4> &weights = {});
  const Texture &luma() const;
  GstBuffer *wrap(SmallPicture &picture) const;

  GstCaps *caps_;
  const int halvings_;
  GstGLContext *context_ = nullptr;
  GstGLColorConvert *to_rgba_ = nullptr;
  GstGLShader *halve_ = nullptr;
  GstGLShader *pack_ = nullptr;
  guint framebuffer_ = 0;
  guint vertices_ = 0;
  guint vertex_array_ = 0;
  int width_ = 0; ///< of the frames
  int height_ = 0;
  std::vector<Texture> levels_;     ///< from the first halving on, and one more for chroma
  std::unique_ptr<Texture> packed_; ///< the texture that is read
};
