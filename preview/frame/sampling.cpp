#include "preview/frame/sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace panwright::preview {
namespace {

// of one draw of blocks: what every context's buffer textures can hold
constexpr std::size_t kMostBlocks = 65536;
// at least this large, so that many blocks are shaded at once
constexpr std::uint32_t kLeastColorSide = 1024;  // samples

// Second differences of radiance between pixels that one sample may stand for, in radiances of a
// white plate that faces the Sun: a parabola's mean is off by a 24th of it.
constexpr double kSmoothness = 0.012;

// N to begin with until an error is met: what N×N samples of the coverage miss is not found later.
unsigned first_side(double error) { return error >= 0.03 ? 4 : error >= 0.01 ? 8 : 16; }

constexpr unsigned kMostSide = 64;
// What N×N samples are off by, in parts of how far the four grids of N/2×N/2 in them lie apart.
// Edges along the axes halve with N; 1 leaves room for what no sample shows.
constexpr double kGain = 1;
// Targets so small that N×N samples of 4×4 may miss what they show: every pixel begins with more.
constexpr std::uint32_t kTinyPixels = 10;
constexpr std::uint32_t kSmallPixels = 40;
constexpr unsigned kTinySide = 64;
constexpr unsigned kSmallSide = 16;

constexpr GLenum kCoverageFormats[] = {GL_RG32UI};
constexpr GLenum kMaskFormats[] = {GL_R8};
constexpr GLenum kMeanFormats[] = {GL_RGBA32F, GL_RGBA32F};
constexpr GLenum kColorFormats[] = {GL_RGBA32F, GL_R32F};

std::uint32_t packed(std::uint32_t x, std::uint32_t y) { return x | y << 16; }

// of the group drawn last: what classify.frag takes for a step in depth, half a pixel
std::array<float, 2> depth_step(const FrameScene& scene) {
  constexpr double kRounding = 4e-7;
  const DepthRange& depth = scene.visible.groups.back().depth;
  const double focal = std::max(scene.camera.focal.x, scene.camera.focal.y);
  const double half_pixel = 0.5 / focal;
  if (scene.camera.projection == world::Projection::orthographic)
    return {0, static_cast<float>(half_pixel / (depth.far - depth.near) + kRounding)};
  const double k = depth.near / (depth.far - depth.near);
  return {static_cast<float>(half_pixel), static_cast<float>(half_pixel * k + kRounding)};
}

// What the pixels of an image add up to.
struct Sums {
  double radiance = 0;  // of all channels
  double squares = 0;   // the mean of the channels
};

Sums sums_of(const Image& image) {
  Sums sums;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    if (image.coverage[i] == 0) continue;
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = image.radiance[3 * i + k];
      sums.radiance += value;
      squares += value * value;
    }
    sums.squares += squares / 3;
  }
  return sums;
}

// Pixels that take N×N samples, with the error of each.
struct Level {
  unsigned samples = 1;
  std::vector<Pixel> pixels;
  std::vector<float> error;
};

// Those of `all` that are not in `others`; both ascend.
std::vector<Pixel> without(const std::vector<Pixel>& all, const std::vector<Pixel>& others) {
  std::vector<Pixel> result;
  std::set_difference(all.begin(), all.end(), others.begin(), others.end(),
                      std::back_inserter(result));
  return result;
}

// Adds a level's pixels to those of another with as many samples.
void merge(Level& level, const Level& more) {
  level.pixels.insert(level.pixels.end(), more.pixels.begin(), more.pixels.end());
  level.error.insert(level.error.end(), more.error.begin(), more.error.end());
}

