#include "workspace/internal/exposure_sum.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace panwright::workspace {
namespace {

template <class T>
void copy_row(const std::vector<T>& from, std::size_t at, std::vector<T>& to, std::size_t place,
              std::size_t count) {
  std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(at), count,
              to.begin() + static_cast<std::ptrdiff_t>(place));
}

}  // namespace

ExposureSum::ExposureSum(const Frame& frame, double psf_sigma) : frame_(frame) {
  // 6 sigma hold all but 2e-9 of the light
  if (psf_sigma > 0) margin_ = static_cast<std::uint32_t>(std::ceil(6 * psf_sigma));
  const std::size_t pixels = std::size_t{frame.camera().width} * frame.camera().height;
  radiance_.resize(3 * pixels);
  coverage_.resize(pixels);
  moments_of_.resize(frame.camera().height);
  sum_.image.width = frame.camera().width;
  sum_.image.height = frame.camera().height;
}

double ExposureSum::bytes(const world::Camera& camera) {
  return 4.0 * sizeof(double) * camera.width * camera.height;
}

ShutterMoments::Rows ExposureSum::drawn_rows(std::size_t moment) const {
  ShutterMoments::Rows rows = frame_.shutter->rows(moment);
  rows.first -= std::min(rows.first, margin_);
  rows.end = std::min(rows.end + margin_, frame_.camera().height);
  return rows;
}

world::Camera ExposureSum::camera(std::size_t moment) const {
  world::Camera camera = frame_.camera();
  camera.position = frame_.moments[moment].position;
  camera.world_from_camera = frame_.moments[moment].world_from_camera;
  const ShutterMoments::Rows rows = drawn_rows(moment);
  camera.height = rows.end - rows.first;
  camera.principal.y -= rows.first + frame_.shutter->sensor_offset(moment);
  return camera;
}

void ExposureSum::add(std::size_t moment, const Drawn& drawn) {
  image::Image& image = sum_.image;
  const image::Image& from = drawn.image;
  image.unit = from.unit;
  if (!from.standard_error.empty()) variance_.resize(radiance_.size());
  if (from.has_ground_truth() && !image.has_ground_truth()) {
    image.depth.resize(image.pixels(), INFINITY);
    image.range.resize(image.pixels(), INFINITY);
    image.normal.resize(3 * image.pixels());
    image.target_id.resize(image.pixels());
    image.node_id.resize(image.pixels());
    image.material_id.resize(image.pixels());
  }
  const std::uint32_t first = drawn_rows(moment).first;
  const ShutterMoments::Rows rows = frame_.shutter->rows(moment);
  for (std::uint32_t row = rows.first; row < rows.end; ++row)
    add_row(moment, row, from, std::size_t{row - first} * image.width);
  for (std::uint32_t row = rows.first; row < rows.end; ++row) ++moments_of_[row];
  add_reports(moment, drawn);
}

// A row of the image from the pixels of one of its moments that begin at `at`.
void ExposureSum::add_row(std::size_t moment, std::uint32_t row, const image::Image& from,
                          std::size_t at) {
  image::Image& image = sum_.image;
  const std::size_t width = image.width;
  const std::size_t place = row * width;
  const double share = frame_.shutter->share(moment, row);
  for (std::size_t i = 0; i < 3 * width; ++i)
    radiance_[3 * place + i] += share * double{from.radiance[3 * at + i]};
  for (std::size_t i = 0; i < width; ++i)
    coverage_[place + i] += share * double{from.coverage[at + i]};
  if (!from.standard_error.empty())
    for (std::size_t i = 0; i < 3 * width; ++i) {
      const double error = share * double{from.standard_error[3 * at + i]};
      variance_[3 * place + i] += error * error;
    }
  if (!from.has_ground_truth() || frame_.shutter->middle(row) != moment) return;
  copy_row(from.depth, at, image.depth, place, width);
  copy_row(from.range, at, image.range, place, width);
  copy_row(from.normal, 3 * at, image.normal, 3 * place, 3 * width);
  copy_row(from.target_id, at, image.target_id, place, width);
  copy_row(from.node_id, at, image.node_id, place, width);
  copy_row(from.material_id, at, image.material_id, place, width);
}

