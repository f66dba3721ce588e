// Terrain whose relief is finer than the triangles that are drawn: time of its images, and how far
// they are from the mean of all posts.
#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/relief.h"
#include "preview/reference/ground_layer.h"
#include "terrain/tile_writer.h"

namespace panwright::bench::case_terrain_relief {

namespace {

// A plane of an RMS slope, posts 1 m apart, about the origin.
world::ModelPtr made(const std::filesystem::path& folder, std::uint32_t side, double slope,
                     DiagnosticLog& log) {
  std::vector<double> heights;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) heights.push_back(rough(x, y, 256, 2));
  double sum = 0;
  for (std::size_t y = 1; y + 1 < side; ++y)
    for (std::size_t x = 1; x + 1 < side; ++x) {
      const double p = 0.5 * (heights[y * side + x + 1] - heights[y * side + x - 1]),
                   q = 0.5 * (heights[(y + 1) * side + x] - heights[(y - 1) * side + x]);
      sum += p * p + q * q;
    }
  const double scale = std::tan(slope) / std::sqrt(sum / ((side - 2.0) * (side - 2.0)));
  std::ofstream data(folder / "relief.dat", std::ios::binary);
  for (const double height : heights) {
    const auto h = static_cast<float>(scale * height);
    data.write(reinterpret_cast<const char*>(&h), sizeof h);
  }
  data.close();
  std::ofstream(folder / "relief.hdr") << fmt::format(
      "ENVI\nsamples = {}\nlines = {}\nbands = 1\ndata type = 4\nbyte order = 0\n"
      "map info = {{Local, 1, 1, {}, {}, 1, 1}}\n",
      side, side, -0.5 * side, 0.5 * side);
  terrain::DemOptions reading;
  reading.unit = 1;
  reading.quantity = terrain::Quantity::height;
  const auto dem = terrain::Dem::open(folder / "relief.hdr", reading, log);
  if (!dem || !terrain::write_tiles({&*dem, 1}, folder / "relief.pan", {}, log)) return {};
  auto model = pan::Model::open(folder / "relief.pan", log);
  if (!model || !model->check(log)) return {};
  return std::make_shared<const pan::Model>(*std::move(model));
}

struct View {
  double sun, camera;  // degrees from the vertical, in planes at right angles
};

class Drawing {
 public:
  Drawing(const world::ModelPtr& ground, const View& view) : view_(view) {
    DiagnosticLog log;
    (void)world_.add("ground", ground, log);
    world::Sun sun = world_.sun();
    sun.direction = {-std::sin(view.sun * kDegree), 0, std::cos(view.sun * kDegree)};
    world_.set_sun(sun);
  }

  // width² pixels of so many metres.
  image::Image draw(std::uint32_t width, double pixel) {
    constexpr double kDistance = 3e5;
    DiagnosticLog log;
    world::Camera camera;
    world::set_pixel_angle(camera, width, width, pixel / kDistance);
    const double turn = view_.camera * kDegree;
    camera.position = kDistance * Vec3(0, -std::sin(turn), std::cos(turn));
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
    image::Image image;
    image.width = image.height = width;
    image.radiance.assign(3 * image.pixels(), 0);
    image.coverage.assign(image.pixels(), 0);
    image.depth.assign(image.pixels(), INFINITY);
    preview::GroundOptions options;
    options.sun_disc = false;
    options.truth = false;
    layer_.add(world_, camera, options, image);
    return image;
  }

 private:
  View view_;
  world::World world_;
  preview::GroundLayer layer_;
};

void add_rows(Context& context, const world::ModelPtr& ground, double slope, std::uint32_t posts,
              std::uint32_t block, const View& view) {
  Drawing drawing(ground, view);
  const std::uint32_t side = (posts / 4 & ~63u) / block;  // the middle of the ground
  image::Image coarse;
  const Timing timing = timed([&] { coarse = drawing.draw(side, block); }, context.runs());
  const image::Image fine = drawing.draw(side * block, 1);
  double sum = 0, squares = 0, all = 0;
  for (std::size_t y = 0; y < side; ++y)
    for (std::size_t x = 0; x < side; ++x) {
      double mean = 0;
      for (std::size_t j = 0; j < block; ++j)
        for (std::size_t i = 0; i < block; ++i)
          mean += double(fine.radiance[3 * ((y * block + j) * side * block + x * block + i)]);
      mean /= block * block;
      const double off = double(coarse.radiance[3 * (y * side + x)]) - mean;
      sum += off;
      squares += off * off;
      all += mean;
    }
  Row row;
  row.case_name = "terrain_relief";
  row.setting = fmt::format("slopes {} deg, Sun {} deg, camera {} deg, pixels of {} posts", slope,
                            view.sun, view.camera, block);
  set_rate(row, timing, 4e-6 * side * side);
  row.speed_unit = "Mrays/s";
  row.error = std::sqrt(squares) * side / all;
  row.error_unit = "rms";
  row.reference = "the mean of all posts";
  row.reference_error = 1e-4;
  row.must_error = block == 16 && view.camera == 0 && !context.quick() ? 0.01 : 0;
  context.add(row);
  row.setting += ", sum";
  row.error = std::fabs(sum / all);
  row.error_unit = "relative";
  row.must_error = row.must_error > 0 ? 0.002 : 0;
  context.add(row);
}

void run(Context& context) {
  const std::uint32_t posts = context.quick() ? 257 : 2049;
  for (const double slope : {5.9, 14.4}) {
    DiagnosticLog log;
    const auto ground = made(context.scratch(), posts, slope * kDegree, log);
    if (!ground) return context.note("no terrain: " + to_text(log));
    for (const View& view : {View{30, 0}, View{60, 0}, View{60, 45}})
      for (const std::uint32_t block : {4u, 16u, 32u})
        add_rows(context, ground, slope, posts, block, view);
  }
}

const bool kAdded =
    add_case({"terrain_relief", "light of relief finer than the triangles that are drawn", run});

}  // namespace
}  // namespace panwright::bench::case_terrain_relief
