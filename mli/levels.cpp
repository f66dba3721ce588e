#include "mli/levels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <variant>

#include "geometry/mesh/strip.h"
#include "mli/internal/tilts.h"

namespace panwright::mli {
namespace {

constexpr std::uint32_t kLeastFlat = 32, kLeastRound = 48;
constexpr double kMostOff = 0.1;  // SlopeDensity::distance() of a level

// The smallest radius of a form, metres; 0: it is made of planes.
double radius_of(const Form& form, const Sheet& sheet) {
  const double width = sheet.spacing.x * (sheet.columns - 1);
  if (const auto* tube = std::get_if<Tube>(&form))
    return tube->radius > 0 ? tube->radius : width / (2 * kPi);
  if (const auto* cone = std::get_if<Cone>(&form)) return cone->radius;
  return 0;
}

// The height of a sheet at a place, in its own cells, linear in its triangles.
double height_at(const Sheet& sheet, const Vec2& at) {
  const Vec2 low = glm::clamp(glm::floor(at), Vec2(0), Vec2(sheet.columns - 2, sheet.rows - 2));
  const Vec2 in = at - low;
  const auto column = static_cast<std::uint32_t>(low.x), row = static_cast<std::uint32_t>(low.y);
  const double a = sheet.at(column, row), d = sheet.at(column + 1, row + 1);
  // cut from (i, j) to (i + 1, j + 1)
  const double beside = in.x >= in.y ? sheet.at(column + 1, row) : sheet.at(column, row + 1);
  return in.x >= in.y ? a + in.x * (beside - a) + in.y * (d - beside)
                      : a + in.y * (beside - a) + in.x * (d - beside);
}

// Of the place of a fine vertex.
Vec2 coarse_per_fine(const Sheet& fine, const Sheet& coarse) {
  return Vec2(coarse.columns - 1, coarse.rows - 1) / Vec2(fine.columns - 1, fine.rows - 1);
}

std::vector<Vec3> upright(const geometry::Mesh& mesh) {
  return std::vector<Vec3>(mesh.positions.size(), Vec3(0, 0, 1));
}

// What a sheet is shaded with where it lies flat.
struct FlatMesh {
  geometry::Mesh mesh;      // with normals
  std::vector<char> lower;  // below_diagonals()
};

FlatMesh flat_mesh(const Sheet& sheet, double crease_angle) {
  DiagnosticLog log;
  auto mesh = formed(sheet, Flat{}, log);
  if (!mesh) return {};
  FlatMesh out{*std::move(mesh), {}};
  out.lower = below_diagonals(out.mesh);
  geometry::compute_normals(out.mesh, crease_angle);
  return out;
}

// A mesh's normals, set apart; where they are not, the mesh itself.
geometry::Mesh with_apart(const FlatMesh& flat, double apart) {
  geometry::Mesh mesh = flat.mesh, surface = flat.mesh;
  if (!(apart > 0)) return mesh;
  for (Vec3& p : surface.positions) p.z = 0;
  std::vector<Vec3> below = upright(mesh);
  set_apart(mesh, below, surface, flat.lower, apart);
  return mesh;
}

// The sum of the variances of the facets' slopes along both axes, two triangles to a cell.
double facet_variance(const Sheet& sheet) {
  double sum = 0, square = 0;
  Vec2 mean(0);
  for (std::uint32_t j = 0; j + 1 < sheet.rows; ++j)
    for (std::uint32_t i = 0; i + 1 < sheet.columns; ++i) {
      const double a = sheet.at(i, j), b = sheet.at(i + 1, j), c = sheet.at(i + 1, j + 1),
                   d = sheet.at(i, j + 1);
      for (const Vec2& slope :
           {Vec2(b - a, c - b) / sheet.spacing, Vec2(c - d, d - a) / sheet.spacing}) {
        mean += slope;
        square += glm::dot(slope, slope);
        sum += 1;
      }
    }
  mean /= sum;
  return square / sum - glm::dot(mean, mean);
}

// How the slopes of a mesh's normals are distributed: their density at 33 places up to twice a
// deviation, each seen through a Gaussian as wide as a narrow lobe.
class SlopeDensity {
 public:
  explicit SlopeDensity(double deviation) {
    const double kernel = std::max(kLobe, deviation / 4);
    scale_ = 1 / (2 * kernel * kernel);
    places_.push_back(Vec2(0));
    for (int ring = 1; ring <= 4; ++ring)
      for (int k = 0; k < 8; ++k) {
        const auto t = det::sincos((k + 0.5 * (ring % 2)) * kPi / 4);
        places_.push_back(Vec2(t.cos, t.sin) * (0.5 * ring * deviation));
      }
  }