void ExposureSum::add_reports(std::size_t moment, const Drawn& drawn) {
  const double share = static_cast<double>(drawn.image.height) / sum_.image.height;
  if (drawn.sampling) {
    const preview::SamplingReport& one = *drawn.sampling;
    if (!sum_.sampling) sum_.sampling.emplace();
    preview::SamplingReport& all = *sum_.sampling;
    all.samples += share * one.samples;
    // moments without light say nothing beside others
    if (one.rmse != preview::kNothingLit) {
      const auto [squares, light] = light_of(moment, drawn.image);
      squared_errors_ += one.rmse * one.rmse * squares;
      flux_errors_ += one.flux * light;
      some_lit_ = true;
    }
    all.limited = all.limited || one.limited;
    all.shadow_edge = std::max(all.shadow_edge, one.shadow_edge);
    all.penumbra = std::max(all.penumbra, one.penumbra);
    all.sun_points = std::max(all.sun_points, one.sun_points);
    all.sun_error = std::max(all.sun_error, one.sun_error);
    all.lamps = std::max(all.lamps, one.lamps);
    all.lamps_without_shadow = std::max(all.lamps_without_shadow, one.lamps_without_shadow);
    all.lamps_left_out = std::max(all.lamps_left_out, one.lamps_left_out);
    all.lamps_soft = std::max(all.lamps_soft, one.lamps_soft);
    all.lamp_penumbra = std::max(all.lamp_penumbra, one.lamp_penumbra);
    all.lamps_hard = std::max(all.lamps_hard, one.lamps_hard);
    all.programs += one.programs;
    all.program_seconds += one.program_seconds;
    if (frame_.shutter->middle(sum_.image.height / 2) == moment) all.imposters = one.imposters;
  }
  if (drawn.ground_light) sum_.ground_light = drawn.ground_light;
  sum_.ground_rays += share * drawn.ground_rays;
  if (drawn.measured) {
    if (!sum_.measured) sum_.measured.emplace();
    sum_.measured->samples += drawn.measured->samples;
    sum_.measured->rays += drawn.measured->rays;
    sum_.measured->seconds += drawn.measured->seconds;
  }
}

// Sums over the drawn rows of a moment, by its share in each: of squared radiance, and of radiance.
std::pair<double, double> ExposureSum::light_of(std::size_t moment,
                                                const image::Image& from) const {
  const std::uint32_t first = drawn_rows(moment).first;
  const ShutterMoments::Rows rows = frame_.shutter->rows(moment);
  double squares = 0, light = 0;
  for (std::uint32_t row = rows.first; row < rows.end; ++row) {
    const double share = frame_.shutter->share(moment, row);
    const float* at = from.radiance.data() + std::size_t{3} * (row - first) * from.width;
    for (std::size_t i = 0; i < std::size_t{3} * from.width; ++i) {
      const double value = share * double{at[i]};
      squares += value * value;
      light += value;
    }
  }
  return {squares, light};
}

void ExposureSum::measure_errors() {
  double squares = 0, light = 0;
  for (const double value : radiance_) {
    squares += value * value;
    light += value;
  }
  preview::SamplingReport& all = *sum_.sampling;
  all.rmse = all.flux = preview::kNothingLit;
  if (!some_lit_ || !(squares > 0)) return;
  const unsigned most = *std::max_element(moments_of_.begin(), moments_of_.end());
  all.rmse = std::sqrt(most * squared_errors_ / squares);
  all.flux = flux_errors_ / light;
}

// Sum of radiance × solid angle, as of one image; its error for independent pixels.
void ExposureSum::measure_flux() {
  const world::Camera& camera = frame_.camera();
  const bool flat = camera.projection == world::Projection::orthographic;
  // all rows of a line scanner look as the one in the middle of the lens
  world::Camera line = camera;
  line.height = 1;
  line.principal.y -= 0.5 * (camera.height - 1.0);
  const bool scanned = frame_.shutter->is_scanner();
  Vec3 flux(0), variance(0);
  for (std::uint32_t y = 0; y < camera.height; ++y)
    for (std::uint32_t x = 0; x < camera.width; ++x) {
      const std::size_t i = std::size_t{y} * camera.width + x;
      if (coverage_[i] == 0) continue;
      const double size = flat      ? world::pixel_area(camera)
                          : scanned ? world::pixel_solid_angle(line, x, 0)
                                    : world::pixel_solid_angle(camera, x, y);
      for (int k = 0; k < 3; ++k) {
        const std::size_t at = 3 * i + static_cast<std::size_t>(k);
        flux[k] += size * radiance_[at];
        variance[k] += size * size * variance_[at];
      }
    }
  sum_.measured->flux = flux;
  sum_.measured->flux_error = glm::sqrt(variance);
}

Drawn ExposureSum::take() {
  image::Image& image = sum_.image;
  if (sum_.measured) measure_flux();
  if (sum_.sampling) measure_errors();
  image.radiance.assign(radiance_.begin(), radiance_.end());
  image.coverage.assign(coverage_.begin(), coverage_.end());
  image.standard_error.clear();
  for (const double variance : variance_)
    image.standard_error.push_back(static_cast<float>(std::sqrt(variance)));
  return std::move(sum_);
}

}  // namespace panwright::workspace