// The error above which pixels are to be sampled more, so that what is left has a sum of squares of
// at most `budget`. What the last level leaves cannot be helped: the others have the rest of it,
// and a tenth at least, or every pixel would be taken to the last level in vain.
float threshold(std::span<const Level> levels, double budget) {
  double left = budget;
  for (const float error : levels.back().error)
    left -= static_cast<double>(error) * static_cast<double>(error);
  left = std::max(left, 0.1 * budget);
  std::vector<float> errors;
  for (const Level& level : levels.first(levels.size() - 1))
    errors.insert(errors.end(), level.error.begin(), level.error.end());
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const float error : errors) {
    sum += static_cast<double>(error) * static_cast<double>(error);
    if (sum > left) return error;
  }
  return INFINITY;
}

double largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

struct Sampling::Frame {
  const FrameScene& scene;
  const RenderOptions& options;
  std::span<const GLenum> formats;
  Image& image;
  const Job& job;
  DiagnosticLog& log;
  std::uint64_t area = 0;  // most samples of a tile
  std::uint32_t side = 0;  // of a framebuffer
  Tile part;               // of the image that anything may fall on

  bool cancelled() const {  // reports E0001 then
    if (job.cancelled()) report_cancelled(log);
    return job.cancelled();
  }

  // The samples a pixel of the image that `pixels` of them with N×N add.
  double added(std::size_t pixels, unsigned n) const {
    return static_cast<double>(pixels) * n * n / static_cast<double>(image.pixels());
  }
};

Sampling::Sampling(Device::Impl& device, Passes& passes, RenderTarget& seen, RenderTarget& color)
    : device_(device),
      passes_(passes),
      gl_(device.context->gl()),
      seen_(seen),
      color_(color),
      runs_(make_stream_buffer(gl_)),
      pixels_(make_stream_buffer(gl_)),
      runs_texture_(make_buffer_texture(gl_)),
      pixels_texture_(make_buffer_texture(gl_)) {}

bool Sampling::resolve(const RenderTarget& means, std::uint32_t width, std::uint32_t height,
                       unsigned samples, bool spread, DiagnosticLog& log) {
  std::string problem;
  const GLuint program = device_.programs.resolve(spread, &problem);
  if (program == 0) {
    log.report_file(Code::E5001, {},
                    fmt::format("{} refuses a shader: {}", device_.context->renderer(), problem));
    return false;
  }
  gl_.BindFramebuffer(GL_FRAMEBUFFER, means.framebuffer.id());
  gl_.Viewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_CULL_FACE);
  gl_.BindVertexArray(passes_.screen());
  gl_.BindTextureUnit(kSamplesUnit, color_.colors[0].id());
  gl_.UseProgram(program);
  gl_.Uniform1ui(0, samples);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  return true;
}

bool Sampling::prepare(const Frame& frame) {
  const bool flat = frame.options.flat;
  if (!passes_.prepare(frame.scene, flat ? Pass::flat_coverage : Pass::coverage, frame.log))
    return false;
  std::string problem;
  if (device_.programs.classify(&problem) != 0 && device_.programs.runs(&problem) != 0) return true;
  frame.log.report_file(
      Code::E5001, {},
      fmt::format("{} refuses a shader: {}", device_.context->renderer(), problem));
  return false;
}

bool Sampling::render(const FrameScene& scene, const RenderOptions& options,
                      std::span<const GLenum> formats, Image& image, const Job& job,
                      DiagnosticLog& log) {
  Frame frame{scene, options, formats, image, job, log, 0, 0, {}};
  const std::uint32_t limit = device_.context->limits().framebuffer_side;
  const std::uint32_t side = std::min(options.tile_side, limit);
  frame.area = std::uint64_t{side} * side;
  frame.side = std::min(2 * side, limit);
  frame.part = tile_scene(scene, {0, 0, image.width, image.height}).tile;
  if (frame.part.width == 0 || frame.part.height == 0) return true;
  if (!prepare(frame)) return false;
  report_ = {};
  std::vector<Pixel> marked;
  if (!one_sample_each(
          frame, options.samples == 0 ? first_side(options.pixel_error) : options.samples, marked))
    return false;
  if (options.samples == 0) return until_error(frame, std::move(marked));
  report_.samples = 1 + frame.added(marked.size(), options.samples);
  return refine(frame, options.samples, marked, {});
}

