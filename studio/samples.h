// What is known of one material by itself: an image of its samples, its lobes and albedos, a verdict. Made in the
// background.
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

// Angles of the light from the normal that a sample's lobes are of, degrees.
inline constexpr std::array<int, 4> kSampleLights = {0, 30, 60, 80};

struct Sample {
  std::string name;
  std::string words;    // the BRDFs in words
  std::string verdict;  // energy, reciprocity, single precision
  std::array<double, 3> hemispherical{};
  // (viewing angle in degrees, -90 to 90 in the plane of incidence; pi f, mean of the channels, under the Sun's disc)
  std::array<std::vector<Vec2>, kSampleLights.size()> lobes;
  // (angle from the normal in degrees, directional albedo), by channel
  std::array<std::vector<Vec2>, 3> albedo;
  // sphere, tilted tile and wrinkled tile under the Sun, path traced; 4*H*W, sRGB, white plates in full Sun white
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

// Cost: about a second.
Sample sample_of(const pxn::DescribedMaterial& material, std::uint32_t width, const Job& job = {});

// Slopes of sheets of foil, along x and y of each: (slope, density), even steps, and numbers of the sheets in words.
struct SheetSlopes {
  std::array<std::vector<Vec2>, 2> density;
  double rms = 0;  // along one axis
  std::vector<std::string> sheets;
};

// Of a model's sheets whose nodes or parts have a name; empty: all. Slopes are those of flat sheets' facets, by area.
// Cost: O(triangles).
SheetSlopes slopes_of(const pan::Model& model, const std::string& name);

// Makes one sample after the other; of what is asked for while one is made, the last.
class Samples {
 public:
  ~Samples();
  // material: fitted
  void ask(pxn::DescribedMaterial material, std::uint32_t width);
  // Whether another one is there since the last call. Called often.
  bool look();
  const std::optional<Sample>& last() const { return last_; }
  bool busy() const { return running_.valid(); }

 private:
  void start();
  std::optional<std::pair<pxn::DescribedMaterial, std::uint32_t>> wanted_;
  std::future<Sample> running_;
  Job job_;
  std::optional<Sample> last_;
};

}  // namespace panwright::studio
