#include "preview/frame/caster_draws.h"

#include <bit>
#include <cstring>

#include "preview/frame/block_stream.h"
#include "preview/frame/blocks.h"
#include "preview/gl/programs.h"

namespace panwright::preview {
namespace {

// Software contexts build every program again for textures whose sides are powers of two, and tiles
// make sides of any length: no side is one, as with other targets (gl_objects.h).
GLsizei texture_side(std::size_t texels, std::uint32_t most) {
  const auto side = static_cast<std::uint32_t>(texels);
  return static_cast<GLsizei>(std::has_single_bit(side) && side + 64 <= most ? side + 64 : side);
}

}  // namespace

bool MapLayers::make(const GladGLContext& gl, std::size_t columns, std::size_t rows,
                     std::uint32_t most, int layers) {
  *this = {};  // first, so that memory need not hold both
  width = texture_side(columns, most);
  height = texture_side(rows, most);
  depths = make_texture_array(gl, GL_DEPTH_COMPONENT32F, width, height, layers);
  slopes = make_texture_array(gl, GL_RG16F, width, height, layers);
  ViewBlock block{};  // the map is one tile
  block.half_map[0] = static_cast<float>(columns) / 2;
  block.half_map[1] = static_cast<float>(rows) / 2;
  view = make_buffer(gl, &block, sizeof block);
  for (const GlTexture* texture : {&depths, &slopes}) set_nearest(gl, texture->id());
  GLuint id = 0;
  gl.CreateFramebuffers(1, &id);
  framebuffer = GlFramebuffer(gl, id);
  gl.NamedFramebufferTextureLayer(id, GL_DEPTH_ATTACHMENT, depths.id(), 0, 0);
  gl.NamedFramebufferTextureLayer(id, GL_COLOR_ATTACHMENT0, slopes.id(), 0, 0);
  if (gl.CheckNamedFramebufferStatus(id, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE &&
      gl.GetError() == GL_NO_ERROR)
    return true;
  *this = {};
  return false;
}

void MapLayers::begin(const GladGLContext& gl, int layer) const {
  gl.NamedFramebufferTextureLayer(framebuffer.id(), GL_DEPTH_ATTACHMENT, depths.id(), 0, layer);
  gl.NamedFramebufferTextureLayer(framebuffer.id(), GL_COLOR_ATTACHMENT0, slopes.id(), 0, layer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  gl.Enable(GL_DEPTH_TEST);
  const float nothing = 0;
  gl.ClearBufferfv(GL_DEPTH, 0, &nothing);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, kViewBinding, view.id());
}

void CasterDraws::clear() {
  draws_.clear();
  blocks_.clear();
}

void CasterDraws::add(const GladGLContext& gl, std::uint32_t target, std::uint32_t item,
                      std::uint32_t part, bool clamped, const DrawItem& from,
                      const Mat4& clip_from_mesh, const CasterMesh* mesh) {
  if (!stream_) {
    stride_ = block_stride(gl, sizeof(DrawBlock));
    stream_.emplace(gl);
  }
  DrawBlock block{};
  copy_floats(clip_from_mesh, block.clip_from_mesh);
  block.id = item + 1;
  copy_repeat(from, block);
  draws_.push_back({target, item, part, clamped, mesh});
  blocks_.resize(blocks_.size() + stride_);
  std::memcpy(blocks_.data() + blocks_.size() - stride_, &block, sizeof block);
}

bool CasterDraws::draw(Device::Impl& device, const TargetStates& states,
                       const std::function<void(std::uint32_t part)>& begin_part, bool all_sides,
                       const Job& job) {
  if (draws_.empty()) return true;
  const GladGLContext& gl = device.context->gl();
  // what is bound of the last blocks reaches beyond them
  const std::size_t first_block = stream_->upload(blocks_, kInstancesAtOnce * stride_);
  const auto item_at = [&](std::size_t k) -> const DrawItem& {
    return states[draws_[k].target].items()[draws_[k].item];
  };
  const auto sides_of = [&](const DrawItem& item) { return all_sides ? Sides::both : item.sides; };
  const DrawItem* last = nullptr;
  const Draw* before = nullptr;
  bool were_instanced = false;
  bool good = true;
  std::size_t at_once = 1;
  for (std::size_t k = 0; k < draws_.size() && good; k += at_once) {
    const Draw& one = draws_[k];
    std::size_t end = k;  // of its target's
    while (end < draws_.size() && end - k < kInstancesAtOnce && draws_[end].target == one.target &&
           draws_[end].part == one.part && draws_[end].mesh == one.mesh)
      ++end;
    at_once = drawn_at_once(k, end, item_at);
    const bool instanced = at_once > 1;
    const TargetState& state = states[one.target];
    const GpuModel& gpu = state.model().gpu;
    const DrawItem& item = item_at(k);
    const pan::layout::Mesh& mesh = state.model().model->meshes()[item.mesh];
    if (!before || one.part != before->part) begin_part(one.part);
    if (!before || one.target != before->target) last = nullptr;
    if (!before || one.clamped != before->clamped)
      one.clamped ? gl.Enable(GL_DEPTH_CLAMP) : gl.Disable(GL_DEPTH_CLAMP);
    if (!last || item.variant.cutout != last->variant.cutout || instanced != were_instanced)
      gl.UseProgram(device.programs.shadow(item.variant.cutout, instanced));
    if (!last || item.sides != last->sides) cull(gl, sides_of(item));
    if (!last || item.mirrored != last->mirrored) gl.FrontFace(item.mirrored ? GL_CW : GL_CCW);
    if (item.variant.cutout) gpu.bind_maps(one.item);
    if (!last || item.mesh != last->mesh || one.mesh != before->mesh)
      one.mesh ? one.mesh->bind_vertices(gl) : gpu.bind_vertices(mesh, item.mesh);
    gl.BindBufferRange(
        GL_UNIFORM_BUFFER, kDrawBinding, stream_->id(),
        static_cast<GLintptr>(first_block + k * stride_),
        static_cast<GLsizeiptr>((instanced ? kInstancesAtOnce : 1) * sizeof(DrawBlock)));
    if (one.mesh) {
      good = !job.cancelled();
      one.mesh->draw(gl, at_once);
    } else {
      good = gpu.draw(mesh, item.mesh, at_once, job, 0, mesh.triangle_count);
    }
    were_instanced = instanced;
    last = &item;
    before = &one;
  }
  gl.Disable(GL_DEPTH_CLAMP);
  return good;
}

}  // namespace panwright::preview
