// Self-deleting OpenGL objects. Private to preview.
#pragma once

#include <glad/gl.h>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "base/diagnostic.h"

namespace panwright::preview {

// Object name. The context must be current when it is created, used and destroyed.
template <void (*Delete)(const GladGLContext&, GLuint)>
class GlObject {
 public:
  GlObject() = default;
  GlObject(const GladGLContext& gl, GLuint id) : gl_(&gl), id_(id) {}
  GlObject(GlObject&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~GlObject() {
    if (id_ != 0) Delete(*gl_, id_);
  }
  GLuint id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }

 private:
  const GladGLContext* gl_ = nullptr;
  GLuint id_ = 0;
};

void delete_buffer(const GladGLContext& gl, GLuint id);
void delete_texture(const GladGLContext& gl, GLuint id);
void delete_renderbuffer(const GladGLContext& gl, GLuint id);
void delete_framebuffer(const GladGLContext& gl, GLuint id);
void delete_vertex_array(const GladGLContext& gl, GLuint id);
void delete_sampler(const GladGLContext& gl, GLuint id);
void delete_program(const GladGLContext& gl, GLuint id);

using GlBuffer = GlObject<delete_buffer>;
using GlTexture = GlObject<delete_texture>;
using GlRenderbuffer = GlObject<delete_renderbuffer>;
using GlFramebuffer = GlObject<delete_framebuffer>;
using GlVertexArray = GlObject<delete_vertex_array>;
using GlSampler = GlObject<delete_sampler>;
using GlProgram = GlObject<delete_program>;

// Makes an immutable buffer with these bytes; without data: one for repeated uploads.
GlBuffer make_buffer(const GladGLContext& gl, const void* data, std::size_t bytes);
GlBuffer make_stream_buffer(const GladGLContext& gl);
GlTexture make_texture_2d(const GladGLContext& gl, GLsizei levels, GLenum format, GLsizei width,
                          GLsizei height);
GlTexture make_texture_array(const GladGLContext& gl, GLenum format, GLsizei width, GLsizei height,
                             GLsizei layers);
GlVertexArray make_vertex_array(const GladGLContext& gl);

// Makes a texture that reads a range of a buffer; the range is set later.
GlTexture make_buffer_texture(const GladGLContext& gl);

// Makes a sampler, linear between texels and levels; the wrap is that of both coordinates.
GlSampler make_sampler(const GladGLContext& gl, GLint wrap);

// Buffer of per-draw data, with a few regions in turn, so that uploads do not wait for draws under
// way. It grows, and never shrinks.
class StreamBuffer {
 public:
  explicit StreamBuffer(const GladGLContext& gl);

  // Returns the offset of the bytes, aligned for uniform blocks. behind: further bytes that may be
  // bound with them, of any value.
  std::size_t upload(std::span<const std::byte> bytes, std::size_t behind = 0);
  GLuint id() const { return buffer_.id(); }

 private:
  static constexpr std::size_t kRegions = 3;
  const GladGLContext& gl_;
  GlBuffer buffer_;
  std::size_t region_bytes_ = 0;
  std::size_t region_ = 0;
};

// Returns true if all allocations since the last call succeeded. Fails: E5003, naming a part of the
// model.
bool fits(const GladGLContext& gl, const char* what, DiagnosticLog& log);

// Framebuffer over textures, with or without a D32F depth texture.
struct RenderTarget {
  std::array<GlTexture, 6> colors;  // those after the first may be empty
  std::array<GLenum, 6> formats{};  // GL_NONE: empty
  GlTexture depth;
  GlFramebuffer framebuffer;
  GLsizei width = 0;  // 0: the context could not create it
  GLsizei height = 0;
};
// Of textures that shaders read by texels: all with one state, as software contexts build programs
// anew for another.
void set_nearest(const GladGLContext& gl, GLuint texture);

// color_formats: GL_NONE leaves a place empty.
RenderTarget make_render_target(const GladGLContext& gl, std::span<const GLenum> color_formats,
                                bool depth, GLsizei width, GLsizei height);

// Enlarges a target to at least this size and these colours, or keeps it. A different shape is made
// anew at exactly that shape once both together pass `most_samples`.
// Fails: E5003.
bool ensure_render_target(const GladGLContext& gl, RenderTarget& target,
                          std::span<const GLenum> formats, bool depth, std::uint32_t width,
                          std::uint32_t height, std::uint64_t most_samples, DiagnosticLog& log);

// Scope in which clearing a bound target covers its first width × height, or all of it if that is
// most of it, which is faster.
class ClearRegion {
 public:
  ClearRegion(const GladGLContext& gl, const RenderTarget& target, std::uint32_t width,
              std::uint32_t height);
  ~ClearRegion();
  ClearRegion(const ClearRegion&) = delete;
  ClearRegion& operator=(const ClearRegion&) = delete;

 private:
  const GladGLContext& gl_;
  bool is_part_ = false;
};

// Requests a program from the driver without waiting: drivers with compile threads build several at
// once until one is queried.
GlProgram request_program(const GladGLContext& gl, const std::string& vertex,
                          const std::string& fragment);
// Waits for a program. Our shaders are part of it, so a failure is a bug or a broken driver.
// Returns the driver's message; empty: success.
std::string problem_of_program(const GladGLContext& gl, GLuint program);

}  // namespace panwright::preview
