#include "preview/frame/indirect.h"

#include <algorithm>

namespace panwright::preview {
namespace {

bool fits_texture(const GladGLContext& gl, const light::SurfelGrid& grid, DiagnosticLog& log) {
  GLint most = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (std::max({grid.cells.size(), grid.entries.size(), grid.limits.size()}) <=
      static_cast<std::size_t>(most))
    return true;
  log.report_file(Code("E5003"), {},
                  "light between surfaces takes more than the context's buffers hold",
                  "--indirect off leaves it out");
  return false;
}

// Three texels a surfel: its place, its irradiance and where that comes from.
std::vector<std::array<float, 4>> interleaved(const light::SurfelLight& light) {
  std::vector<std::array<float, 4>> texels;
  texels.reserve(3 * light.irradiance.size());
  for (std::size_t i = 0; i < light.irradiance.size(); ++i) {
    const auto& rgb = light.irradiance[i];
    texels.push_back(light.grid->surfels[i]);
    texels.push_back(rgb);
    const light::SurfelSides sides = light.sides.empty() ? light::SurfelSides{} : light.sides[i];
    texels.push_back({sides.across.x, sides.across.y, sides.across.z, sides.packed()});
  }
  return texels;
}

}  // namespace

void Indirect::begin_image(const RenderOptions& options) {
  light_ = options.indirect;
  mirrors_apart_ = options.mirrors_apart;
  const auto wanted = [&](const std::unique_ptr<Grid>& grid) {
    return light_ != nullptr && std::ranges::any_of(*light_, [&](const light::SurfelLight& light) {
             return light.grid && light.grid->stamp == grid->stamp;
           });
  };
  std::erase_if(grids_, [&](const auto& grid) { return !wanted(grid); });
}

Indirect::Grid& Indirect::grid_of(const GladGLContext& gl, const light::SurfelLight& light) {
  const auto known =
      std::ranges::find(grids_, light.grid->stamp, [](const auto& grid) { return grid->stamp; });
  if (known != grids_.end()) return **known;
  Grid& grid = *grids_.emplace_back(std::make_unique<Grid>());
  grid.stamp = light.grid->stamp;
  const auto make = [&](GLenum form, const auto& values, GlBuffer& buffer, GlTexture& texture) {
    buffer = make_buffer(gl, values.data(), values.size() * sizeof values[0]);
    texture = make_buffer_texture(gl);
    gl.TextureBuffer(texture.id(), form, buffer.id());
  };
  make(GL_RGBA32UI, light.grid->cells, grid.cells, grid.cells_texture);
  make(GL_R16UI, light.grid->entries, grid.entries, grid.entries_texture);
  static const std::vector<std::array<float, 4>> kNone(1);
  make(GL_RGBA32F, light.grid->limits.empty() ? kNone : light.grid->limits, grid.limits,
       grid.limits_texture);
  grid.light_texture = make_buffer_texture(gl);
  return grid;
}

bool Indirect::update(const Context& context, const FrameScene& scene,
                      const std::vector<Mat4>& samples, DiagnosticLog& log) {
  if (!any()) return true;
  const GladGLContext& gl = context.gl();
  receivers_.clear();
  any_grid_ = nullptr;
  for (const VisibleTarget& visible : scene.visible.targets) {
    receivers_.push_back(nullptr);
    if (visible.target >= light_->size()) continue;
    const light::SurfelLight& light = (*light_)[visible.target];
    if (!light.grid || light.grid->entries.empty()) continue;
    if (!fits_texture(gl, *light.grid, log)) return false;
    Grid& grid = grid_of(gl, light);
    if (grid.light_stamp != light.stamp) {
      // a buffer of its own, as draws under way may read the last one
      const auto texels = interleaved(light);
      grid.irradiance = make_buffer(gl, texels.data(), texels.size() * sizeof texels[0]);
      gl.TextureBuffer(grid.light_texture.id(), GL_RGBA32F, grid.irradiance.id());
      grid.light_stamp = light.stamp;
    }
    receivers_.back() = &grid;
    any_grid_ = &grid;
  }
  blocks_.upload(gl, receivers_.size(), [&](std::size_t r, IndirectBlock& block) {
    block.mirrors_apart = mirrors_apart_;
    if (receivers_[r] == nullptr) return;
    const light::SurfelGrid& grid = *(*light_)[scene.visible.targets[r].target].grid;
    Mat4 from_sample = samples[r];
    from_sample[3] -= Vec4(grid.origin, 0);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        block.from_sample[4 * row + column] = static_cast<float>(from_sample[column][row]);
    block.cells_a_metre = static_cast<float>(1 / grid.side);
    block.last_slot = static_cast<std::uint32_t>(grid.cells.size() - 1);
    block.probes = static_cast<std::int32_t>(grid.longest_probe);
  });
  return true;
}

void Indirect::bind(const GladGLContext& gl, std::size_t receiver) const {
  blocks_.bind(gl, kIndirectBinding, receiver);
  const Grid* grid = receivers_[receiver] != nullptr ? receivers_[receiver] : any_grid_;
  if (grid == nullptr) return;
  gl.BindTextureUnit(kSurfelCellsUnit, grid->cells_texture.id());
  gl.BindTextureUnit(kSurfelEntriesUnit, grid->entries_texture.id());
  gl.BindTextureUnit(kSurfelLightUnit, grid->light_texture.id());
  gl.BindTextureUnit(kSurfelLimitsUnit, grid->limits_texture.id());
}

}  // namespace panwright::preview
