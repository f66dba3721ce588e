// Rays on terrain, in views of a descent: how fast they are answered, and how far the answers are
// from the ground below them.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "bench/bench.h"
#include "bench/relief.h"
#include "terrain/ground.h"
#include "terrain/tile_writer.h"

namespace panwright::bench::case_terrain_rays {

namespace {

constexpr double kMoon = 1737400;

struct Site {
  const char* name;
  const char* map;  // lines of the label; null: a plane
  std::uint32_t width, height;
  double post;    // metres
  double relief;  // metres of rough() = 1
};

std::optional<terrain::Ground> made(const Site& site, const std::filesystem::path& folder,
                                    DiagnosticLog& log) {
  std::string data;
  for (std::uint32_t y = 0; y < site.height; ++y)
    for (std::uint32_t x = 0; x < site.width; ++x) {
      const auto h = static_cast<float>(site.relief * rough(x, y, 512));
      char bytes[4];
      std::memcpy(bytes, &h, 4);
      data.append(bytes, 4);
    }
  std::filesystem::path path = folder / "site.hdr";
  if (site.map == nullptr) {
    std::ofstream(folder / "site.dat", std::ios::binary) << data;
    std::ofstream(path) << fmt::format(
        "ENVI\nsamples = {}\nlines = {}\nbands = 1\ndata type = 4\nbyte order = 0\n"
        "map info = {{Local, 1, 1, {}, {}, {}, {}}}\n",
        site.width, site.height, -0.5 * site.post * site.width, 0.5 * site.post * site.height,
        site.post, site.post);
  } else {
    path = folder / "site.lbl";
    std::ofstream(folder / "site.img", std::ios::binary) << data;
    std::ofstream(path) << fmt::format(
        "PDS_VERSION_ID = PDS3\n^IMAGE = \"site.img\"\nOBJECT = IMAGE\n LINES = {}\n"
        " LINE_SAMPLES = {}\n SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n UNIT = METER\nEND_OBJECT\n"
        "OBJECT = IMAGE_MAP_PROJECTION\n A_AXIS_RADIUS = 1737.4 <km>\n"
        " POSITIVE_LONGITUDE_DIRECTION = EAST\n CENTER_LONGITUDE = 0\n{}"
        " LINE_PROJECTION_OFFSET = {}\n SAMPLE_PROJECTION_OFFSET = {}\nEND_OBJECT\nEND\n",
        site.height, site.width, site.map, site.height / 2.0 - 0.5, site.width / 2.0 - 0.5);
  }
  terrain::DemOptions reading;
  reading.unit = 1;
  reading.quantity = terrain::Quantity::height;
  const auto dem = terrain::Dem::open(path, reading, log);
  if (!dem || !terrain::write_tiles({&*dem, 1}, folder / "site.pan", {}, log)) return {};
  auto tiles = terrain::Tiles::open(folder / "site.pan", log);
  if (!tiles) return {};
  return terrain::Ground(std::make_shared<const terrain::Tiles>(*std::move(tiles)));
}

// A view of 60 degrees, 45 degrees down; from afar at the centre of the body.
struct Descent {
  Vec3 eye, forward, right, down;
};

Descent descent(const terrain::Ground& ground, const terrain::LatLon& place, double height) {
  const terrain::GroundPoint below = ground.at(place);
  const bool plane = ground.tiles().charts()[0].kind == 0;
  const Vec3 up = plane ? Vec3(0, 0, 1) : glm::normalize(below.position);
  const Vec3 east = plane || std::fabs(up.z) > 0.99
                        ? Vec3(1, 0, 0) - glm::dot(Vec3(1, 0, 0), up) * up
                        : glm::cross(Vec3(0, 0, 1), up);
  const Vec3 right = glm::normalize(east), north = glm::cross(up, right);
  const Vec3 eye = below.position + height * up;
  const double dip = height > 3e4 ? 1 : std::sqrt(0.5);
  const Vec3 forward = std::sqrt(1 - dip * dip) * north - dip * up;
  return {eye, forward, right, glm::cross(forward, right)};
}

// Smooth normals at hits on a plane; their error: how far they are apart on both sides of the edges
// of triangles.
void add_normals(const Site& site, const terrain::Ground& ground, Row row,
                 std::span<const std::optional<terrain::GroundHit>> hits, std::uint32_t width,
                 Context& context) {
  std::vector<Vec3> normals(hits.size());
  const auto shade = [&](std::size_t j) {
    for (std::size_t k = j * width; k < (j + 1) * width; ++k)
      if (hits[k]) normals[k] = ground.smooth(hits[k]->point).normal;
  };
  const auto count = std::ranges::count_if(hits, [](const auto& hit) { return bool(hit); });
  if (count == 0) return;
  row.setting += ", smooth normals";
  row.speed_unit = "M/s";
  row.error_unit = "rad";
  row.reference = "beyond the edge of the triangle";
  row.must_error = 1e-6;
  set_rate(row, timed([&] { parallel_for(hits.size() / width, shade); }, context.runs()),
           double(count) / 1e6);
  row.error = 0;
  const terrain::ChartRecord& chart = ground.tiles().charts()[0];
  for (std::size_t k = 0; k < hits.size(); k += 97) {
    if (!hits[k]) continue;
    const double along = 0.25 + 0.5 * double(k % 7) / 7;
    const double x = chart.left + (hits[k]->point.column + along) * chart.dx,
                 y = chart.top - (hits[k]->point.row + along) * chart.dy;
    const auto beside = [&](double off) {
      return ground.smooth(ground.at({y + off, x + off})).normal;
    };
    const double off = 1e-7 * site.post;
    row.error = std::max(row.error, glm::length(beside(off) - beside(-off)));
  }
  context.add(row);
}

// Rays of squares of 16 x 16 pixels together; their error: those that were answered otherwise than
// one by one.
void add_squares(Row row, const terrain::Ground& ground, const Vec3& eye,
                 const std::function<Vec3(std::uint32_t, std::uint32_t)>& direction,
                 const terrain::GroundLevels* levels,
                 std::span<const std::optional<terrain::GroundHit>> alone, std::uint32_t width,
                 Context& context) {
  constexpr std::uint32_t kSide = 16;
  const auto rows = static_cast<std::uint32_t>(alone.size() / width);
  const std::uint32_t across = (width + kSide - 1) / kSide, down = (rows + kSide - 1) / kSide;
  std::vector<std::optional<terrain::GroundHit>> hits(alone.size());
  const auto cast = [&](std::size_t square) {
    const auto left = static_cast<std::uint32_t>(square % across) * kSide,
               top = static_cast<std::uint32_t>(square / across) * kSide;
    const std::uint32_t right = std::min(left + kSide, width), bottom = std::min(top + kSide, rows);
    std::vector<Vec3> directions;
    for (std::uint32_t j = top; j < bottom; ++j)
      for (std::uint32_t i = left; i < right; ++i) directions.push_back(direction(i, j));
    const Vec3 axis = glm::normalize(directions.front() + directions.back());
    const double angle = 1.1 * std::acos(glm::dot(axis, directions.front()));
    const auto beam = ground.beam({eye, 0, axis, angle}, levels);
    const std::vector<double> most(directions.size(), 1e9);
    std::vector<std::optional<terrain::GroundHit>> found(directions.size());
    ground.nearest(eye, directions, most, found, levels, beam ? &*beam : nullptr);
    auto next = found.begin();
    for (std::uint32_t j = top; j < bottom; ++j)
      for (std::uint32_t i = left; i < right; ++i) hits[std::size_t{j} * width + i] = *next++;
  };
  row.setting += ", squares of 16 x 16 together";
  row.error_unit = "rays";
  row.reference = "one by one";
  row.must_error = 0;
  set_rate(row, timed([&] { parallel_for(std::size_t{across} * down, cast); }, context.runs()),
           double(hits.size()) / 1e6);
  row.error = 0;
  for (std::size_t k = 0; k < hits.size(); ++k)
    row.error += hits[k].has_value() != alone[k].has_value() ||
                 (hits[k] && hits[k]->distance != alone[k]->distance);
  context.add(row);
}

void add_view(const Site& site, const terrain::Ground& ground, double height, bool levels,
              Context& context) {
  const std::uint32_t width = context.quick() ? 64 : 640, rows = context.quick() ? 36 : 360;
  const terrain::LatLon place =
      site.map == nullptr
          ? terrain::LatLon{3, 7}
          : (site.width == site.height ? terrain::LatLon{-89.9, 30} : terrain::LatLon{10, 20});
  const Descent view = descent(ground, place, height);
  const double focal = width / (2 * std::sqrt(1.0 / 3));
  // half a pixel at the corner, of an image of twice this size
  const double corner = 1 + 1.0 / 3 * (1 + 81.0 / 256);
  const auto chosen = ground.levels(view.eye, 0.5 / focal / 2 / corner);
  const terrain::GroundLevels* used = levels ? &chosen : nullptr;
  std::vector<std::optional<terrain::GroundHit>> hits(std::size_t{width} * rows);
  const auto direction = [&](std::uint32_t i, std::uint32_t j) {
    return glm::normalize(focal * view.forward + (i + 0.5 - width / 2.0) * view.right +
                          (j + 0.5 - rows / 2.0) * view.down);
  };
  const auto cast = [&](std::size_t j) {
    for (std::uint32_t i = 0; i < width; ++i)
      hits[j * width + i] =
          ground.nearest(view.eye, direction(i, static_cast<std::uint32_t>(j)), 0, 1e9, used);
  };
  const auto all = [&] { parallel_for(rows, cast); };
  Row row;
  row.case_name = "terrain_rays";
  row.speed_unit = "Mrays/s";
  row.error_unit = levels ? "px" : "m";
  row.reference = levels ? "rays at level 0" : "the ground below the hits";
  row.reference_error = 1e-12;
  // no level is further off than half a pixel
  row.must_error = levels ? 0.5 : 1e-6;
  row.setting = fmt::format("{}, from {} m{}", site.name, height, levels ? ", levels" : "");
  const double start = double(hits.size()) / 1e6;
  set_rate(row, timed(all, context.runs()), start);
  row.error = 0;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    if (!hits[k]) continue;
    const terrain::GroundPoint& hit = hits[k]->point;
    const Vec3 p = hit.position;
    const terrain::GroundPoint below = ground.at(
        site.map == nullptr ? terrain::LatLon{p.y, p.x}
                            : terrain::LatLon{std::atan2(p.z, std::hypot(p.x, p.y)) / kDegree,
                                              std::atan2(p.y, p.x) / kDegree});
    const double off = below ? std::fabs(below.height - hit.height) : levels ? 0 : 1e9;
    row.error = std::max(row.error, levels ? off / hits[k]->distance * 2 * focal * corner : off);
  }
  context.add(row);
  add_squares(row, ground, view.eye, direction, used, hits, width, context);
  if (levels) return;
  if (site.map == nullptr) add_normals(site, ground, row, hits, width, context);
  // to a Sun 10 degrees high
  const Vec3 toward =
      glm::normalize(view.right + std::tan(10 * kDegree) * view.eye / glm::length(view.eye));
  const Vec3 sun =
      site.map == nullptr ? glm::normalize(Vec3(1, 0, std::tan(10 * kDegree))) : toward;
  std::vector<std::uint8_t> dark(hits.size());
  row.setting += ", to the Sun";
  row.reference = "nearest hits";
  row.error_unit = "rays";
  row.must_error = 0;
  const auto shade = [&](std::size_t j) {
    for (std::size_t k = j * width; k < (j + 1) * width; ++k)
      if (hits[k])
        dark[k] =
            ground.is_blocked(hits[k]->point.position + 1e-3 * hits[k]->point.normal, sun, 0, 1e6);
  };
  const auto shaded = std::ranges::count_if(hits, [](const auto& hit) { return bool(hit); });
  set_rate(row, timed([&] { parallel_for(rows, shade); }, context.runs()), double(shaded) / 1e6);
  row.error = 0;
  for (std::size_t k = 0; k < hits.size(); k += 97)
    if (hits[k])
      row.error +=
          dark[k] !=
          ground.nearest(hits[k]->point.position + 1e-3 * hits[k]->point.normal, sun, 0, 1e6)
              .has_value();
  context.add(row);
}

// Look-ups of an albedo map, at places of another one's pixels, beside means of its numbers.
void add_albedo(Context& context) {
  const std::uint32_t side = context.quick() ? 256 : 2048;
  std::vector<float> values;
  for (std::uint32_t k = 0; k < side * side; ++k)
    values.push_back(static_cast<float>(0.1 + (k * 2654435761u >> 8) % 1000 / 1000.0));
  const auto folder = context.scratch();
  std::ofstream(folder / "albedo.dat", std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(4 * values.size()));
  std::ofstream(folder / "albedo.hdr") << fmt::format(
      "ENVI\nsamples = {0}\nlines = {0}\nbands = 1\ndata type = 4\nbyte order = 0\n"
      "map info = {{Local, 1, 1, 0, 0, 1, 1}}\n",
      side);
  DiagnosticLog log;
  terrain::DemOptions reading;
  reading.unit = 1;
  reading.quantity = terrain::Quantity::height;
  const auto dem = terrain::Dem::open(folder / "albedo.hdr", reading, log);
  reading.quantity = terrain::Quantity::plain;
  auto map = terrain::Dem::open(folder / "albedo.hdr", reading, log);
  terrain::TilesOptions options;
  if (map) options.albedo.push_back({{*std::move(map)}, 1.0, {}, {}});
  if (!dem || !terrain::write_tiles({&*dem, 1}, folder / "albedo.pan", options, log))
    return context.note("no albedo map: " + to_text(log));
  const auto tiles = terrain::Tiles::open(folder / "albedo.pan", log);
  if (!tiles) return context.note("no albedo map: " + to_text(log));
  for (const std::uint32_t unit : {1u, 4u, 32u}) {
    const std::uint32_t across = side / unit;
    std::vector<double> found(std::size_t{across} * across), wanted(found.size());
    for (std::uint32_t y = 0; y < across * unit; ++y)
      for (std::uint32_t x = 0; x < across * unit; ++x)
        wanted[std::size_t{y / unit} * across + x / unit] +=
            double(values[std::size_t{y} * side + x]) / (unit * unit);
    const auto look = [&](std::size_t j) {
      for (std::uint32_t i = 0; i < across; ++i)
        found[j * across + i] = tiles->albedo().at({-(j + 0.5) * unit, (i + 0.5) * unit}, unit).y;
    };
    Row row{.case_name = "terrain_rays",
            .setting = fmt::format("albedo, means of {0} x {0} pixels", unit),
            .speed_unit = "M/s",
            .error_unit = "largest, of the largest number",
            .reference = "sums over the source"};
    set_rate(row, timed([&] { parallel_for(across, look); }, context.runs()),
             double(found.size()) / 1e6);
    for (std::size_t k = 0; k < found.size(); ++k)
      row.error = std::max(row.error, std::fabs(found[k] - wanted[k]) / 1.099);
    row.must_error = 1e-5;
    context.add(row);
  }
}

void run_rays(Context& context) {
  add_albedo(context);
  const std::uint32_t side = context.quick() ? 300 : 2049;
  const Site sites[] = {
      {"plane of 5 m", nullptr, side, side, 5, 1.1},
      {"pole, 5 m",
       " MAP_PROJECTION_TYPE = \"POLAR STEREOGRAPHIC\"\n CENTER_LATITUDE = -90\n MAP_SCALE = 5 "
       "<m/pix>\n",
       side, side, 5, 1.1},
      {"globe, 2665 m",
       context.quick() ? " MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n CENTER_LATITUDE = 0\n "
                         "MAP_RESOLUTION = "
                         "1.6666666666666667 <pix/deg>\n"
                       : " MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n CENTER_LATITUDE = 0\n "
                         "MAP_RESOLUTION = "
                         "11.377777777777778 <pix/deg>\n",
       context.quick() ? 600u : 4096u, context.quick() ? 300u : 2048u, 2665, 100}};
  for (const Site& site : sites) {
    DiagnosticLog log;
    const auto ground = made(site, context.scratch(), log);
    if (!ground) return context.note("no terrain: " + to_text(log));
    const bool globe = site.post > 1000;
    for (const double height :
         globe ? std::vector<double>{2e4, 1e6} : std::vector<double>{1.5, 20, 205, 2048})
      add_view(site, *ground, height, false, context);
    // from where a pixel is wider than posts
    add_view(site, *ground, globe ? 3e7 : 5e4, true, context);
  }
}

const bool kAdded = add_case({"terrain_rays", "rays on terrain in views of a descent", run_rays});

}  // namespace
}  // namespace panwright::bench::case_terrain_rays
