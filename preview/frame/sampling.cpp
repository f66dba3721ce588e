#include "preview/frame/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "preview/frame/blocks.h"
#include "preview/frame/lights.h"
#include "preview/frame/outline.h"
#include "preview/frame/sampling_frame.h"

namespace panwright::preview {
namespace {

// of one draw of blocks: what every context's buffer textures can hold
constexpr std::size_t kMostBlocks = 65536;
// at least this large, so that many blocks are shaded at once
constexpr std::uint32_t kLeastColorSide = 1024;  // samples

// What pixels with one sample may add to the error of N×N samples elsewhere: RMS over the pixels
// that show a target, in parts of the RMS of their radiance, times N. 4×4 samples of a spacecraft
// are off by 0.02 to 0.04.
constexpr double kRest = 0.03;
// So many times what one step leaves of squares is worth another step.
constexpr double kMuch = 4;
// of the squares that may be left, how much is aimed at: one step should do
constexpr double kAim = 0.8;

// What N×N samples are off by is also this part of how far they lie from the M×M before, times N/M:
// the larger of the two (kGain) holds.
constexpr float kChange = 1.2f;
// A change that many times what was predicted is a surprise; and what it tells of its neighbours.
constexpr float kSurprise = 2;
constexpr float kSurpriseShare = 0.2f;
// What a triangle costs, in samples (measured on a software context).
constexpr double kTriangleWork = 0.4;
// Targets so small that N×N samples of 4×4 may miss what they show: every pixel begins with more.
constexpr std::uint32_t kTinyPixels = 10;
constexpr std::uint32_t kSmallPixels = 40;
constexpr unsigned kTinySide = 64;
constexpr unsigned kSmallSide = 16;
// Targets thinner than so many pixels, which samples may miss: all pixels along them begin with so
// many samples across their width.
constexpr double kThinPixels = 1.5;
constexpr double kAcrossThin = 16;
constexpr double kBesideThin = 0.75;  // pixels, from a pixel's centre to their outline

// Radiance taken for thin parts that no sample shows, in parts of the Sun's irradiance: half of
// what white has that faces it. And what of the flux they may be, in parts of the error asked for,
// for nobody to mind.
constexpr double kThinShare = 0.5 / kPi;
constexpr double kThinLeast = 0.1;

constexpr GLenum kColorFormats[] = {GL_RGBA32F};

// A tile of a part, in the image.
Tile moved(Tile tile, const Tile& part) {
  tile.x += part.x;
  tile.y += part.y;
  return tile;
}

std::uint32_t packed(std::uint32_t x, std::uint32_t y) { return x | y << 16; }

}  // namespace

// Reports the errors of all pixels, in parts of what they add up to.
void Sampling::estimate(const ImageSums& sums) {
  double total = 0;
  double squares = 0;
  for (const float error : errors_) {
    squares += static_cast<double>(error) * static_cast<double>(error);
    total += static_cast<double>(error);
  }
  // where only the corners show light, all of it is missing
  report_.rmse = squares > 0 ? std::sqrt(squares / sums.squares) : 0;
  // as if all errors had one sign: along an edge that lies like the samples they have
  report_.flux = total > 0 ? 3 * total / sums.radiance : 0;
}

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
  const GLuint program = device_.programs.resolve(spread);
  if (!device_.programs_ready(log)) return false;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, means.framebuffer.id());
  gl_.Viewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_CULL_FACE);
  gl_.BindVertexArray(passes_.screen());
  gl_.BindTextureUnit(kColorSamplesUnit, color_.colors[0].id());
  gl_.UseProgram(program);
  gl_.Uniform1ui(kSamplesASideLocation, samples);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  return true;
}

