// A map of 46,080 x 15,360 floats: made into tiles, checked, and drawn from a file that is not in
// memory, as whole processes.
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "bench/bench.h"
#include "terrain/tiles.h"

namespace panwright::bench::case_terrain_large {

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

// Relief of all sizes: products of waves, each of a column and of a row.
class Relief {
 public:
  Relief(std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {
    double length = width / 5.0, size = 1800;
    for (int k = 0; k < kWaves; ++k, length /= 2.83, size /= 2.4) {
      for (std::uint32_t i = 0; i < width; ++i)
        across_.push_back(size * std::sin(2 * kPi * i / length + k));
      for (std::uint32_t i = 0; i < height; ++i)
        down_.push_back(std::cos(2 * kPi * i / length + 2 * k));
    }
  }
  float at(std::uint32_t column, std::uint32_t row) const {
    double sum = 0;
    for (std::size_t k = 0; k < kWaves; ++k)
      sum += across_[k * width_ + column] * down_[k * height_ + row];
    return static_cast<float>(sum);
  }

 private:
  static constexpr int kWaves = 8;
  std::uint32_t width_, height_;
  std::vector<double> across_, down_;
};

fs::path write_map(const fs::path& folder, const Relief& relief, std::uint32_t width,
                   std::uint32_t height) {
  const fs::path path = folder / "large.lbl";
  std::ofstream(path) << fmt::format(
      "PDS_VERSION_ID = PDS3\n^IMAGE = \"large.img\"\nOBJECT = IMAGE\n LINES = {}\n"
      " LINE_SAMPLES = {}\n SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n UNIT = METER\n"
      " OFFSET = 1737400\nEND_OBJECT\nOBJECT = IMAGE_MAP_PROJECTION\n"
      " MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n A_AXIS_RADIUS = 1737.4\n"
      " POSITIVE_LONGITUDE_DIRECTION = EAST\n CENTER_LONGITUDE = 180\n MAP_RESOLUTION = {}\n"
      " LINE_PROJECTION_OFFSET = {}\n SAMPLE_PROJECTION_OFFSET = {}\nEND_OBJECT\nEND\n",
      height, width, width / 360.0, height / 2.0 - 0.5, width / 2.0 - 0.5);
  std::ofstream out(folder / "large.img", std::ios::binary);
  std::vector<float> row(width);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) row[x] = relief.at(x, y);
    out.write(reinterpret_cast<const char*>(row.data()), std::streamsize(4 * row.size()));
  }
  return path;
}

// Takes a file out of memory, where the system lets it.
void forget(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY);
  if (file < 0) return;
  (void)fsync(file);
  (void)posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
  (void)close(file);
}

// Largest distance of stored heights from those that were written, of every 977th post.
double error_of(const fs::path& pan, const Relief& relief) {
  DiagnosticLog log;
  const auto tiles = terrain::Tiles::open(pan, log);
  if (!tiles) return 1e9;
  const terrain::ChartRecord& chart = tiles->charts().front();
  double worst = 0;
  for (std::uint64_t i = 0; i < std::uint64_t{chart.width - 1} * chart.height; i += 977 * 101) {
    const auto x = static_cast<std::uint32_t>(i % (chart.width - 1)),
               y = static_cast<std::uint32_t>(i / (chart.width - 1));
    const std::uint32_t c = x / terrain::kTileCells, r = y / terrain::kTileCells;
    const auto view = tiles->view(tiles->index(0, 0, c, r));
    if (!view) return 1e9;
    const double found = view->height(x % terrain::kTileCells, y % terrain::kTileCells);
    worst = std::max(worst, std::fabs(found - double(relief.at(x, y))));
    // note: Linux counts what this program held when it starts another
    tiles->model().release(tiles->model().bytes());
  }
  return worst;
}

struct Cost {
  double seconds = 0, of_processors = 0, peak = 0;
  bool good = false;
};

Cost cost_of(const fs::path& tool, const Words& words) {
  const auto processors = [] {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  };
  Cost out;
  const double before = processors();
  const auto start = std::chrono::steady_clock::now();
  out.good = run_program(tool, words, &out.peak) == 0;
  out.seconds = seconds_since(start);
  out.of_processors = processors() - before;
  return out;
}

// Rows of one process: its seconds, and those of processors, which other work does not change.
void add_times(Context& context, Row row, const Cost& cost, double most) {
  const std::string setting = row.setting;
  row.case_name = "terrain_large";
  row.runs = 1;
  row.must_is_least = false;
  row.speed = cost.seconds;
  row.speed_unit = "s";
  row.must = context.quick() ? 0 : most;
  context.add(row);
  row.setting = setting + ", of processors";
  row.speed = cost.of_processors;
  row.must = 0;
  context.add(row);
}

void add_size(Context& context, Row row, const std::string& what, double bytes, double most) {
  row.case_name = "terrain_large";
  row.runs = 1;
  row.must_is_least = false;
  row.setting += ", " + what;
  row.speed = 1e-6 * bytes;
  row.speed_unit = "MB";
  row.must = context.quick() ? 0 : most;
  context.add(row);
}

struct Form {
  const char* name;
  const char* error;  // metres
  double must_error, most_megabytes;
};
constexpr Form kForms[] = {{"floats", "0", 1e-3, 3900}, {"codes", "0.05", 0.05, 2000}};