  // factor: of all slopes
  std::vector<double> of(const geometry::Mesh& mesh, double factor = 1) const {
    std::vector<double> density(places_.size());
    // of many every so many-th
    const std::size_t step = mesh.triangles.size() / kSample + 1;
    double count = 0;
    for (std::size_t k = 0; k < mesh.triangles.size(); k += step, ++count) {
      const geometry::Triangle& t = mesh.triangles[k];
      const Vec3 all = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
      // the middles of four equal parts
      for (std::size_t part = 0; part < 4; ++part) {
        const Vec3 n = part == 3 ? all : all + 3.0 * mesh.normals[t[part]];
        const Vec2 slope(-n.x / n.z, -n.y / n.z);
        for (std::size_t i = 0; i < places_.size(); ++i) {
          const Vec2 off = factor * slope - places_[i];
          density[i] += det::exp(-scale_ * glm::dot(off, off));
        }
      }
    }
    for (double& value : density) value /= 4 * count;
    return density;
  }

  // The mean difference over the mean density.
  static double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double off = 0, sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      off += std::fabs(a[i] - b[i]);
      sum += a[i];
    }
    return off / sum;
  }

 private:
  static constexpr double kLobe = 0.05;
  static constexpr std::size_t kSample = 20011;  // a prime: no multiple of the triangles of a row
  std::vector<Vec2> places_;
  double scale_ = 0;
};

// Of a level with so many cells across.
Vec2 spacing_of(const Sheet& sheet, std::uint32_t cells) {
  const Vec2 size = sheet.spacing * Vec2(sheet.columns - 1, sheet.rows - 1);
  return size / Vec2(cells, std::max(1.0, std::floor(size.y / size.x * cells + 0.5)));
}

// What a level has to be like.
struct Finest {
  // cells: across the levels that will be asked for
  Finest(const Sheet& sheet, double crease_angle, std::span<const std::uint32_t> cells)
      : Finest(sheet, flat_mesh(sheet, crease_angle).mesh, cells) {}
  double facets;      // the variance of their slopes, both axes together
  TiltSpread spread;  // of the slopes that it is shaded with
  SlopeDensity density;
  std::vector<double> wanted;
  std::map<std::uint32_t, double> within;  // Moments::within over all, by cells

 private:
  Finest(const Sheet& sheet, const geometry::Mesh& mesh, std::span<const std::uint32_t> cells)
      : facets(facet_variance(sheet)),
        spread(Tilts(mesh, upright(mesh)).spread()),
        density(std::sqrt(spread.variance / 2)),
        wanted(density.of(mesh)) {
    for (const std::uint32_t across : cells) {
      const Moments moments = moments_of(mesh, spacing_of(sheet, across));
      within[across] = moments.all > 0 ? moments.within / moments.all : 0;
    }
  }
};

// Makes similar().
class Maker {
 public:
  Maker(const Sheet& fine, const Finest& finest, std::uint32_t cells, double crease_angle,
        const Job& job)
      : fine_(fine),
        finest_(finest),
        out_(filtered(fine, cells, job)),
        crease_angle_(crease_angle),
        job_(job) {}