bool Sampling::render(const FrameScene& scene, const RenderOptions& options,
                      std::span<const GLenum> formats, image::Image& image, const Job& job,
                      DiagnosticLog& log) {
  Frame frame{scene, options, formats, image, job, log, 0, 0, {}, 0};
  const TileScene whole = tile_scene(scene, {0, 0, image.width, image.height});
  frame.part = whole.tile;
  frame.triangles = triangles_on(scene, whole);
  work_ = 0;
  relief_ = 0;
  report_ = {};
  if (frame.part.width == 0 || frame.part.height == 0) return true;
  // As wide as what is in view, or as high: what lies on two tiles is drawn twice.
  const std::uint32_t limit = device_.context->limits().framebuffer_side;
  const std::uint32_t side = std::min(options.tile_side, limit);
  const std::uint32_t longer = std::min(2 * side, limit);
  const std::uint32_t shorter = side * side / longer;
  const double aspect = static_cast<double>(frame.part.width) / frame.part.height;
  frame.width = aspect > 2 ? longer : aspect < 0.5 ? shorter : side;
  frame.height = aspect > 2 ? shorter : aspect < 0.5 ? longer : side;
  device_.programs.runs();
  if (!device_.programs_ready(log)) return false;
  if (!one_sample_each(frame, image, patternless_)) return false;
  if (!patternless_.empty() && scene.lights->shadows() && !look_at_relief(frame)) return false;
  report_.samples = 1;
  unseen_.clear();
  const bool good = options.samples == 0 ? look_at_corners(frame) && until_error(frame)
                                         : some_in_full(frame, options.samples);
  // what light there may be is missing
  report_.flux = std::hypot(report_.flux, kReliefShare * relief_);
  if (good && !(sums_of(image).squares > 0)) report_.rmse = report_.flux = kNothingLit;
  return good;
}

// N×N samples where one is not enough.
bool Sampling::some_in_full(const Frame& frame, unsigned samples) {
  levels_.assign(frame.count(), 0);
  surprises_.clear();
  predictor_.predict(frame.image, patternless_, frame.part, errors_);
  look_for_thin_parts(frame);
  for (std::size_t i = 0; i < errors_.size(); ++i) errors_[i] = std::max(errors_[i], unseen(i));
  // neighbours tell little of so few pixels
  if (std::max(frame.part.width, frame.part.height) <= kSmallPixels)
    std::fill(errors_.begin(), errors_.end(), INFINITY);
  else
    for_small_targets(
        frame, [&](const Pixel& pixel, unsigned) { errors_[frame.index(pixel)] = INFINITY; });
  const double rest = kRest / samples;
  const double budget = rest * rest * sums_of(frame.image).squares;
  const unsigned sides[] = {1, samples};
  std::vector<std::vector<Pixel>> wanted(2);
  // once more where the first step finds more than it should leave
  for (const double enough : {budget, kMuch * budget}) {
    double left = 0;
    predicted_ = errors_;
    for (std::size_t i = 0; i < predicted_.size(); ++i) {
      if (levels_[i] > 0) predicted_[i] = 0;
      left += static_cast<double>(predicted_[i]) * static_cast<double>(predicted_[i]);
    }
    if (left <= enough) break;
    const float above = least_error_above(predicted_, budget);
    wanted[1].clear();
    for (std::size_t i = 0; i < predicted_.size(); ++i)
      if (predicted_[i] >= above) wanted[1].push_back(frame.pixel(i));
    report_.samples += frame.added(wanted[1].size(), samples);
    if (!measure(frame, sides, wanted)) return false;
    raise_around_surprises(frame);
  }
  estimate(sums_of(frame.image));
  return true;
}

