#include "preview/internal/shadow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "preview/internal/blocks.h"

namespace panwright::preview {
namespace {

// Uniform block of the shadow shaders, in std140.
struct alignas(16) ShadowBlock {
  float texel_depth;  // what one texel measures, as a share of the map's depth
  float half_side;    // texels
  float padding[2];
};

}  // namespace

void place_before_sun(const SunFrame& frame, const pan::layout::Mesh& mesh, const DrawItem& item,
                      bool flat, DrawBlock& block) {
  const Mat4 sun_from_mesh = frame.sun_from_model * item.model_from_mesh;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      block.sun_from_mesh[4 * row + column] = static_cast<float>(sun_from_mesh[column][row]);
  copy_floats(frame.sun_normal_from_model * item.model_normal_from_mesh,
              block.sun_normal_from_mesh);
  // a chord is as deep below the smooth surface as others stand out of it
  block.lift[0] = flat ? 0.0f : static_cast<float>(2 * mesh.error);
}

bool ShadowMap::make(const GladGLContext& gl, unsigned side, DiagnosticLog& log) {
  if (framebuffer_ && side_ == side) return true;
  framebuffer_ = {};
  depths_ = {};
  slopes_ = {};
  side_ = 0;
  const auto size = static_cast<GLsizei>(side);
  depths_ = make_texture_2d(gl, 1, GL_DEPTH_COMPONENT32F, size, size);
  slopes_ = make_texture_2d(gl, 1, GL_RG16F, size, size);
  for (const GlTexture* texture : {&depths_, &slopes_}) {
    gl.TextureParameteri(texture->id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TextureParameteri(texture->id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
  GLuint id = 0;
  gl.CreateFramebuffers(1, &id);
  framebuffer_ = GlFramebuffer(gl, id);
  gl.NamedFramebufferTexture(id, GL_DEPTH_ATTACHMENT, depths_.id(), 0);
  gl.NamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, slopes_.id(), 0);
  if (gl.CheckNamedFramebufferStatus(id, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
      gl.GetError() != GL_NO_ERROR) {
    framebuffer_ = {};
    depths_ = {};
    slopes_ = {};
    log.report_file(
        Code::E5003, {},
        fmt::format("the context has no memory for a shadow map of {} by {} texels", side, side));
    return false;
  }
  side_ = side;
  return true;
}

void ShadowMap::upload(const GladGLContext& gl, std::span<const DrawItem> list) {
  if (!blocks_) {
    stride_ = block_stride(gl, sizeof(DrawBlock));
    blocks_ = make_stream_buffer(gl);
    limits_ = make_stream_buffer(gl);
  }
  std::vector<std::byte> bytes(list.size() * stride_);
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    DrawBlock block{};
    copy_floats(frame_.sun_from_model * list[i].model_from_mesh, block.clip_from_mesh);
    block.id[0] = i + 1;
    copy_repeat(list[i], block);
    std::memcpy(bytes.data() + i * stride_, &block, sizeof block);
  }
  gl.NamedBufferData(blocks_.id(), static_cast<GLsizeiptr>(bytes.size()), bytes.data(),
                     GL_STREAM_DRAW);
  const double texel = std::max(frame_.extent.x, frame_.extent.y) / side_;
  const ShadowBlock limits{
      static_cast<float>(texel / frame_.extent.z), static_cast<float>(side_) / 2, {}};
  gl.NamedBufferData(limits_.id(), sizeof limits, &limits, GL_STREAM_DRAW);
}

bool ShadowMap::draw(const Context& context, const pan::Model& model,
                     std::span<const DrawItem> list, const GpuModel& gpu, Programs& programs,
                     const Vec3& to_sun, unsigned side, DiagnosticLog& log) {
  const GladGLContext& gl = context.gl();
  side = std::min(side, context.limits().framebuffer_side);
  if (framebuffer_ && side == side_ && to_sun == to_sun_) return true;
  to_sun_ = Vec3(0);
  std::string problem;
  for (const DrawItem& item : list)
    if (!programs.shadow(item.variant.cutout, &problem)) {
      log.report_file(Code::E5001, {},
                      fmt::format("{} refuses a shader: {}", context.renderer(), problem));
      return false;
    }
  if (!make(gl, side, log)) return false;
  frame_ = fitted_sun_frame(list, to_sun, side);
  upload(gl, list);

  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl.Viewport(0, 0, static_cast<GLsizei>(side), static_cast<GLsizei>(side));
  gl.Enable(GL_DEPTH_TEST);
  const float nothing = 0;
  gl.ClearBufferfv(GL_DEPTH, 0, &nothing);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, kShadowBinding, limits_.id());
  const DrawItem* last = nullptr;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const DrawItem& item = list[i];
    const pan::layout::Mesh& mesh = model.meshes()[item.mesh];
    if (!last || item.variant.cutout != last->variant.cutout)
      gl.UseProgram(programs.shadow(item.variant.cutout, nullptr));
    if (!last || item.closed != last->closed)
      item.closed ? gl.Enable(GL_CULL_FACE) : gl.Disable(GL_CULL_FACE);
    if (!last || item.mirrored != last->mirrored) gl.FrontFace(item.mirrored ? GL_CW : GL_CCW);
    if (item.variant.cutout) gpu.bind_maps(i);
    if (!last || item.mesh != last->mesh) gpu.bind_vertices(mesh, item.mesh);
    gl.BindBufferRange(GL_UNIFORM_BUFFER, kDrawBinding, blocks_.id(),
                       static_cast<GLintptr>(i * stride_), sizeof(DrawBlock));
    gpu.draw(mesh, item.mesh);
    last = &item;
  }
  to_sun_ = to_sun;
  return true;
}

void ShadowMap::bind(const GladGLContext& gl) const {
  gl.BindTextureUnit(kShadowDepthsUnit, depths_.id());
  gl.BindTextureUnit(kShadowSlopesUnit, slopes_.id());
  gl.BindBufferBase(GL_UNIFORM_BUFFER, kShadowBinding, limits_.id());
}

}  // namespace panwright::preview
