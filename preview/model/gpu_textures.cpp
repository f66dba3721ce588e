#include "preview/model/gpu_textures.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <future>
#include <set>
#include <utility>
#include <vector>

namespace panwright::preview {
namespace {

namespace layout = pan::layout;

// float texels up to this many bytes in all, half floats beyond
constexpr std::uint64_t kFloatTextureBytes = 1ull << 28;

// Slopes are half floats: within 5e-4 of themselves, and 3e-8 where they are smaller than 6e-5.
GLenum format_of(TextureRole role, bool whole) {
  if (role == TextureRole::slopes) whole = false;
  switch (channels(role)) {
    case 1:
      return whole ? GL_R32F : GL_R16F;
    case 2:
      return whole ? GL_RG32F : GL_RG16F;
    default:
      return whole ? GL_RGBA32F : GL_RGBA16F;
  }
}

// Which textures coordinates leave at the top or the bottom. Others end there: a texture around a
// sphere must not mix its poles.
std::vector<char> repeated_upwards(const pan::Model& model) {
  constexpr float kRounding = 1e-5f;
  std::vector<char> repeated(model.textures().size());
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;
  for (const layout::Instance& instance : model.instances()) {
    if (instance.texture < 0) continue;
    const auto texture = static_cast<std::uint32_t>(instance.texture);
    if (repeated[texture] || !known.emplace(texture, instance.mesh).second) continue;
    for (const layout::Float2& uv : model.mesh(instance.mesh).texcoords)
      if (uv.y < -kRounding || uv.y > 1 + kRounding) repeated[texture] = 1;
  }
  return repeated;
}

GlTexture made(const GladGLContext& gl, const std::vector<TextureLevel>& levels, GLenum format,
               bool repeated) {
  GlTexture object = make_texture_2d(gl, static_cast<GLsizei>(levels.size()), format,
                                     static_cast<GLsizei>(levels[0].width),
                                     static_cast<GLsizei>(levels[0].height));
  for (std::size_t level = 0; level < levels.size(); ++level)
    gl.TextureSubImage2D(
        object.id(), static_cast<GLint>(level), 0, 0, static_cast<GLsizei>(levels[level].width),
        static_cast<GLsizei>(levels[level].height), GL_RGBA, GL_FLOAT, levels[level].rgba.data());
  gl.TextureParameteri(object.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl.TextureParameteri(object.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.TextureParameteri(object.id(), GL_TEXTURE_WRAP_S, GL_REPEAT);
  gl.TextureParameteri(object.id(), GL_TEXTURE_WRAP_T, repeated ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  return object;
}

}  // namespace

std::uint32_t GpuTextures::number(const TextureUse& use) {
  const auto [entry, added] = numbers_.try_emplace(use, static_cast<std::uint32_t>(uses_.size()));
  if (added) uses_.push_back(use);
  return entry->second;
}

bool GpuTextures::upload(const Context& context, const pan::Model& model, DiagnosticLog& log,
                         const Job& job) {
  const GladGLContext& gl = context.gl();
  const std::vector<char> repeated = repeated_upwards(model);
  std::uint64_t bytes = 0;
  for (const TextureUse& use : uses_)
    bytes += channels(use.role) * model.textures()[static_cast<std::size_t>(use.texture)].bytes;
  const auto levels_of = [&](const TextureUse& use) {
    const auto i = static_cast<std::size_t>(use.texture);
    const layout::Texture& texture = model.textures()[i];
    return map_levels(model.texels(i), texture.width, texture.height,
                      (texture.flags & layout::kTextureLinear) != 0, use.role, use.threshold, job);
  };
  for (const TextureUse& use : uses_) {
    const auto i = static_cast<std::size_t>(use.texture);
    const layout::Texture& texture = model.textures()[i];
    if (std::max(texture.width, texture.height) > context.limits().texture_side) {
      log.report_file(Code("E5003"), model.name(),
                      fmt::format("texture '{}' is {} by {} texels; this context takes {} a side",
                                  model.texture_name(i), texture.width, texture.height,
                                  context.limits().texture_side));
      return false;
    }
  }
  // the levels of one are made while the context copies those of the one before
  const auto policy = job.threads() > 1 ? std::launch::async : std::launch::deferred;
  std::future<std::vector<TextureLevel>> next;
  for (std::size_t k = 0; k < uses_.size(); ++k) {
    const TextureUse& use = uses_[k];
    const auto i = static_cast<std::size_t>(use.texture);
    const std::vector<TextureLevel> levels = next.valid() ? next.get() : levels_of(use);
    if (k + 1 < uses_.size()) next = std::async(policy, levels_of, std::cref(uses_[k + 1]));
    textures_.push_back(
        made(gl, levels, format_of(use.role, bytes <= kFloatTextureBytes), repeated[i] != 0));
    if (!fits(gl, "textures", log)) return false;
    for (const TextureLevel& level : levels) bytes_ += level.rgba.size() * sizeof(float);
  }
  return true;
}

}  // namespace panwright::preview
