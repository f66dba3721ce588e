#include "mli/form.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "mli/internal/form.h"
#include "mli/internal/grid.h"

namespace panwright::mli {

double Sampler::at(double x, double y) const {
  const auto along = [](double place, double spacing, std::uint32_t count) {
    return std::min(static_cast<double>(count - 1), std::max(0.0, place / spacing));
  };
  const double u = along(x, sheet.spacing.x, sheet.columns);
  const double v = along(y, sheet.spacing.y, sheet.rows);
  const auto i = std::min(static_cast<std::uint32_t>(u), sheet.columns - 2);
  const auto j = std::min(static_cast<std::uint32_t>(v), sheet.rows - 2);
  const double s = u - i, t = v - j;
  const double low = sheet.at(i, j) + s * (sheet.at(i + 1, j) - sheet.at(i, j));
  const double high = sheet.at(i, j + 1) + s * (sheet.at(i + 1, j + 1) - sheet.at(i, j + 1));
  return low + t * (high - low);
}

Vec2 Sampler::size() const {
  return {sheet.spacing.x * (sheet.columns - 1), sheet.spacing.y * (sheet.rows - 1)};
}

void Sampler::add_grid(geometry::Mesh& mesh, std::size_t first, std::size_t columns,
                       std::size_t rows) {
  const auto index = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(first + j * columns + i);
  };
  for (std::size_t j = 0; j + 1 < rows; ++j)
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
}

bool FormProblems::length(std::string_view what, double value, bool zero) {
  if ((value >= kMinLength && value <= kMaxLength) || (zero && value == 0)) return true;
  log.report(Code("E7001"), where,
             fmt::format("the form's {} is {}, expected {} to {} m{}", what, value, kMinLength,
                         kMaxLength, zero ? ", or 0" : ""));
  return false;
}

bool FormProblems::fits(const Vec2& needed, const Vec2& sheet) {
  if (needed.x <= sheet.x * (1 + 1e-9) && needed.y <= sheet.y * (1 + 1e-9)) return true;
  log.report(
      Code("E7001"), where,
      fmt::format(
          "the sheet is {:.6g} by {:.6g} m, expected at least {:.6g} by {:.6g} m for this form",
          sheet.x, sheet.y, needed.x, needed.y));
  return false;
}

bool FormProblems::vertices(double count) {
  if (count <= kMaxVertices) return true;
  log.report(Code("E7001"), where,
             fmt::format(
                 "the form has {:.0f} vertices, expected at most {:.0f}: a coarser sheet has fewer",
                 count, kMaxVertices));
  return false;
}

void FormProblems::folded(std::size_t triangles, std::size_t all, double height, double room) {
  if (triangles == 0) return;
  log.report(Code("W7002"), where,
             fmt::format("the sheet intersects itself in {} of {} triangles: its height is {:.3g} "
                         "m, expected at most {:.3g} m",
                         std::min(triangles, all), all, height, room));
}