  Similar run() {
    base_ = out_.heights;
    lose();
    fade();
    Similar done;
    if (finest_.facets > 0) {
      choose();
      const FlatMesh flat = flat_mesh(out_, crease_angle_);
      const double apart = apart_of(flat);
      geometry::Mesh mesh = with_apart(flat, apart);
      const std::vector<Vec3> below = upright(mesh);
      done.tilts = Tilts(mesh, below).towards_all(finest_.spread);
      done.tilts.apart = apart;
      tilt(mesh.normals, below, std::vector<Vec3>(mesh.normals.size(), Vec3(1, 0, 0)), done.tilts);
      done.off = SlopeDensity::distance(finest_.wanted, finest_.density.of(mesh));
    }
    out_.statistics = measured(out_.heights, out_.columns, out_.spacing, job_);
    done.sheet = std::move(out_);
    return done;
  }

 private:
  static constexpr std::size_t kManyVertices = 20000;
  static constexpr double kWithinShare = 0.3;  // of unlike()
  static constexpr double kMostApart = 1.5;

  // Places beyond the last vertex go back.
  static std::size_t mirrored(std::size_t place, std::size_t count) {
    const std::size_t there = place % (2 * (count - 1));
    return there < count ? there : 2 * (count - 1) - there;
  }

  // What filtering took away, at the fine vertices.
  void lose() {
    const Vec2 scale = coarse_per_fine(fine_, out_);
    lost_.resize(fine_.heights.size());
    for (std::uint32_t j = 0; j < fine_.rows; ++j)
      for (std::uint32_t i = 0; i < fine_.columns; ++i)
        lost_[std::size_t{j} * fine_.columns + i] =
            fine_.at(i, j) - height_at(out_, Vec2(i, j) * scale);
  }

  // How much of its relief the sheet has in each coarse column and row: 1 but towards edges.
  void fade() {
    const Vec2 scale = coarse_per_fine(fine_, out_);
    across_.assign(out_.columns, 0);
    up_.assign(out_.rows, 0);
    std::vector<double> in_column(out_.columns), in_row(out_.rows);
    for (std::uint32_t j = 0; j < fine_.rows; ++j)
      for (std::uint32_t i = 0; i < fine_.columns; ++i) {
        const double square =
            lost_[std::size_t{j} * fine_.columns + i] * lost_[std::size_t{j} * fine_.columns + i];
        const auto column = static_cast<std::size_t>(i * scale.x + 0.5);
        const auto row = static_cast<std::size_t>(j * scale.y + 0.5);
        across_[column] += square;
        up_[row] += square;
        in_column[column] += 1;
        in_row[row] += 1;
      }
    level(across_, in_column);
    level(up_, in_row);
  }

  // Root mean squares over their median, at most 1.
  static void level(std::vector<double>& sums, const std::vector<double>& counts) {
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] = counts[i] > 0 ? std::sqrt(sums[i] / counts[i]) : 0;
    std::vector<double> sorted = sums;
    std::nth_element(sorted.begin(),
                     sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double median = sorted[sorted.size() / 2];
    for (double& value : sums) value = median > 0 ? std::min(value / median, 1.0) : 1;
  }

  void choose() {
    const std::uint32_t right = fine_.columns - out_.columns, above = fine_.rows - out_.rows;
    // many cells are a sample already
    const std::uint32_t side = out_.heights.size() > kManyVertices ? 2 : 4;
    std::vector<double> best;
    double least = HUGE_VAL, kept = 1;
    for (const std::uint32_t step : {2u, 1u}) {
      double square = 1;  // of the factor of heights
      for (std::uint32_t k = 0; k < side * side; ++k) {
        job_.poll();
        take((right * (k % side)) / (side - 1), (above * (k / side)) / (side - 1), step);
        if (k == 0) square = calibrated(square);
        add_piece(std::sqrt(square));
        const double off = unlike(flat_mesh(out_, crease_angle_).mesh);
        if (!best.empty() && off >= least) continue;
        least = off;
        kept = square;
        best = piece_;
      }
    }
    piece_ = std::move(best);
    add_piece(std::sqrt(calibrated(kept)));
  }

