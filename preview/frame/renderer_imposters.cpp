// Targets that are drawn by themselves, finer than pixels.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/clock.h"
#include "preview/frame/blocks.h"
#include "preview/frame/renderer_impl.h"

namespace panwright::preview {

namespace {

// Relief finer than texels of a shadow map that may change more of the flux is worth a finer map.
constexpr double kMuchRelief = 1e-3;
// Of such maps, texels, and the Sun's points: as much memory as 16 maps of 2896.
constexpr unsigned kFineSide = 4096;
constexpr unsigned kFineHardSide = 5792;
constexpr unsigned kFinePoints = 8;

// Takes what shading.frag says beside the coverage: what relief finer than the shadow map's texels
// may add to the flux, relative.
double taken_relief(const world::World& world, image::Image& image) {
  const double whole = told_irradiance(world);
  double relief = 0;
  double light = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    float& coverage = image.coverage[i];
    if (coverage == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) light += image.radiance[3 * i + k] / 3.0;
    if (!(coverage > 1)) continue;
    relief += (coverage - 1.0) * whole;
    coverage = 1;
  }
  return light > 0 ? relief / light : 0;
}

// The flux of texels of a size, in any unit.
double flux_of(const image::Image& image, double texel) {
  double flux = 0;
  for (const float value : image.radiance) flux += value;
  return flux * texel * texel;
}

}  // namespace

// What an imposter shows, into the image of a frame.
bool Renderer::Impl::draw_texels(const world::World& world, const RenderOptions& options,
                                 const LevelState& levels, const Imposter& imposter,
                                 std::size_t frame, DiagnosticLog& log) {
  const VisibleSet* shown = look(world, imposter.camera, levels, drawn_sets, log);
  if (!shown) return false;
  reset(frames[frame].image, imposter.camera, false);
  FrameScene scene{world, imposter.camera, states, *shown};
  scene.pixel = imposter.rate();
  scene.texels = imposter.shadow_texels > 0 ? imposter.shadow_texels : imposter.texels;
  if (imposter.fine_shadows) scene.sun_points = kFinePoints;
  if (submit_radiance(scene, options, frame, log) && take_all(frame, log)) {
    relief = taken_relief(world, frames[frame].image);
    return true;
  }
  abandon(frame);
  return false;
}

// Draws an imposter's texels into the image of a frame, once more if its estimated errors are too
// large; without targets in the end if its pixels stay so. Sets the shadow side of the options.
bool Renderer::Impl::draw_to_error(const world::World& world, const world::Camera& camera,
                                   RenderOptions& options, const LevelState& levels,
                                   Imposter& imposter, std::uint32_t most_side, std::size_t index,
                                   double& flux_error, DiagnosticLog& log) {
  // An estimate above what is asked is worth another draw. Of discs the estimate is twice what is
  // left; of foil with its glints it is the standard deviation of that, so half is aimed at.
  constexpr double kAim = 0.5;
  constexpr double kLeastGrowth = 1.25;
  constexpr double kMostGuess = 5e-3;
  const Frame& frame = frames[index];
  double flux = 0;
  double texels = 0;
  for (int draw = 0;; ++draw) {
    place_imposter(camera, imposter);
    if (!draw_texels(world, options, levels, imposter, index, log)) return false;
    flux_error = flux_error_of(frame.image);
    const double before = std::exchange(flux, flux_of(frame.image, 1 / imposter.rate()));
    // of coarser maps, an error of at least that size
    if (imposter.fine_shadows) relief = flux > 0 ? 2 * std::fabs(flux - before) / flux : 0;
    // Vertices are rounded to 1/256 texel, which widens booms that are hardly wider. That falls
    // with the texels' size or faster, and differences of neighbours do not show it. At most what
    // warns nobody: it is a guess, too large where errors fall faster.
    const double growth = imposter.texels / std::exchange(texels, imposter.texels);
    if (draw > 0 && growth > kLeastGrowth && flux > 0)
      flux_error = std::max(flux_error,
                            std::min(std::fabs(flux - before) / (flux * (growth - 1)), kMostGuess));
    // both fall with the texels to 3/2
    double over = flux_error / options.flux_error;
    if (imposter.tried) {
      const double pixel_error = pixel_error_of(frame.image, flux_error, imposter.rate());
      const double pixels_over = pixel_error / options.pixel_error;
      if (pixels_over >
          (draw > 0 ? 1 : std::pow(static_cast<double>(most_side) / imposter.texels, 1.5))) {
        imposter.targets.clear();
        break;
      }
      over = std::max(over, pixels_over);
    }
    if (draw > 0) break;
    if (0.5 * relief > kMuchRelief && !options.shadow_side) {
      imposter.fine_shadows = true;
      options.shadow_side = lights.disc().points > 1 ? kFineSide : kFineHardSide;
    }
    if (over <= 1 || imposter.texels >= most_side) {
      if (imposter.fine_shadows) continue;
      break;
    }
    imposter.texels = static_cast<std::uint32_t>(
        std::min<double>(most_side, std::ceil(std::pow(over / kAim, 2.0 / 3.0) * imposter.texels)));
  }
  flux_error = flux > 0 ? flux_error + 0.5 * relief : kNothingLit;
  return true;
}