// Samples the pixels with the largest errors more, until what is left is small enough.
bool Sampling::until_error(const Frame& frame) {
  constexpr std::array<unsigned, 6> kSides{1, 4, 8, 16, 32, 64};
  const std::span<const unsigned> sides = kSides;
  levels_.assign(frame.count(), 0);
  errors_.assign(frame.count(), 0.0f);
  std::vector<std::vector<Pixel>> wanted(sides.size());
  look_for_thin_parts(frame);
  want_small_targets(frame, sides, wanted);
  surprises_.clear();

  const double asked = frame.options.pixel_error;
  for (double share = 1;;) {
    if (!measure(frame, sides, wanted)) return false;
    predictor_.predict(frame.image, patternless_, frame.part, predicted_);
    for (std::size_t i = 0; i < errors_.size(); ++i)
      if (levels_[i] == 0) errors_[i] = std::max({predicted_[i], corner_errors_[i], unseen(i)});
    raise_around_surprises(frame);
    const ImageSums sums = sums_of(frame.image);
    estimate(sums);
    if (report_.limited || (report_.rmse <= asked && report_.flux <= asked)) break;
    // As long as the flux is what is not good enough, less and less is left; in small steps, or
    // glossy foil has eight times the samples in one image of an approach, and not in the next.
    if (report_.rmse <= asked) share *= 0.6;
    if (!want_more(frame, sides, share * asked * asked * sums.squares, wanted)) break;
  }
  std::vector<std::size_t> counts(sides.size());
  for (const std::uint8_t level : levels_) ++counts[level];
  for (std::size_t i = 1; i < sides.size(); ++i)
    report_.samples += frame.added(counts[i], sides[i]);
  return true;
}

// Chooses the pixels to be sampled more, so that the squares of their errors sum to the budget; or
// those that the work left allows, with the largest errors. False: none.
bool Sampling::want_more(const Frame& frame, std::span<const unsigned> sides, double budget,
                         std::vector<std::vector<Pixel>>& wanted) {
  const std::size_t last = sides.size() - 1;
  double at_last = 0;  // what cannot be helped
  for (std::size_t i = 0; i < errors_.size(); ++i)
    if (levels_[i] == last)
      at_last += static_cast<double>(errors_[i]) * static_cast<double>(errors_[i]);
  for (;; budget *= 2) {
    // The last level has its part of the budget; the others the rest of it, and a tenth at least,
    // or every pixel would be taken to the last level in vain.
    const Allocation allocation(errors_, levels_, sides,
                                std::max(kAim * budget - at_last, 0.1 * budget));
    for (std::vector<Pixel>& pixels : wanted) pixels.clear();
    for (std::size_t i = 0; i < errors_.size(); ++i) {
      const std::size_t level = allocation.level(errors_[i], levels_[i]);
      if (level != levels_[i]) wanted[level].push_back(frame.pixel(i));
    }
    double work = 0;
    bool any = false;
    for (std::size_t level = 1; level < sides.size(); ++level) {
      if (wanted[level].empty()) continue;
      any = true;
      work += static_cast<double>(wanted[level].size()) * sides[level] * sides[level] +
              frame.triangles * kTriangleWork;
    }
    if (!any) return false;
    if (frame.options.work == 0 || work_ + work <= frame.options.work) return true;
    report_.limited = true;
  }
}

// Calls use(pixel, samples) for all pixels of targets so small that their neighbours tell little,
// and of thin ones.
template <class Use>
void Sampling::for_small_targets(const Frame& frame, const Use& use) {
  for (const TileTarget& target :
       tile_scene(frame.scene, {0, 0, frame.image.width, frame.image.height}).targets) {
    const Tile& part = target.part;
    const std::uint32_t side = std::max(part.width, part.height);
    const bool small = side <= kSmallPixels;
    outline_.find(frame.scene.camera, frame.scene.visible.targets[target.visible].boxes);
    if (!small && !(outline_.width() < kThinPixels)) continue;
    const unsigned samples =
        small ? (side > kTinyPixels ? kSmallSide : kTinySide)
              : static_cast<unsigned>(std::clamp(kAcrossThin / outline_.width(), 1.0, 64.0));
    for (std::uint32_t y = part.y; y < part.y + part.height; ++y)
      for (std::uint32_t x = part.x; x < part.x + part.width; ++x)
        if (small || outline_.distance(Vec2(x, y) + 0.5) < kBesideThin) use(Pixel{x, y}, samples);
  }
}