  // How differently slopes are distributed, once their variance is right, and how much too little
  // they differ within a cell.
  double unlike(const geometry::Mesh& mesh) const {
    const Moments moments = moments_of(mesh, out_.spacing);
    if (!(moments.all > 0)) return HUGE_VAL;
    const double factor = std::sqrt(finest_.spread.variance / moments.all);
    const double off = SlopeDensity::distance(finest_.wanted, finest_.density.of(mesh, factor));
    const double wanted = finest_.within.at(out_.columns - 1) * moments.all;
    return wanted > moments.within ? off + kWithinShare * (1 - moments.within / wanted) : off;
  }

  // TiltMap::apart with which slopes differ within a cell as much as the finest sheet's, as a share
  // of all; at most kMostApart. Both are polynomials of second degree in it.
  double apart_of(const FlatMesh& flat) const {
    const double wanted = finest_.within.at(out_.columns - 1);
    double missing[3];
    for (int k = 0; k < 3; ++k) {
      const Moments moments = moments_of(with_apart(flat, k), out_.spacing);
      missing[k] = wanted * moments.all - moments.within;
    }
    if (!(missing[0] > 0)) return 0;
    const double square = (missing[0] - 2 * missing[1] + missing[2]) / 2;
    const double line = missing[1] - missing[0] - square;
    double low = 0, high = kMostApart;
    for (int step = 0; step < 30; ++step) {
      const double middle = (low + high) / 2;
      (missing[0] + middle * (line + middle * square) > 0 ? low : high) = middle;
    }
    return low;
  }

  // The piece from a fine vertex on, of those `step` apart, enlarged.
  void take(std::uint32_t column, std::uint32_t row, std::uint32_t step) {
    piece_.resize(base_.size());
    double mean = 0;
    for (std::uint32_t j = 0; j < out_.rows; ++j)
      for (std::uint32_t i = 0; i < out_.columns; ++i)
        mean += piece_[std::size_t{j} * out_.columns + i] =
            lost_[mirrored(row + step * j, fine_.rows) * fine_.columns +
                  mirrored(column + step * i, fine_.columns)];
    mean /= static_cast<double>(piece_.size());
    const double enlarged = out_.spacing.x / fine_.spacing.x;
    for (std::uint32_t j = 0; j < out_.rows; ++j)
      for (std::uint32_t i = 0; i < out_.columns; ++i) {
        double& height = piece_[std::size_t{j} * out_.columns + i];
        height = (height - mean) * enlarged * std::min(across_[i], up_[j]);
      }
  }

  void add_piece(double factor) {
    for (std::size_t i = 0; i < base_.size(); ++i) out_.heights[i] = base_[i] + factor * piece_[i];
  }

  // The square of the factor with which the slopes have the variance that is wanted, from a first
  // guess; 0: they have it without the piece, or the piece has none. The variance is about linear
  // in it.
  double calibrated(double square) {
    const auto variance = [&](double factor) {
      add_piece(factor);
      return facet_variance(out_);
    };
    const double none = variance(0);
    if (none >= finest_.facets) return 0;
    for (int step = 0; step < 4; ++step) {
      const double at = variance(std::sqrt(square));
      if (!(at > none)) return 0;
      if (std::fabs(at - finest_.facets) < 1e-3 * finest_.facets) break;
      square = std::min(square * (finest_.facets - none) / (at - none), 64.0);
    }
    return square;
  }

  const Sheet& fine_;
  const Finest& finest_;
  Sheet out_;
  double crease_angle_;
  const Job& job_;
  std::vector<double> base_, lost_, piece_, across_, up_;
};

}  // namespace

double height_error(const Sheet& fine, const Sheet& coarse) {
  const Vec2 scale = coarse_per_fine(fine, coarse);
  double most = 0;
  for (std::uint32_t j = 0; j < fine.rows; ++j)
    for (std::uint32_t i = 0; i < fine.columns; ++i)
      most = std::max(most, std::fabs(fine.at(i, j) - height_at(coarse, Vec2(i, j) * scale)));
  return most;
}

