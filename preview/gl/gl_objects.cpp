#include "preview/gl/gl_objects.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

namespace panwright::preview {

void delete_buffer(const GladGLContext& gl, GLuint id) { gl.DeleteBuffers(1, &id); }
void delete_texture(const GladGLContext& gl, GLuint id) { gl.DeleteTextures(1, &id); }
void delete_renderbuffer(const GladGLContext& gl, GLuint id) { gl.DeleteRenderbuffers(1, &id); }
void delete_framebuffer(const GladGLContext& gl, GLuint id) { gl.DeleteFramebuffers(1, &id); }
void delete_vertex_array(const GladGLContext& gl, GLuint id) { gl.DeleteVertexArrays(1, &id); }
void delete_sampler(const GladGLContext& gl, GLuint id) { gl.DeleteSamplers(1, &id); }
void delete_program(const GladGLContext& gl, GLuint id) { gl.DeleteProgram(id); }

GlBuffer make_buffer(const GladGLContext& gl, const void* data, std::size_t bytes) {
  GlBuffer buffer = make_stream_buffer(gl);
  // note: OpenGL has no empty buffer storage
  constexpr char kNothing[16] = {};
  if (bytes == 0)
    gl.NamedBufferStorage(buffer.id(), sizeof kNothing, kNothing, 0);
  else
    gl.NamedBufferStorage(buffer.id(), static_cast<GLsizeiptr>(bytes), data, 0);
  return buffer;
}

GlBuffer make_stream_buffer(const GladGLContext& gl) {
  GLuint id = 0;
  gl.CreateBuffers(1, &id);
  return {gl, id};
}

GlTexture make_texture_2d(const GladGLContext& gl, GLsizei levels, GLenum format, GLsizei width,
                          GLsizei height) {
  GLuint id = 0;
  gl.CreateTextures(GL_TEXTURE_2D, 1, &id);
  gl.TextureStorage2D(id, levels, format, width, height);
  return {gl, id};
}

GlTexture make_texture_array(const GladGLContext& gl, GLenum format, GLsizei width, GLsizei height,
                             GLsizei layers) {
  GLuint id = 0;
  gl.CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
  gl.TextureStorage3D(id, 1, format, width, height, layers);
  return {gl, id};
}

GlVertexArray make_vertex_array(const GladGLContext& gl) {
  GLuint id = 0;
  gl.CreateVertexArrays(1, &id);
  return {gl, id};
}

GlTexture make_buffer_texture(const GladGLContext& gl) {
  GLuint id = 0;
  gl.CreateTextures(GL_TEXTURE_BUFFER, 1, &id);
  return {gl, id};
}

GlSampler make_sampler(const GladGLContext& gl, GLint wrap) {
  GLuint id = 0;
  gl.CreateSamplers(1, &id);
  gl.SamplerParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl.SamplerParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.SamplerParameteri(id, GL_TEXTURE_WRAP_S, wrap);
  gl.SamplerParameteri(id, GL_TEXTURE_WRAP_T, wrap);
  return {gl, id};
}

StreamBuffer::StreamBuffer(const GladGLContext& gl) : gl_(gl), buffer_(make_stream_buffer(gl)) {}

std::size_t StreamBuffer::upload(std::span<const std::byte> bytes, std::size_t behind) {
  if (bytes.size() + behind > region_bytes_) {
    // powers of two hold whatever alignment a context asks for
    region_bytes_ = std::bit_ceil(std::max(bytes.size() + behind, std::size_t{4096}));
    gl_.NamedBufferData(buffer_.id(), static_cast<GLsizeiptr>(kRegions * region_bytes_), nullptr,
                        GL_STREAM_DRAW);
  }
  region_ = (region_ + 1) % kRegions;
  const std::size_t offset = region_ * region_bytes_;
  if (!bytes.empty())
    gl_.NamedBufferSubData(buffer_.id(), static_cast<GLintptr>(offset),
                           static_cast<GLsizeiptr>(bytes.size()), bytes.data());
  return offset;
}

bool fits(const GladGLContext& gl, const char* what, DiagnosticLog& log) {
  bool good = true;
  for (GLenum error = gl.GetError(); error != GL_NO_ERROR; error = gl.GetError()) good = false;
  if (!good)
    log.report_file(Code("E5003"), {},
                    fmt::format("the context has no memory for the model's {}", what));
  return good;
}

void set_nearest(const GladGLContext& gl, GLuint texture) {
  gl.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

RenderTarget make_render_target(const GladGLContext& gl, std::span<const GLenum> color_formats,
                                bool depth, GLsizei width, GLsizei height) {
  RenderTarget target;
  GLuint id = 0;
  gl.CreateFramebuffers(1, &id);
  target.framebuffer = GlFramebuffer(gl, id);
  constexpr GLenum kAttachments[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                     GL_COLOR_ATTACHMENT2, GL_COLOR_ATTACHMENT3,
                                     GL_COLOR_ATTACHMENT4, GL_COLOR_ATTACHMENT5};
  for (std::size_t i = 0; i < color_formats.size(); ++i) {
    if (color_formats[i] == GL_NONE) continue;
    target.formats[i] = color_formats[i];
    target.colors[i] = make_texture_2d(gl, 1, color_formats[i], width, height);
    set_nearest(gl, target.colors[i].id());
    gl.NamedFramebufferTexture(id, kAttachments[i], target.colors[i].id(), 0);
  }
  gl.NamedFramebufferDrawBuffers(id, static_cast<GLsizei>(color_formats.size()), kAttachments);
  if (depth) {
    target.depth = make_texture_2d(gl, 1, GL_DEPTH_COMPONENT32F, width, height);
    set_nearest(gl, target.depth.id());
    gl.NamedFramebufferTexture(id, GL_DEPTH_ATTACHMENT, target.depth.id(), 0);
  }
  if (gl.CheckNamedFramebufferStatus(id, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) {
    target.width = width;
    target.height = height;
  }
  return target;
}

bool ensure_render_target(const GladGLContext& gl, RenderTarget& target,
                          std::span<const GLenum> formats, bool depth, std::uint32_t width,
                          std::uint32_t height, std::uint64_t most_samples, DiagnosticLog& log) {
  const auto w = static_cast<GLsizei>(width);
  const auto h = static_cast<GLsizei>(height);
  bool enough = target.width >= w && target.height >= h;
  std::array<GLenum, std::tuple_size_v<decltype(RenderTarget::formats)>> all{};
  std::copy(formats.begin(), formats.end(), all.begin());
  for (std::size_t i = 0; i < formats.size(); ++i) {
    enough = enough && (formats[i] == GL_NONE || target.colors[i]);
    // what another world needed stays, or two in turn would make it anew each time
    if (all[i] == GL_NONE && target.width != 0) all[i] = target.formats[i];
  }
  if (enough) return true;
  // views that follow differ by a little, and fresh memory costs as much as a draw
  const auto rounded = [](GLsizei side) { return (side + 127) / 128 * 128; };
  GLsizei wider = std::max(rounded(w), target.width);
  GLsizei higher = std::max(rounded(h), target.height);
  if (static_cast<std::uint64_t>(wider) * static_cast<std::uint64_t>(higher) > most_samples) {
    wider = w;
    higher = h;
  }
  // Software contexts build every program again for textures whose sides are powers of two: no
  // target of a common size has such a side.
  constexpr GLsizei kCommonSide = 8192;
  for (GLsizei* side : {&wider, &higher})
    if (std::has_single_bit(static_cast<unsigned>(*side)) && *side < kCommonSide) *side += 64;
  target = {};  // first, so that memory need not hold both
  target = make_render_target(gl, std::span(all).first(formats.size()), depth, wider, higher);
  if (target.width != 0 && gl.GetError() == GL_NO_ERROR) return true;
  target = {};
  log.report_file(Code("E5003"), {},
                  fmt::format("the context has no memory for a framebuffer of {} by {} samples",
                              wider, higher));
  return false;
}

ClearRegion::ClearRegion(const GladGLContext& gl, const RenderTarget& target, std::uint32_t width,
                         std::uint32_t height)
    : gl_(gl),
      is_part_(2 * std::uint64_t{width} * height < static_cast<std::uint64_t>(target.width) *
                                                       static_cast<std::uint64_t>(target.height)) {
  if (!is_part_) return;
  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Scissor(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
}

ClearRegion::~ClearRegion() {
  if (is_part_) gl_.Disable(GL_SCISSOR_TEST);
}

GlProgram request_program(const GladGLContext& gl, const std::string& vertex,
                          const std::string& fragment) {
  GlProgram program(gl, gl.CreateProgram());
  const auto attach = [&](GLenum stage, const std::string& text) {
    const GLuint shader = gl.CreateShader(stage);
    const char* source = text.c_str();
    gl.ShaderSource(shader, 1, &source, nullptr);
    gl.CompileShader(shader);
    gl.AttachShader(program.id(), shader);
    gl.DeleteShader(shader);  // lives on as long as the program
  };
  attach(GL_VERTEX_SHADER, vertex);
  attach(GL_FRAGMENT_SHADER, fragment);
  gl.LinkProgram(program.id());
  return program;
}

std::string problem_of_program(const GladGLContext& gl, GLuint program) {
  GLint good = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &good);
  if (good) return {};
  std::string words(4096, '\0');
  GLsizei length = 0;
  std::array<GLuint, 2> shaders{};
  GLsizei count = 0;
  gl.GetAttachedShaders(program, 2, &count, shaders.data());
  for (GLsizei i = 0; i < count && length == 0; ++i) {
    gl.GetShaderiv(shaders[static_cast<std::size_t>(i)], GL_COMPILE_STATUS, &good);
    if (!good)
      gl.GetShaderInfoLog(shaders[static_cast<std::size_t>(i)], static_cast<GLsizei>(words.size()),
                          &length, words.data());
  }
  if (length == 0)
    gl.GetProgramInfoLog(program, static_cast<GLsizei>(words.size()), &length, words.data());
  return length > 0 ? words.substr(0, static_cast<std::size_t>(length)) : "it does not link";
}

}  // namespace panwright::preview