// What for_small_targets() finds begins with more samples.
void Sampling::want_small_targets(const Frame& frame, std::span<const unsigned> sides,
                                  std::vector<std::vector<Pixel>>& wanted) {
  for_small_targets(frame, [&](const Pixel& pixel, unsigned samples) {
    const auto level = static_cast<std::uint8_t>(
        std::lower_bound(sides.begin(), sides.end(), samples) - sides.begin());
    std::uint8_t& at = levels_[frame.index(pixel)];
    at = std::max(at, level);
  });
  for (std::size_t i = 0; i < levels_.size(); ++i)
    if (levels_[i] > 0) wanted[levels_[i]].push_back(frame.pixel(i));
}

// Samples what is wanted of each level, and how far it is off.
bool Sampling::measure(const Frame& frame, std::span<const unsigned> sides,
                       std::span<const std::vector<Pixel>> wanted) {
  const auto at = [&](const Pixel& pixel) {
    return frame.image.radiance.data() + 3 * frame.at(pixel);
  };
  for (std::size_t level = 1; level < sides.size(); ++level) {
    const std::vector<Pixel>& pixels = wanted[level];
    spreads_.assign(pixels.size(), 0.0f);
    before_.resize(3 * pixels.size());
    for (std::size_t k = 0; k < pixels.size(); ++k)
      std::copy_n(at(pixels[k]), 3, before_.data() + 3 * k);
    if (!refine(frame, sides[level], pixels, spreads_)) return false;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const std::size_t i = frame.index(pixels[k]);
      float squares = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float change = at(pixels[k])[c] - before_[3 * k + c];
        squares += change * change;
      }
      const float change = std::sqrt(squares * (1.0f / 3));
      if (levels_[i] == 0 && change > kSurprise * errors_[i])
        surprises_.push_back({pixels[k], change});
      const float gain =
          kChange * static_cast<float>(sides[levels_[i]]) / static_cast<float>(sides[level]);
      // what the small targets begin with has nothing before it
      errors_[i] = std::max(kGain * spreads_[k], levels_[i] == level ? 0 : gain * change);
      if (frame.image.coverage[frame.at(pixels[k])] == 0)
        errors_[i] = std::max(errors_[i], unseen(i));
      levels_[i] = static_cast<std::uint8_t>(level);
    }
  }
  return true;
}

// A pixel that shows what its neighbours did not tell of is a part of something that may run on.
void Sampling::raise_around_surprises(const Frame& frame) {
  constexpr std::uint32_t kReach = 2;
  const Tile& part = frame.part;
  for (const Surprise& one : surprises_) {
    const std::uint32_t left = std::max(one.pixel.x, part.x + kReach) - kReach;
    const std::uint32_t top = std::max(one.pixel.y, part.y + kReach) - kReach;
    const std::uint32_t right = std::min(one.pixel.x + kReach + 1, part.x + part.width);
    const std::uint32_t bottom = std::min(one.pixel.y + kReach + 1, part.y + part.height);
    for (std::uint32_t y = top; y < bottom; ++y)
      for (std::uint32_t x = left; x < right; ++x) {
        const std::size_t i = frame.index({x, y});
        if (levels_[i] == 0) errors_[i] = std::max(errors_[i], kSurpriseShare * one.change);
      }
  }
}

// What shading.frag says of solar cells beside the coverage.
void Sampling::take_patternless(const Frame& frame, const Tile& tile, image::Image& image,
                                std::vector<float>& patternless) const {
  const auto whole = static_cast<float>(told_irradiance(frame.scene.world));
  for (std::uint32_t y = tile.y; y < tile.y + tile.height; ++y)
    for (std::uint32_t x = tile.x; x < tile.x + tile.width; ++x) {
      float& coverage = image.coverage[std::size_t{y} * image.width + x];
      if (!(coverage > 1)) continue;
      patternless[frame.index({x, y})] = (coverage - 1) * whole;
      coverage = 1;
    }
}