// Samples the pixels with the largest errors more, until what is left is small enough.
bool Sampling::until_error(const Frame& frame, std::vector<Pixel> marked) {
  std::vector<Level> levels;
  for (unsigned samples = first_side(frame.options.pixel_error); samples <= kMostSide; samples *= 2)
    levels.push_back({samples, {}, {}});
  const auto level_of = [&](unsigned samples) -> Level& {
    return *std::find_if(levels.begin(), levels.end(),
                         [&](const Level& level) { return level.samples >= samples; });
  };
  for (const TileTarget& target :
       tile_scene(frame.scene, {0, 0, frame.image.width, frame.image.height}).targets) {
    const Tile& part = target.part;
    const std::uint32_t side = std::max(part.width, part.height);
    if (side > kSmallPixels) continue;
    Level& level = level_of(side > kTinyPixels ? kSmallSide : kTinySide);
    for (std::uint32_t y = 0; y < part.height; ++y)
      for (std::uint32_t x = 0; x < part.width; ++x)
        level.pixels.push_back({part.x + x, part.y + y});
  }
  // each pixel once, with the most samples
  std::vector<Pixel> taken;
  for (std::size_t i = levels.size(); i-- > 1;) {
    std::vector<Pixel>& pixels = levels[i].pixels;
    std::sort(pixels.begin(), pixels.end());
    pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
    pixels = without(pixels, taken);
    taken.insert(taken.end(), pixels.begin(), pixels.end());
    std::sort(taken.begin(), taken.end());
  }
  levels.front().pixels = without(marked, taken);
  const double asked = frame.options.pixel_error;
  double flux_before = sums_of(frame.image).radiance;
  for (Level& level : levels)
    if (!measure(frame, level.samples, level.pixels, level.error)) return false;

  for (double share = 1;;) {
    const Sums sums = sums_of(frame.image);
    double squares = 0;
    for (const Level& level : levels)
      for (const float error : level.error)
        squares += static_cast<double>(error) * static_cast<double>(error);
    report_.rmse = sums.squares > 0 ? std::sqrt(squares / sums.squares) : 0;
    report_.flux =
        sums.radiance > 0 ? kGain * std::fabs(sums.radiance - flux_before) / sums.radiance : 0;
    if (report_.rmse <= asked && report_.flux <= asked) break;
    // as long as the flux is what is not good enough, less and less is left
    if (report_.rmse <= asked) share *= 0.25;
    const float above = threshold(levels, share * asked * asked * sums.squares);
    std::vector<Level> more(levels.size());
    for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
      Level kept{levels[i].samples, {}, {}};
      for (std::size_t k = 0; k < levels[i].pixels.size(); ++k) {
        const float error = levels[i].error[k];
        if (!(error > 0) || error < above) {
          kept.pixels.push_back(levels[i].pixels[k]);
          kept.error.push_back(error);
          continue;
        }
        // far above: two steps at once
        const bool two = error > 4 * above && i + 2 < levels.size();
        more[two ? i + 2 : i + 1].pixels.push_back(levels[i].pixels[k]);
      }
      levels[i] = std::move(kept);
    }
    bool any = false;
    flux_before = sums.radiance;
    for (std::size_t i = 1; i < levels.size(); ++i) {
      if (more[i].pixels.empty()) continue;
      any = true;
      std::sort(more[i].pixels.begin(), more[i].pixels.end());
      if (!measure(frame, levels[i].samples, more[i].pixels, more[i].error)) return false;
      merge(levels[i], more[i]);
    }
    if (!any) break;
  }
  report_.samples = 1;
  for (const Level& level : levels)
    report_.samples += frame.added(level.pixels.size(), level.samples);
  return true;
}

