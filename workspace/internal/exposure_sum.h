// Image of an exposure over time: the mean of its moments. Private to workspace.
#pragma once

#include <cstddef>
#include <vector>

#include "workspace/drawer.h"
#include "workspace/frame.h"
#include "world/camera.h"

namespace panwright::workspace {

// Sums in double and in the order of the moments, so that the same moments make the same bits.
class ExposureSum {
 public:
  // psf_sigma: of the moments' images, pixels. Expects: a frame with moments, which outlives it.
  ExposureSum(const Frame& frame, double psf_sigma);

  // Bytes that a sum takes beside its image.
  static double bytes(const world::Camera& camera);

  // Camera of a moment: at its pose, of the rows in which it has a share. A point spread function
  // takes rows around them.
  world::Camera camera(std::size_t moment) const;

  // Adds the image of that camera. Truth layers are those of the moment in the middle of each row.
  //
  // Expects: moments in order, each once.
  void add(std::size_t moment, const Drawn& drawn);

  // Returns the mean, with the sums of the reports. Errors are bounds: those of the moments of a
  // row are taken as equal in sign.
  Drawn take();

 private:
  ShutterMoments::Rows drawn_rows(std::size_t moment) const;
  void add_row(std::size_t moment, std::uint32_t row, const image::Image& from, std::size_t place);
  void add_reports(std::size_t moment, const Drawn& drawn);
  std::pair<double, double> light_of(std::size_t moment, const image::Image& from) const;
  void measure_flux();
  void measure_errors();

  const Frame& frame_;
  std::uint32_t margin_ = 0;  // rows
  std::vector<double> radiance_, coverage_;
  std::vector<double> variance_;  // of the radiance, where errors are known
  bool some_lit_ = false;
  double squared_errors_ = 0;         // of all moments, radiance
  double flux_errors_ = 0;            // the same
  std::vector<unsigned> moments_of_;  // of each row
  Drawn sum_;
};

}  // namespace panwright::workspace