// One sample a pixel, and what their errors are predicted from, or what relief may add.
bool Sampling::one_sample_each(const Frame& frame, image::Image& image,
                               std::vector<float>& patternless, bool relief) {
  const Pass pass = frame.options.flat ? Pass::flat_geometry : Pass::geometry;
  bool cells = false;
  for (std::size_t v = 0; v < frame.scene.visible.targets.size(); ++v)
    for (const std::uint32_t index : frame.scene.visible.targets[v].items)
      cells = cells || (!relief && frame.scene.state(v).items()[index].variant.cells);
  patternless.assign(cells ? frame.count() : 0, -1.0f);
  const std::uint32_t side = std::min(frame.width, frame.height);
  for (Tiles each(frame.part.width, frame.part.height, side); each; each.next()) {
    const TileScene on_tile = tile_scene(frame.scene, moved(*each, frame.part));
    const Tile& tile = on_tile.tile;
    if (tile.width == 0 || tile.height == 0) continue;
    if (frame.cancelled()) return false;
    if (!ensure_render_target(gl_, seen_, frame.formats, true, tile.width, tile.height,
                              frame.area(), frame.log) ||
        !ensure_render_target(gl_, color_, kColorFormats, true, tile.width, tile.height,
                              frame.area(), frame.log))
      return false;
    passes_.upload(frame.scene, on_tile, 1, frame.options.flat, cells ? Told::cells : Told::relief);
    if (!passes_.draw(frame.scene, on_tile, 1, pass, seen_, frame.job)) return !frame.cancelled();
    passes_.shade(frame.scene, on_tile, 1, seen_, color_);
    const std::size_t pixels = std::size_t{tile.width} * tile.height;
    floats_.resize(std::max(floats_.size(), 4 * pixels));
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.ReadPixels(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height),
                   GL_RGBA, GL_FLOAT, floats_.data());
    store_pixels(floats_, tile, image);
    if (cells) take_patternless(frame, tile, image, patternless);
  }
  // of the same relief, two looks
  if (!cells) relief_ = std::max(relief_, taken_relief(told_irradiance(frame.scene.world), image));
  return true;
}

namespace {

// The same scene through another camera.
FrameScene seen_by(const world::Camera& camera, const FrameScene& scene) {
  return {.world = scene.world,
          .camera = camera,
          .states = scene.states,
          .visible = scene.visible,
          .lights = scene.lights,
          .pixel = scene.pixel,
          .texels = scene.texels,
          .specular_filter = scene.specular_filter};
}

// Clears an image of as many pixels.
void clear_to(std::uint32_t width, std::uint32_t height, image::Image& image) {
  image.width = width;
  image.height = height;
  image.radiance.assign(3 * image.pixels(), 0.0f);
  image.coverage.assign(image.pixels(), 0.0f);
}

}  // namespace

// Solar cells take the place of what relief may add: it is told of a small image of the same view.
bool Sampling::look_at_relief(const Frame& frame) {
  constexpr double kSide = 256;  // pixels
  const double scale = std::min(1.0, kSide / std::max(frame.part.width, frame.part.height));
  world::Camera camera = frame.scene.camera;
  camera.width = static_cast<std::uint32_t>(std::ceil(camera.width * scale));
  camera.height = static_cast<std::uint32_t>(std::ceil(camera.height * scale));
  camera.focal *= scale;
  camera.principal *= scale;
  clear_to(camera.width, camera.height, small_);
  const FrameScene scene = seen_by(camera, frame.scene);
  const Tile part = tile_scene(scene, {0, 0, camera.width, camera.height}).tile;
  Frame other{scene,     frame.options, frame.formats, small_, frame.job,
              frame.log, frame.width,   frame.height,  part,   frame.triangles};
  return one_sample_each(other, small_, corner_patternless_, true);
}