namespace {

geometry::Mesh flat(const Sheet& sheet) {
  geometry::Mesh mesh;
  const Vec2 size = Sampler{sheet}.size();
  mesh.positions.reserve(sheet.heights.size());
  mesh.texcoords.reserve(sheet.heights.size());
  for (std::uint32_t j = 0; j < sheet.rows; ++j)
    for (std::uint32_t i = 0; i < sheet.columns; ++i) {
      const Vec2 place(i * sheet.spacing.x, j * sheet.spacing.y);
      mesh.positions.push_back(Vec3(place - 0.5 * size, sheet.at(i, j)));
      mesh.texcoords.push_back(place);
    }
  Sampler::add_grid(mesh, 0, sheet.columns, sheet.rows);
  return mesh;
}

struct Face {
  Vec3 across, up;  // along its sides
  Vec2 place;       // of the corner on the sheet
};

// Where vertex i of n cells lies, from -1/2 to 1/2; counted from the other end the same to the bit,
// so that faces meet.
double from_middle(std::size_t i, std::size_t n) {
  const auto cells = static_cast<double>(n);
  return 0.5 * ((2 * static_cast<double>(i) - cells) / cells);
}

double rise(double inside, double flange) { return smooth_step(inside / flange - 1); }

Result<geometry::Mesh> boxed(const Sheet& sheet, const Box& box, FormProblems& problems) {
  const Vec3 s = box.size;
  if (!problems.length("flange", box.flange, false)) return failed;
  for (int k = 0; k < 3; ++k) {
    if (!problems.length("size", s[k], false)) return failed;
    if (s[k] > 2 * box.flange) continue;
    problems.log.report(
        Code("E7001"), problems.where,
        fmt::format("a side of the box is {} m, expected more than twice the flange, {} m", s[k],
                    box.flange));
    return failed;
  }
  const Sampler sampler{sheet};
  if (!problems.fits({2 * (s.x + s.y), s.z + 2 * s.y}, sampler.size())) return failed;
  const Vec3 x(s.x, 0, 0), y(0, s.y, 0), z(0, 0, s.z);
  const Face faces[] = {{x, z, {0, s.y}},          {y, z, {s.x, s.y}},
                        {-x, z, {s.x + s.y, s.y}}, {-y, z, {2 * s.x + s.y, s.y}},
                        {x, y, {0, s.y + s.z}},    {x, -y, {0, 0}}};
  // the same number of cells on every edge of a direction
  const auto cells = [&](double length) {
    return std::max(1.0, std::floor(length / sheet.spacing.x + 0.5));
  };
  const double nx = cells(s.x), ny = cells(s.y), nz = cells(s.z);
  if (!problems.vertices(2 * ((nx + 1) * (nz + 1) + (ny + 1) * (nz + 1) + (nx + 1) * (ny + 1))))
    return failed;
  geometry::Mesh mesh;
  std::size_t folded = 0;
  double deepest = 0, room = kMaxLength;
  for (const Face& face : faces) {
    const double width = glm::length(face.across), height = glm::length(face.up);
    const auto columns = static_cast<std::size_t>(cells(width)) + 1;
    const auto rows = static_cast<std::size_t>(cells(height)) + 1;
    const Vec3 normal = glm::cross(face.across / width, face.up / height);
    const Vec3 middle = 0.5 * s * normal;
    const std::size_t first = mesh.positions.size();
    for (std::size_t j = 0; j < rows; ++j)
      for (std::size_t i = 0; i < columns; ++i) {
        const double a = static_cast<double>(i) / static_cast<double>(columns - 1);
        const double b = static_cast<double>(j) / static_cast<double>(rows - 1);
        const Vec2 place = face.place + Vec2(a * width, b * height);
        const double inside = std::min(std::min(a, 1 - a) * width, std::min(b, 1 - b) * height);
        const double lift = sampler.at(place.x, place.y) *
                            rise(std::min(a, 1 - a) * width, box.flange) *
                            rise(std::min(b, 1 - b) * height, box.flange);
        if (lift < 0 && -lift >= inside) {
          folded += 2;
          deepest = std::max(deepest, -lift);
          room = std::min(room, inside);
        }
        mesh.positions.push_back(middle + from_middle(i, columns - 1) * face.across +
                                 from_middle(j, rows - 1) * face.up + lift * normal);
        mesh.texcoords.push_back(place);
      }
    Sampler::add_grid(mesh, first, columns, rows);
  }
  mesh.closed = true;
  problems.folded(folded, mesh.triangles.size(), deepest, room);
  return mesh;
}

}  // namespace

Result<geometry::Mesh> formed(const Sheet& sheet, const Form& form, DiagnosticLog& log,
                              const SourceSpan& where) {
  FormProblems problems{log, where};
  if (std::holds_alternative<Flat>(form)) return flat(sheet);
  if (const auto* box = std::get_if<Box>(&form)) return boxed(sheet, *box, problems);
  return revolved(sheet, form, problems);
}

}  // namespace panwright::mli