bool Sampling::measure(const Frame& frame, unsigned samples, std::span<const Pixel> pixels,
                       std::vector<float>& error) {
  error.assign(pixels.size(), 0.0f);
  if (!refine(frame, samples, pixels, error)) return false;
  for (float& each : error) each *= static_cast<float>(kGain);
  return true;
}

// One sample a pixel, and which pixels need more.
bool Sampling::one_sample_each(const Frame& frame, unsigned samples, std::vector<Pixel>& marked) {
  const Pass pass = frame.options.flat ? Pass::flat_geometry : Pass::geometry;
  for (const Tile& whole : tiles_of(frame.part, samples, frame.area, frame.side)) {
    const TileScene on_tile = tile_scene(frame.scene, whole);
    const Tile& tile = on_tile.tile;
    if (tile.width == 0 || tile.height == 0) continue;
    if (frame.cancelled()) return false;
    if (!ensure_render_target(gl_, seen_, frame.formats, true, tile.width, tile.height, frame.area,
                              frame.log) ||
        !ensure_render_target(gl_, color_, kColorFormats, true, tile.width, tile.height, frame.area,
                              frame.log))
      return false;
    passes_.upload(frame.scene, on_tile, samples, frame.options.flat);
    passes_.upload_view(frame.scene, on_tile, 1, samples);
    if (!passes_.draw(frame.scene, on_tile, 1, pass, seen_, frame.job)) return !frame.cancelled();
    passes_.shade(frame.scene, on_tile, 1, seen_, color_);
    floats_.resize(std::max(floats_.size(), std::size_t{4} * tile.width * tile.height));
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.ReadPixels(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height),
                   GL_RGBA, GL_FLOAT, floats_.data());
    store_pixels(floats_, tile, frame.image);
    if (!classify(frame, on_tile, samples, marked)) return false;
  }
  std::sort(marked.begin(), marked.end());
  return true;
}

// What one sample a pixel shows stands in the targets.
bool Sampling::classify(const Frame& frame, const TileScene& on_tile, unsigned samples,
                        std::vector<Pixel>& marked) {
  const Tile& tile = on_tile.tile;
  const std::uint32_t width = tile.width * samples;
  const std::uint32_t height = tile.height * samples;
  if (!ensure_render_target(gl_, coverage_, kCoverageFormats, true, width, height, frame.area,
                            frame.log) ||
      !ensure_render_target(gl_, mask_, kMaskFormats, false, tile.width, tile.height, frame.area,
                            frame.log))
    return false;
  if (!passes_.draw(frame.scene, on_tile, samples,
                    frame.options.flat ? Pass::flat_coverage : Pass::coverage, coverage_,
                    frame.job))
    return !frame.cancelled();
  gl_.BindFramebuffer(GL_FRAMEBUFFER, mask_.framebuffer.id());
  gl_.Viewport(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height));
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_CULL_FACE);
  gl_.BindVertexArray(passes_.screen());
  gl_.BindTextureUnit(kSamplesUnit, coverage_.colors[0].id());
  gl_.BindTextureUnit(kNormalUnit, seen_.colors[0].id());
  gl_.BindTextureUnit(kAlbedoUnit, color_.colors[1].id());
  gl_.BindTextureUnit(kMaterialsUnit, coverage_.depth.id());
  gl_.UseProgram(device_.programs.classify(nullptr));
  gl_.Uniform1ui(0, samples);
  const double white = largest(frame.scene.world.sun().irradiance.value_or(Vec3(1))) / kPi;
  gl_.Uniform1f(2, static_cast<float>(kSmoothness * white));
  gl_.Uniform2ui(3, tile.width, tile.height);
  const std::array<float, 2> step = depth_step(frame.scene);
  gl_.Uniform2f(4, step[0], step[1]);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  marks_.resize(std::max(marks_.size(), std::size_t{tile.width} * tile.height));
  gl_.ReadPixels(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height), GL_RED,
                 GL_UNSIGNED_BYTE, marks_.data());
  for (std::uint32_t y = 0; y < tile.height; ++y)
    for (std::uint32_t x = 0; x < tile.width; ++x)
      if (marks_[std::size_t{y} * tile.width + x] != 0) marked.push_back({tile.x + x, tile.y + y});
  return true;
}