// A second look between the samples of the first: thin things that one of them misses, the other
// one may see. Predictions alone come of it.
bool Sampling::look_at_corners(const Frame& frame) {
  clear_to(frame.image.width, frame.image.height, corners_);
  world::Camera shifted = frame.scene.camera;
  shifted.principal += Vec2(0.5);
  const FrameScene scene = seen_by(shifted, frame.scene);
  Frame other{scene,     frame.options, frame.formats, corners_,   frame.job,
              frame.log, frame.width,   frame.height,  frame.part, frame.triangles};
  if (!one_sample_each(other, corners_, corner_patternless_)) return false;
  report_.samples = 2;
  corner_errors_.assign(frame.count(), 0.0f);
  predictor_.look_at_corners(frame.image, patternless_, corners_, corner_patternless_, frame.part,
                             corner_errors_);
  return true;
}

// What thin parts may add to pixels where no sample shows a target. A guess of their radiance, for
// samples to be taken there; nothing where all of it is little beside the error asked for.
void Sampling::look_for_thin_parts(const Frame& frame) {
  const bool corners = frame.options.samples == 0;
  find_empty(frame.image, corners ? &corners_ : nullptr, frame.part, empty_);
  thin_.begin(frame.part, empty_);
  for (std::size_t v = 0; v < frame.scene.visible.targets.size(); ++v) {
    const VisibleTarget& target = frame.scene.visible.targets[v];
    const TargetState& state = frame.scene.state(v);
    for (std::size_t k = 0; k < target.items.size(); ++k) {
      const DrawItem& item = state.items()[target.items[k]];
      if (!item.variant.cutout)
        thin_.add(frame.scene.camera,
                  {state.model().model->mesh(item.mesh), target.boxes[k].camera_from_mesh,
                   item.sides == Sides::front});
    }
  }
  const auto radiance = static_cast<float>(kThinShare * told_irradiance(frame.scene.world));
  double sum = 0;
  unseen_.assign(thin_.areas().begin(), thin_.areas().end());
  for (float& one : unseen_) sum += static_cast<double>(one *= radiance);
  // of three channels, as in estimate()
  if (3 * sum <= kThinLeast * frame.options.pixel_error * sums_of(frame.image).radiance)
    unseen_.clear();
}

// N×N samples of pixels that ascend, and no others.
//
//   error  of each: how far parts of its samples lie apart
bool Sampling::refine(const Frame& frame, unsigned samples, std::span<const Pixel> pixels,
                      std::span<float> error) {
  // A draw of a tile costs about as much as so many samples in it that are not asked for (measured
  // on a software context).
  constexpr std::uint64_t kWorth = 1u << 19;
  order_.resize(pixels.size());
  std::iota(order_.begin(), order_.end(), 0u);
  for (const PixelGroup& one :
       group(pixels, order_, std::max(1u, frame.width / samples),
             std::max(1u, frame.height / samples), kWorth / (samples * samples))) {
    if (frame.cancelled()) return false;
    const TileScene on_tile = tile_scene(frame.scene, one.around);
    const Tile& tile = on_tile.tile;
    // nothing falls on the others, so they are background, as their one sample is
    inside_.clear();
    for (const std::uint32_t index : one.pixels) {
      const Pixel& pixel = pixels[index];
      if (pixel.x >= tile.x && pixel.x < tile.x + tile.width && pixel.y >= tile.y &&
          pixel.y < tile.y + tile.height)
        inside_.push_back(index);
    }
    if (inside_.empty()) continue;
    work_ += triangles_on(frame.scene, on_tile) * kTriangleWork +
             static_cast<double>(inside_.size()) * samples * samples;
    if (!refine_tile(frame, on_tile, samples, pixels, inside_, error)) return false;
  }
  return true;
}

