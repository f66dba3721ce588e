#include "preview/frame/imposter_sampler.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "preview/frame/blocks.h"
#include "preview/frame/pixel_errors.h"
#include "preview/frame/texel_areas.h"

namespace panwright::preview {

namespace {

// Relief finer than texels of a shadow map that may change more of the flux is worth a finer map.
constexpr double kMuchRelief = 1e-3;
constexpr double kReliefOfAsked = 0.5;
// Of such maps, texels, and the Sun's points: as much memory as 16 maps of 2896.
constexpr unsigned kFineSide = 4096;
constexpr unsigned kFineHardSide = 5792;
constexpr unsigned kFinePoints = 8;

// The flux of texels of a size, in any unit.
double flux_of(const image::Image& image, double texel) {
  double flux = 0;
  for (const float value : image.radiance) flux += value;
  return flux * texel * texel;
}

void hide(const ImposterSampler::Draw& draw, const Imposter& imposter, bool hidden) {
  for (const std::uint32_t v : imposter.targets)
    draw.scene.hide(draw.scene.all().targets[v].target, hidden);
}

}  // namespace

// Draws an imposter's texels into the image of the frame.
bool ImposterSampler::draw_texels(const Draw& draw, const Imposter& imposter) {
  const VisibleSet* shown =
      draw.scene.find_shown(draw.world, imposter.camera, draw.levels, draw.log);
  if (!shown) return false;
  reset(draw.frame.image, imposter.camera, false);
  FrameScene scene{draw.world, imposter.camera, draw.scene.targets(), *shown};
  scene.pixel = imposter.rate();
  scene.texels = imposter.shadow_texels > 0 ? imposter.shadow_texels : imposter.texels;
  if (imposter.fine_shadows) scene.sun_points = kFinePoints;
  if (draw.samplers.radiance(scene, options_, draw.frames, draw.frame, draw.log, draw.job) &&
      draw.frames.take_all(draw.frame, draw.log, draw.job)) {
    relief_ = taken_relief(told_irradiance(draw.world), draw.frame.image);
    // work, whatever comes of it
    draw.frame.report.samples += static_cast<double>(draw.frame.image.pixels()) /
                                 (static_cast<double>(draw.camera.width) * draw.camera.height);
    return true;
  }
  draw.frames.abandon(draw.frame);
  return false;
}

// Draws an imposter's texels into the image of a frame, once more if its estimated errors are too
// large; without targets in the end if its pixels stay so. Sets the shadow side of options_.
bool ImposterSampler::draw_to_error(const Draw& draw, Imposter& imposter, std::uint32_t most_side,
                                    double& flux_error) {
  const double flux_asked = flux_error_asked(draw.options, imposter.tried);
  // An estimate above what is asked is worth another draw. Of discs the estimate is twice what is
  // left; of foil with its glints it is the standard deviation of that, so half is aimed at.
  constexpr double kAim = 0.5;
  constexpr double kLeastGrowth = 1.25;
  constexpr double kMostGuess = 5e-3;
  const image::Image& image = draw.frame.image;
  const RenderOptions& asked = draw.options;
  double flux = 0;
  double texels = 0;
  for (int round = 0;; ++round) {
    place_imposter(draw.camera, imposter);
    if (!draw_texels(draw, imposter)) return false;
    const double coarser_error = std::exchange(flux_error, flux_error_of(image));
    const double before = std::exchange(flux, flux_of(image, 1 / imposter.rate()));
    // of coarser maps, an error of at least that size
    if (imposter.fine_shadows) relief_ = flux > 0 ? 2 * std::fabs(flux - before) / flux : 0;
    // Vertices are rounded to 1/256 texel, which widens booms that are hardly wider. That falls
    // with the texels' size or faster, and differences of neighbours do not show it. At most what
    // warns nobody: it is a guess, too large where errors fall faster. What both draws are off by
    // anyway tells nothing of it.
    const double growth = imposter.texels / std::exchange(texels, imposter.texels);
    if (round > 0 && growth > kLeastGrowth && flux > 0) {
      const double change = (flux - before) / flux;
      const double beyond =
          change * change - flux_error * flux_error - coarser_error * coarser_error;
      flux_error = std::max(flux_error,
                            std::min(std::sqrt(std::max(beyond, 0.0)) / (growth - 1), kMostGuess));
    }
    // both fall with the texels to 3/2
    double over = flux_error / flux_asked;
    if (imposter.tried) {
      const double pixel_error = pixel_error_of(image, flux_error, imposter.rate());
      const double pixels_over = pixel_error / asked.pixel_error;
      if (pixels_over >
          (round > 0 ? 1 : std::pow(static_cast<double>(most_side) / imposter.texels, 1.5))) {
        imposter.targets.clear();
        break;
      }
      over = std::max(over, pixels_over);
    }
    if (round > 0) break;
    if (kReliefShare * relief_ > std::max(kMuchRelief, kReliefOfAsked * flux_asked) &&
        !options_.shadow_side) {
      imposter.fine_shadows = true;
      options_.shadow_side = draw.samplers.lights().disc().points > 1 ? kFineSide : kFineHardSide;
    }
    if (over <= 1 || imposter.texels >= most_side) {
      if (imposter.fine_shadows) continue;
      break;
    }
    imposter.texels = static_cast<std::uint32_t>(
        std::min<double>(most_side, std::ceil(std::pow(over / kAim, 2.0 / 3.0) * imposter.texels)));
  }
  flux_error = flux > 0 ? flux_error + kReliefShare * relief_ : kNothingLit;
  return true;
}

bool ImposterSampler::draw_all(const Draw& draw, std::uint32_t most_side, bool& found) {
  imposters_ = finder_.find(draw.camera, draw.scene.all(), draw.options, most_side);
  found = !imposters_.empty();
  if (!found) return true;
  const auto most_texels = static_cast<std::uint32_t>(std::min(
      most_side - 4.0, std::sqrt(2 * kMostTexels / static_cast<double>(imposters_.size()))));
  options_ = draw.options;
  options_.samples = 1;
  options_.adaptive = false;
  options_.specular_filter = false;  // texels are many, and their grid is turned
  for (std::size_t i = 0; i < imposters_.size(); ++i)
    if (!add_patch(draw, i, most_texels)) return false;
  for (const Imposter& imposter : imposters_) hide(draw, imposter, true);
  return true;
}

// Draws an imposter; adds to the frame's patches and report. Its targets become none if samples
// show it.
bool ImposterSampler::add_patch(const Draw& draw, std::size_t index, std::uint32_t most_side) {
  const auto start = std::chrono::steady_clock::now();
  Imposter& imposter = imposters_[index];
  FrameUnderWay& frame = draw.frame;
  std::vector<PlaneRect> finer;
  for (const Imposter& other : imposters_.subspan(index + 1))
    if (overlap(other.rect, imposter.rect)) {
      finer.push_back(other.rect);
      hide(draw, other, true);
    }
  double flux_error = 0;
  options_.shadow_side = draw.options.shadow_side;
  if (!draw_to_error(draw, imposter, most_side, flux_error)) return false;
  if (imposter.targets.empty()) return true;
  if (!imposter.alone) {
    // what it stands before or behind is in the image already
    std::swap(other_texels_, frame.image);
    for (const Imposter& other : imposters_) hide(draw, other, true);
    if (!draw_texels(draw, imposter)) return false;
    std::swap(other_texels_, frame.image);
  }
  frame.patches.push_back(patch_of(imposter, frame.image, imposter.alone ? nullptr : &other_texels_,
                                   finer, draw.options.psf_sigma, draw.camera.width,
                                   draw.camera.height));
  for (const Imposter& other : imposters_) hide(draw, other, false);
  ImposterReport done{{},
                      imposter.extent,
                      imposter.camera.width,
                      imposter.camera.height,
                      flux_error,
                      seconds_since(start),
                      flux_error_asked(draw.options, imposter.tried)};
  for (const std::uint32_t v : imposter.targets)
    done.targets.push_back(draw.scene.all().targets[v].target);
  frame.report.imposters.push_back(std::move(done));
  return true;
}

}  // namespace panwright::preview