// N×N samples of pixels that ascend, and no others.
//
//   error  of each, see until_error(); or empty
bool Sampling::refine(const Frame& frame, unsigned samples, std::span<const Pixel> pixels,
                      std::span<float> error) {
  if (pixels.empty()) return true;
  Tile part{pixels.front().x, pixels.front().y, 0, pixels.back().y - pixels.front().y + 1};
  std::uint32_t last = part.x;
  for (const Pixel& pixel : pixels) {
    part.x = std::min(part.x, pixel.x);
    last = std::max(last, pixel.x);
  }
  part.width = last - part.x + 1;
  for (const Tile& whole : tiles_of(part, samples, frame.area, frame.side)) {
    if (frame.cancelled()) return false;
    const TileScene on_tile = tile_scene(frame.scene, whole);
    const Tile& tile = on_tile.tile;
    std::vector<std::uint32_t> which;
    for (std::uint32_t y = tile.y; y < tile.y + tile.height; ++y) {
      const auto first = std::lower_bound(pixels.begin(), pixels.end(), Pixel{tile.x, y});
      const auto end = std::lower_bound(first, pixels.end(), Pixel{tile.x + tile.width, y});
      for (auto at = first; at != end; ++at)
        which.push_back(static_cast<std::uint32_t>(at - pixels.begin()));
    }
    if (which.empty()) continue;
    if (!refine_tile(frame, on_tile, samples, pixels, which, error)) return false;
  }
  return true;
}

// Makes the pixels of the runs the only ones that are drawn, and empty.
void Sampling::clear_runs(const Tile& tile, unsigned samples, GLsizei count, bool first) {
  const float nearest = 1;
  gl_.ClearBufferfv(GL_DEPTH, 0, &nearest);
  gl_.BindVertexArray(passes_.screen());
  gl_.BindTextureUnit(kBlocksUnit, runs_texture_.id());
  gl_.Disable(GL_CULL_FACE);
  gl_.DepthFunc(GL_ALWAYS);
  for (GLuint layer = 0; layer <= kSunLayer; ++layer) {
    const GLboolean on = first && layer == kNormalLayer;
    gl_.ColorMaski(layer, on, on, on, on);
  }
  gl_.UseProgram(device_.programs.runs(nullptr));
  gl_.Uniform2ui(0, samples, 0);
  gl_.Uniform2f(1, 2.0f / static_cast<float>(tile.width * samples),
                2.0f / static_cast<float>(tile.height * samples));
  gl_.Uniform1f(2, 0.0f);
  for (GLsizei at = 0; at < count; at += static_cast<GLsizei>(kMostBlocks)) {
    const GLsizei some = std::min(count - at, static_cast<GLsizei>(kMostBlocks));
    gl_.TextureBufferRange(runs_texture_.id(), GL_RG32UI, runs_.id(), GLintptr{8} * at,
                           GLsizeiptr{8} * some);
    gl_.DrawArrays(GL_TRIANGLES, 0, 6 * some);
  }
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.DepthFunc(GL_GREATER);
}

