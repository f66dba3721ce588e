// Samples of one material, made in the background: image, lobes, albedos, verdict.
#pragma once

#include <array>
#include <cstdint>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/job.h"
#include "pan/model.h"
#include "pxn/materials.h"

namespace panwright::studio {

// Incidence angles of the lobes of a sample, degrees.
inline constexpr std::array<int, 4> kSampleLights = {0, 30, 60, 80};

struct MaterialSample {
  std::string name;
  std::string description;  // of its BRDFs
  std::string verdict;      // energy, reciprocity, single precision
  std::array<double, 3> hemispherical{};
  // (viewing angle in degrees, -90 to 90 in the plane of incidence; pi f, mean of the channels,
  // under the Sun's disc)
  std::array<std::vector<Vec2>, kSampleLights.size()> lobes;
  // (angle from the normal in degrees, directional albedo), by channel
  std::array<std::vector<Vec2>, 3> albedo;
  // sphere, tilted tile and wrinkled tile under the Sun, path traced; 4*H*W, sRGB, white plates in
  // full Sun white
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

// Cost: about a second.
MaterialSample sample_of(const pxn::DescribedMaterial& material, std::uint32_t width,
                         const Job& job = {});

// Distribution of the slopes of sheets of foil.
struct SheetSlopes {
  std::array<std::vector<Vec2>, 2> density;  // along x and y: (slope, density), in equal steps
  double rms = 0;                            // along one axis
  std::vector<std::string> sheets;           // descriptions
};

// Slopes of the facets of flat sheets, weighted by area. name: of a node of the sheets or an
// ancestor; empty: all
//
// Cost: O(triangles).
SheetSlopes slopes_of(const pan::Model& model, const std::string& name);

// Computes one sample at a time. A request replaces an earlier one that has not begun.
class Samples {
 public:
  ~Samples();
  // material: fitted
  void request(pxn::DescribedMaterial material, std::uint32_t width);
  // Returns true once per finished sample. To be called every frame.
  bool poll();
  const std::optional<MaterialSample>& last() const { return last_; }
  bool busy() const { return running_.valid(); }

 private:
  void start();
  std::optional<std::pair<pxn::DescribedMaterial, std::uint32_t>> pending_;
  std::future<MaterialSample> running_;
  Job job_;
  std::optional<MaterialSample> last_;
};

}  // namespace panwright::studio