// First frames: everything is read from the disk.
bool add_frames(Context& context, const fs::path& tool, const fs::path& pan, const char* form) {
  const std::string size = context.quick() ? "160x90" : "1280x720";
  const struct {
    const char *name, *camera, *look;
  } kViews[] = {{"from 3300 km", "4.5e6 -2.2e6 1.2e6", "0 0 0"},
                {"from 20 km", "1757400 0 0", "1737400 20000 20000"}};
  for (const auto& view : kViews)
    for (const char* samples : {"1", "2"}) {
      const fs::path cold_image = context.scratch() / "cold.png",
                     warm_image = context.scratch() / "warm.png";
      const auto words = [&](const fs::path& image) {
        return Words{"render",    pan.string(), "-o",      image.string(), "--camera",
                     view.camera, "--look-at",  view.look, "--fov",        "42",
                     "--size",    size,         "--sun",   "0.9 -1 0.1",   "--samples",
                     samples,     "--quiet"};
      };
      forget(pan);
      const Cost cold = cost_of(tool, words(cold_image));
      const Cost warm = cost_of(tool, words(warm_image));
      if (!cold.good || !warm.good) return false;
      DiagnosticLog log;
      const auto a = MappedFile::open(cold_image, log), b = MappedFile::open(warm_image, log);
      Row row;
      row.error = a && b && hash128(a->bytes()) == hash128(b->bytes()) ? 0 : 1;
      row.error_unit = "images with other bytes";
      row.reference = "the same again";
      row.must_error = 0.5;
      for (const bool first : {true, false}) {
        row.setting = fmt::format("{}, frame {}, {} x {} rays, {}, {}", form, size, samples,
                                  samples, view.name, first ? "cold" : "warm");
        add_times(context, row, first ? cold : warm, first ? 0.5 : 0);
      }
    }
  return true;
}

// A frame of a descent from 100 km to 2 km with shadows, of one process for twelve.
bool add_descent(Context& context, const fs::path& tool, const fs::path& pan, const char* form) {
  constexpr int kFrames = 12;
  constexpr double kMoon = 1737400;
  const fs::path views = context.scratch() / "descent.jsonl";
  std::vector<Hash128> hashes;
  Row row;
  for (const bool first : {true, false}) {
    std::ofstream out(views);
    std::vector<fs::path> images;
    for (int k = 0; k < kFrames; ++k) {
      const double height = 2e3 + 1e5 * std::pow(0.6, k);
      images.push_back(context.scratch() / fmt::format("descent_{}_{}.png", k, int(first)));
      out << fmt::format(
          "{{\"output\": \"{}\", \"camera\": [{}, 0, 0], \"look-at\": [{}, {}, {}], \"up\": "
          "[1, 0, 0], \"fov\": 42, \"size\": [{}], \"ev\": \"auto\", \"sun\": [0.35, -1, 0.1]}}\n",
          images.back().string(), kMoon + height, kMoon, 0.35 * height, 0.35 * height,
          context.quick() ? "160, 90" : "1280, 720");
    }
    out.close();
    const Cost cost = cost_of(
        tool, {"render", pan.string(), "--views", views.string(), "--samples", "1", "--quiet"});
    if (!cost.good) return false;
    for (std::size_t k = 0; k < images.size(); ++k) {
      DiagnosticLog log;
      const auto image = MappedFile::open(images[k], log);
      if (!image) return false;
      const Hash128 hash = hash128(image->bytes());
      if (first)
        hashes.push_back(hash);
      else
        row.error += !(hash == hashes[k]);
    }
    if (first) continue;
    row.setting = fmt::format("{}, descent, frame {} x 1 rays, of {}", form,
                              context.quick() ? "160x90, 1" : "1280x720, 1", kFrames);
    row.error_unit = "images with other bytes";
    row.reference = "the same again";
    row.must_error = 0.5;
    add_times(context, row, {cost.seconds / kFrames, cost.of_processors / kFrames, cost.peak, true},
              1.0 / 3);
  }
  return true;
}

void run(Context& context) {
  const fs::path tool = context.program("panwright");
  if (tool.empty()) {
    context.note("panwright is not built beside this program: no process measured");
    return;
  }
  const std::uint32_t width = context.quick() ? 1440 : 46080, height = width / 3;
  const Relief relief(width, height);
  const fs::path map = write_map(context.scratch(), relief, width, height);
  const fs::path pan = context.scratch() / "large.pan";
  for (const Form& form : kForms) {
    const Cost made =
        cost_of(tool, {"dem", map.string(), "-o", pan.string(), "--error", form.error, "--quiet"});
    if (!made.good) return context.note("the map could not be made into tiles");
    Row row;
    row.setting = fmt::format("{}, {} x {}, tiles made", form.name, width, height);
    row.error = error_of(pan, relief);
    row.error_unit = "m";
    row.reference = "heights that were written";
    row.must_error = form.must_error;
    add_times(context, row, made, 120);
    add_size(context, row, "peak memory", made.peak, 1000);
    const auto bytes = static_cast<double>(fs::file_size(pan));
    add_size(context, row, "file", bytes, form.most_megabytes);
    for (const bool cold : {true, false}) {
      if (cold) forget(pan);
      const Cost checked = cost_of(tool, {"check", pan.string(), "--quiet"});
      Row check;
      check.setting = fmt::format("{}, all {:.0f} MB checked, {}", form.name, 1e-6 * bytes,
                                  cold ? "cold" : "warm");
      check.error = checked.good ? 0 : 1;
      check.error_unit = "files found damaged";
      check.reference = "a sound one";
      check.must_error = 0.5;
      add_times(context, check, checked, 1e-9 * bytes);
      if (!cold) add_size(context, check, "peak memory", checked.peak, 0);
    }
    if (!add_frames(context, tool, pan, form.name) || !add_descent(context, tool, pan, form.name))
      context.note("no frames: an image could not be drawn");
  }
}

const bool kAdded =
    add_case({"terrain_large",
              "46,080 x 15,360 posts: tiles made, checked, and drawn as whole processes", run});

}  // namespace
}  // namespace panwright::bench::case_terrain_large