Covariance shaded_slopes(const geometry::Mesh& mesh) {
  const auto slope = [&](std::uint32_t vertex) {
    const Vec3& n = mesh.normals[vertex];
    return Vec2(-n.x / n.z, -n.y / n.z);
  };
  double area = 0;
  Vec2 mean(0);
  Covariance sum;
  for (const geometry::Triangle& triangle : mesh.triangles) {
    const Vec2 a(mesh.positions[triangle[0]]), b(mesh.positions[triangle[1]]),
        c(mesh.positions[triangle[2]]);
    const double weight = std::fabs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
    area += weight;
    Vec2 all(0);
    const auto add = [&](const Vec2& s, double factor) {
      sum.xx += factor * s.x * s.x;
      sum.xy += factor * s.x * s.y;
      sum.yy += factor * s.y * s.y;
    };
    // the mean of the square of what is linear over a triangle
    for (const std::uint32_t vertex : triangle) {
      const Vec2 s = slope(vertex);
      all += s;
      add(s, weight / 12);
    }
    add(all, weight / 12);
    mean += all * (weight / 3);
  }
  if (!(area > 0)) return {};
  mean /= area;
  return {sum.xx / area - mean.x * mean.x, sum.xy / area - mean.x * mean.y,
          sum.yy / area - mean.y * mean.y};
}

Similar similar(const Sheet& sheet, std::uint32_t cells, double crease_angle, const Job& job) {
  return Maker(sheet, Finest(sheet, crease_angle, std::span(&cells, 1)), cells, crease_angle, job)
      .run();
}

void compute_normals(geometry::Mesh& mesh, geometry::Mesh surface, double crease_angle,
                     const TiltMap& tilts) {
  const std::vector<char> lower = below_diagonals(mesh);
  geometry::compute_normals(mesh, crease_angle);
  geometry::compute_normals(surface, crease_angle);
  std::vector<Vec3> below = normals_below(mesh, surface);
  if (tilts.apart > 0) set_apart(mesh, below, surface, lower, tilts.apart);
  tilt(mesh.normals, below, along_sheet(mesh, surface, lower), tilts);
}

std::vector<Level> levels_of(const Sheet& sheet, const Form& form, double crease_angle,
                             double max_vertices, const Trim& trim, const Job& job) {
  std::vector<Level> levels;
  const std::uint32_t least = std::holds_alternative<Flat>(form) ? kLeastFlat : kLeastRound;
  const double radius = radius_of(form, sheet);
  std::vector<std::uint32_t> all_cells;
  for (std::uint32_t cells = (sheet.columns - 1) / 2; cells >= least; cells /= 2)
    all_cells.push_back(cells);
  const Finest finest(sheet, crease_angle, all_cells);
  double vertices = 0;
  for (const std::uint32_t cells : all_cells) {
    job.poll();
    Similar made = Maker(sheet, finest, cells, crease_angle, job).run();
    if (made.off > kMostOff) break;
    const Sheet& coarse = made.sheet;
    // two normals at each
    const double more = (made.tilts.apart > 0 ? 2 : 1) * static_cast<double>(coarse.heights.size());
    if (vertices + more > max_vertices) continue;
    vertices += more;
    DiagnosticLog log;  // what the finest sheet reports is already reported
    Sheet level_sheet = coarse;
    std::ranges::fill(level_sheet.heights, 0.0);
    auto mesh = formed(coarse, form, log);
    auto surface = formed(level_sheet, form, log), plane = formed(level_sheet, Flat{}, log);
    auto lying = formed(coarse, Flat{}, log);
    if (!mesh || !surface || !plane || !lying) break;
    compute_normals(*mesh, *surface, crease_angle, made.tilts);
    geometry::compute_normals(*surface, crease_angle);
    compute_normals(*lying, *std::move(plane), crease_angle, made.tilts);
    Level& level = levels.emplace_back();
    level.covers = trimmed(*mesh, *surface, trim);
    level.mesh = *std::move(mesh);
    level.detail = coarse.spacing.x;
    level.error =
        height_error(sheet, coarse) + (radius > 0 ? level.detail * level.detail / (8 * radius) : 0);
    level.slopes = shaded_slopes(*lying);
  }
  return levels;
}

}  // namespace panwright::mli