bool Sampling::refine_tile(const Frame& frame, const TileScene& on_tile, unsigned samples,
                           std::span<const Pixel> pixels, std::span<const std::uint32_t> which,
                           std::span<float> error) {
  const Tile& tile = on_tile.tile;
  const std::uint32_t width = tile.width * samples;
  const std::uint32_t height = tile.height * samples;
  const std::uint32_t color_side =
      std::min(frame.side, std::max({kLeastColorSide, samples, tile.width, tile.height}));
  if (!ensure_render_target(gl_, seen_, frame.formats, true, width, height, frame.area,
                            frame.log) ||
      !ensure_render_target(gl_, color_, kColorFormats, true, color_side, color_side, frame.area,
                            frame.log))
    return false;

  std::vector<Pixel> on_it;
  std::vector<std::uint32_t> places;
  for (const std::uint32_t index : which) {
    on_it.push_back({pixels[index].x - tile.x, pixels[index].y - tile.y});
    places.push_back(packed(on_it.back().x, on_it.back().y));
  }
  std::vector<std::uint32_t> rectangles;
  for (const PixelRun& run : runs(on_it)) {
    rectangles.push_back(packed(run.first.x, run.first.y));
    rectangles.push_back(run.count);
  }
  gl_.NamedBufferData(runs_.id(), static_cast<GLsizeiptr>(4 * rectangles.size()), rectangles.data(),
                      GL_STREAM_DRAW);
  passes_.upload(frame.scene, on_tile, samples, frame.options.flat);
  const auto clear = [&](bool first) {
    clear_runs(tile, samples, static_cast<GLsizei>(rectangles.size() / 2), first);
  };
  if (!passes_.draw(frame.scene, on_tile, samples,
                    frame.options.flat ? Pass::flat_geometry : Pass::geometry, seen_, frame.job,
                    clear))
    return !frame.cancelled();

  const std::uint32_t a_row = static_cast<std::uint32_t>(color_.width) / samples;
  const std::size_t rows = static_cast<std::uint32_t>(color_.height) / samples;
  const std::size_t most = std::min(kMostBlocks / a_row * a_row, rows * a_row);
  for (std::size_t first = 0; first < places.size(); first += most) {
    const std::size_t count = std::min(most, places.size() - first);
    std::vector<std::uint32_t> blocks(places.begin() + static_cast<std::ptrdiff_t>(first),
                                      places.begin() + static_cast<std::ptrdiff_t>(first + count));
    const auto used = static_cast<std::uint32_t>((count + a_row - 1) / a_row);
    blocks.resize(std::size_t{used} * a_row, blocks.front());
    gl_.NamedBufferData(pixels_.id(), static_cast<GLsizeiptr>(4 * blocks.size()), blocks.data(),
                        GL_STREAM_DRAW);
    gl_.TextureBuffer(pixels_texture_.id(), GL_R32UI, pixels_.id());
    passes_.shade(frame.scene, on_tile, samples, seen_, color_,
                  {pixels_texture_.id(), a_row, used});
    const bool spread = !error.empty();
    if (!ensure_render_target(gl_, mean_, std::span(kMeanFormats).first(spread ? 2 : 1), false,
                              a_row, used, frame.area, frame.log) ||
        !resolve(mean_, a_row, used, samples, spread, frame.log))
      return false;
    const std::size_t floats = std::size_t{4} * a_row * used;
    floats_.resize(std::max(floats_.size(), 2 * floats));
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    for (unsigned i = 0; i < (spread ? 2u : 1u); ++i) {
      gl_.ReadBuffer(GL_COLOR_ATTACHMENT0 + i);
      gl_.ReadPixels(0, 0, static_cast<GLsizei>(a_row), static_cast<GLsizei>(used), GL_RGBA,
                     GL_FLOAT, floats_.data() + i * floats);
    }
    gl_.ReadBuffer(GL_COLOR_ATTACHMENT0);
    for (std::size_t i = 0; i < count; ++i) {
      const Pixel& pixel = pixels[which[first + i]];
      const std::size_t at = std::size_t{pixel.y} * frame.image.width + pixel.x;
      const float* mean = floats_.data() + 4 * i;
      std::copy_n(mean, 3, frame.image.radiance.data() + 3 * at);
      frame.image.coverage[at] = mean[3];
      if (!spread) continue;
      const float* off = mean + floats;
      error[which[first + i]] =
          std::sqrt((off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) / 3);
    }
  }
  return true;
}

}  // namespace panwright::preview