// Adds to the frame's patches and report; hides what is in an imposter.
bool Renderer::Impl::draw_imposters(const world::World& world, const world::Camera& camera,
                                    const RenderOptions& options, const LevelState& levels,
                                    std::span<Imposter> imposters, std::size_t index,
                                    DiagnosticLog& log) {
  const auto most_side = static_cast<std::uint32_t>(std::min(
      most_texels() - 4.0, std::sqrt(2 * kMostTexels / static_cast<double>(imposters.size()))));
  Frame& frame = frames[index];
  RenderOptions own = options;
  own.samples = 1;
  own.adaptive = false;
  own.specular_filter = false;  // texels are many, and their grid is turned
  std::vector<PlaneRect> finer;
  const auto hide = [&](const Imposter& imposter, std::uint8_t how) {
    for (const std::uint32_t v : imposter.targets)
      hidden[visible_sets.last().targets[v].target] = how;
  };
  for (std::size_t i = 0; i < imposters.size(); ++i) {
    Imposter& imposter = imposters[i];
    const auto start = std::chrono::steady_clock::now();
    finer.clear();
    for (const Imposter& other : imposters.subspan(i + 1))
      if (overlap(other.rect, imposter.rect)) {
        finer.push_back(other.rect);
        hide(other, 1);
      }
    double flux_error = 0;
    own.shadow_side = options.shadow_side;
    if (!draw_to_error(world, camera, own, levels, imposter, most_side, index, flux_error, log))
      return false;
    if (imposter.targets.empty()) continue;  // samples show it
    double texels = static_cast<double>(frame.image.pixels());
    if (!imposter.alone) {
      // what it stands before or behind is in the image already
      std::swap(other_texels, frame.image);
      for (const Imposter& other : imposters) hide(other, 1);
      if (!draw_texels(world, own, levels, imposter, index, log)) return false;
      std::swap(other_texels, frame.image);
      texels *= 2;
    }
    frame.patches.push_back(patch_of(imposter, frame.image,
                                     imposter.alone ? nullptr : &other_texels, finer,
                                     options.psf_sigma, camera.width, camera.height));
    for (const Imposter& other : imposters) hide(other, 0);
    frame.report.samples += texels / (static_cast<double>(camera.width) * camera.height);
    const double took = seconds_since(start);
    ImposterReport done{
        {}, imposter.extent, imposter.camera.width, imposter.camera.height, flux_error, took};
    for (const std::uint32_t v : imposter.targets)
      done.targets.push_back(visible_sets.last().targets[v].target);
    frame.report.imposters.push_back(std::move(done));
  }
  for (const Imposter& imposter : imposters) hide(imposter, 1);
  return true;
}

// Texels that a side of an imposter may have.
std::uint32_t Renderer::Impl::most_texels() const {
  constexpr std::uint32_t kMost = 2048;  // less the border; all fit into one framebuffer
  return std::min(kMost, shared.context->limits().framebuffer_side);
}

// Adds to the pixels of a frame what its imposters show.
void Renderer::Impl::finish(Frame& frame) {
  const std::vector<float>& coverage = frame.image.coverage;
  if (frame.psf_sigma > 0 &&
      std::any_of(coverage.begin(), coverage.end(), [](float a) { return a > 0; }))
    convolve(frame.psf_sigma, frame.image);
  add_patches(frame.patches, frame.image);
  frame.patches.clear();
}

}  // namespace panwright::preview
