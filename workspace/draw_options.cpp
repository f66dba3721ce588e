// Options of the engines, from settings.
#include "workspace/drawer.h"

namespace panwright::workspace {

namespace {

// Of images without a given error, in samples: about a second of two processors.
constexpr double kStandardWork = 1 << 20;

void set_gl(const Settings& settings, preview::RenderOptions& gl) {
  gl.samples = settings.samples->number.value_or(0);
  if (gl.samples == 0 && !settings.pixel_error) gl.work = kStandardWork;
  if (settings.pixel_error) gl.pixel_error = *settings.pixel_error;
  gl.adaptive = *settings.adaptive;
  gl.specular_filter = *settings.specular_filter != Settings::SpecularFilter::off;
  if (settings.shadow_side) gl.shadow_side = *settings.shadow_side;
  gl.sun_points = *settings.sun_points;
  switch (*settings.shadows) {
    case Settings::Shadows::automatic:
      break;
    case Settings::Shadows::off:
      gl.shadow_side = 0;
      break;
    case Settings::Shadows::hard:
      gl.shadows = preview::Shadows::hard;
      break;
    case Settings::Shadows::soft:
      gl.shadows = preview::Shadows::soft;
      break;
  }
  gl.flux_error = *settings.flux_error;
  gl.flux_error_of_large = bool(settings.flux_error);
  gl.imposter_pixels = settings.imposters->number;
  if (*settings.imposters == Settings::Imposters::off) gl.imposters = preview::Imposters::off;
  if (*settings.imposters == Settings::Imposters::always) gl.imposters = preview::Imposters::always;
  gl.levels = !(*settings.levels == Settings::Levels::off);
  gl.level_pixel = settings.levels->number;
}

}  // namespace

DrawOptions draw_options(const Settings& given, preview::ContextKind context) {
  const Settings settings = with_presets(given);
  DrawOptions draw;
  draw.engine = *settings.engine;
  draw.context = context;
  draw.samples = settings.samples->number.value_or(0);
  draw.gl.flat = draw.reference.flat = *settings.flat;
  draw.gl.psf_sigma = draw.reference.psf_sigma = *settings.psf;
  draw.gl.max_bytes = draw.reference.max_bytes = *settings.max_image_memory;
  if (draw.engine == Engine::gl) {
    set_gl(settings, draw.gl);
    draw.indirect = *settings.indirect;
  } else {
    draw.reference.until_error = *settings.until_error;
    draw.reference.max_samples = *settings.max_samples;
    draw.reference.bounces = *settings.bounces;
    draw.reference.seed = *settings.seed;
    draw.reference.sun_disc = !*settings.no_sun_disc;
  }
  draw.photo = *settings.tone == Settings::Tone::photo;
  draw.files = file_options(settings);
  return draw;
}

image::FileOptions file_options(const Settings& settings) {
  image::FileOptions files;
  if (settings.layers) files.layers = *settings.layers;
  files.compress = *settings.compress;
  return files;
}

}  // namespace panwright::workspace