// Of no buffer is the size a power of two: see ensure_render_target(). least: numbers.
void Sampling::upload(const GlBuffer& buffer, std::span<const std::uint32_t> numbers,
                      std::size_t least) const {
  const std::size_t room = (std::max(numbers.size(), least) / 4 * 2 + 3) * 2;
  gl_.NamedBufferData(buffer.id(), static_cast<GLsizeiptr>(4 * room), nullptr, GL_STREAM_DRAW);
  gl_.NamedBufferSubData(buffer.id(), 0, static_cast<GLsizeiptr>(numbers.size_bytes()),
                         numbers.data());
}

// Makes the pixels of the runs the only ones that are drawn, and empty.
void Sampling::clear_runs(const Tile& tile, unsigned samples, GLsizei count, bool first) {
  gl_.BindVertexArray(passes_.screen());
  gl_.BindTextureUnit(kPixelPlacesUnit, runs_texture_.id());
  gl_.Disable(GL_CULL_FACE);
  gl_.DepthFunc(GL_ALWAYS);
  for (GLuint layer = 0; layer < kLayers; ++layer) {
    const GLboolean on = first && layer == kNormalLayer;
    gl_.ColorMaski(layer, on, on, on, on);
  }
  gl_.UseProgram(device_.programs.runs());
  gl_.Uniform2f(kRunScaleLocation, 2.0f / static_cast<float>(tile.width * samples),
                2.0f / static_cast<float>(tile.height * samples));
  const float nearest = 1;
  gl_.ClearBufferfv(GL_DEPTH, 0, &nearest);
  gl_.Uniform1ui(kSamplesASideLocation, samples);
  gl_.Uniform1f(kScreenDepthLocation, 0.0f);
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
      std::min(std::max(frame.width, frame.height),
               std::max({kLeastColorSide, samples, tile.width, tile.height}));
  if (!ensure_render_target(gl_, seen_, frame.formats, true, width, height, frame.area(),
                            frame.log) ||
      !ensure_render_target(gl_, color_, kColorFormats, true, color_side, color_side, frame.area(),
                            frame.log))
    return false;

  std::vector<Pixel> on_it;
  std::vector<std::uint32_t> places;
  for (const std::uint32_t index : which) {
    on_it.push_back({pixels[index].x - tile.x, pixels[index].y - tile.y});
    places.push_back(packed(on_it.back().x, on_it.back().y));
  }
  asked_.assign(tile, on_it);
  std::vector<std::uint32_t> rectangles;
  for (const PixelRun& run : runs(on_it)) {
    rectangles.push_back(packed(run.first.x, run.first.y));
    rectangles.push_back(run.count);
  }
  upload(runs_, rectangles, 2);
  passes_.upload(frame.scene, on_tile, samples, frame.options.flat);
  const auto clear = [&](bool first) {
    clear_runs(tile, samples, static_cast<GLsizei>(rectangles.size() / 2), first);
  };
  if (!passes_.draw(frame.scene, on_tile, samples,
                    frame.options.flat ? Pass::flat_geometry : Pass::geometry, seen_, frame.job,
                    clear, &asked_))
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
    upload(pixels_, blocks, kMostBlocks);
    gl_.TextureBuffer(pixels_texture_.id(), GL_R32UI, pixels_.id());
    passes_.shade(frame.scene, on_tile, samples, seen_, color_,
                  {pixels_texture_.id(), a_row, used});
    if (!read_means(a_row, used, frame.area(), samples, frame.log)) return false;
    const std::size_t floats = std::size_t{4} * a_row * used;
    for (std::size_t i = 0; i < count; ++i) {
      const Pixel& pixel = pixels[which[first + i]];
      const std::size_t at = frame.at(pixel);
      const float* mean = floats_.data() + 4 * i;
      std::copy_n(mean, 3, frame.image.radiance.data() + 3 * at);
      frame.image.coverage[at] = mean[3];
      const float* off = mean + floats;
      error[which[first + i]] =
          std::sqrt((off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) / 3);
    }
  }
  return true;
}

}  // namespace panwright::preview
