#include "transport/reflectance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "materials/cells.h"
#include "materials/energy.h"

namespace panwright::transport {
namespace {

Vec3 vec3(const pan::layout::Float3& v) { return {v.x, v.y, v.z}; }

// Parts of a material with their shares.
struct Share {
  materials::Material material;
  double share = 1;
};

std::vector<Share> parts_of(const materials::Material& material) {
  if (!material.cells) return {{material, 1}};
  const materials::Cells& cells = *material.cells;
  // of one whole cell
  const Vec2 pitch = 1.0 / glm::max(Vec2(cells.count[0], cells.count[1]), Vec2(1));
  const materials::CellShares shares = materials::cells_at(cells, 0.5 * pitch, pitch);
  const auto parts = materials::cell_parts(material);
  return {{parts[0], shares.cell}, {parts[1], shares.finger}, {parts[2], shares.gap}};
}

constexpr int kOrder = 32;             // nodes of quadratures: albedos within 1e-4
constexpr double kLeastGlossy = 0.02;  // albedo
constexpr double kNarrowest = 0.2;     // slope of a lobe that the rays of a surfel resolve
constexpr double kOfSlope = 1.5;       // a material's lobes beside its narrowest

// The node before a cosine, and the share of the next one.
template <int nodes>
std::pair<std::size_t, double> node_of(double mu) {
  const double place = std::clamp(mu * mu * nodes - 0.5, 0.0, nodes - 1.0);
  const auto first = std::min(static_cast<std::size_t>(place), std::size_t{nodes - 2});
  return {first, place - static_cast<double>(first)};
}

// A lobe of slopes squared over a cosine squared, of the normal to the half vector, and a square of
// light and viewer added: GGX's density over 4 (l·h)².
template <class T>
T lobe_shape(T slope2, T cosine2, T square) {
  const T denominator = cosine2 * (slope2 - 1) + 1;
  return slope2 / (static_cast<T>(kPi) * denominator * denominator * square);
}

// Its integral over viewers, by their cosines.
double lobe_albedo(double slope2, double mu) {
  constexpr int kRings = 64, kTurns = 64;
  const Vec3 to_light(std::sqrt(1 - mu * mu), 0, mu);
  double sum = 0;
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kTurns; ++k) {
      const double square = (i + 0.5) / kRings;
      const auto turn = det::sincos(2 * kPi * (k + 0.5) / kTurns);
      const double radius = std::sqrt(square);
      const Vec3 both =
          to_light + Vec3(radius * turn.cos, radius * turn.sin, std::sqrt(1 - square));
      const double all = glm::dot(both, both);
      sum += lobe_shape(slope2, both.z * both.z / all, all);
    }
  return sum * kPi / (kRings * kTurns);
}

}  // namespace

Reflectance::Reflectance(const materials::Material& material) {
  for (const Share& part : parts_of(material)) {
    if (!(part.share > 0)) continue;
    materials::Material black = part.material;
    black.diffuse = Vec3(0);
    for (int i = 0; i < kNodes; ++i) {
      const double mu = std::sqrt((i + 0.5) / kNodes);
      const auto k = static_cast<std::size_t>(i);
      const Vec3 white = materials::directional_albedo(part.material, mu, 0, {}, kOrder);
      const Vec3 without = materials::directional_albedo(black, mu, 0, {}, kOrder);
      black_[k] += part.share * without;
      white_[k] += part.share * white;
      black_mean_ += part.share * without / double{kNodes};
      white_mean_ += part.share * white / double{kNodes};
    }
  }
  emitted_ = material.emissive * material.weights.z;
  glossy_ = max_component(black_mean_) > kLeastGlossy;
  const double slope =
      materials::narrowest_slope(material, materials::Lobes::about_normal).value_or(0);
  const double wide = std::max(kNarrowest, kOfSlope * slope);
  slope2_ = static_cast<float>(wide * wide);
  for (int i = 0; i < kNodes; ++i) {
    const double mu = std::sqrt((i + 0.5) / kNodes);
    const auto k = static_cast<std::size_t>(i);
    scales_[k] = glm::vec3(black_[k] * (mu / lobe_albedo(wide * wide, mu)));
  }
}

Vec3 Reflectance::glossy(double mu) const {
  const auto [first, share] = node_of<kNodes>(mu);
  return glm::mix(black_[first], black_[first + 1], share);
}

glm::vec3 Reflectance::lobe(const glm::vec3& to_light, const glm::vec3& to_viewer,
                            const glm::vec3& normal) const {
  const glm::vec3 both = to_light + to_viewer;
  const float square = glm::dot(both, both), along = glm::dot(both, normal);
  if (!(square > 1e-12f)) return glm::vec3(0);
  const auto [first, share] = node_of<kNodes>(double{glm::dot(to_light, normal)});
  return glm::mix(scales_[first], scales_[first + 1], static_cast<float>(share)) *
         lobe_shape(slope2_, std::min(along * along / square, 1.0f), square);
}

Vec3 Reflectance::directional(double mu, const Vec3& tint) const {
  const auto [first, share] = node_of<kNodes>(mu);
  const Vec3 black = glm::mix(black_[first], black_[first + 1], share);
  const Vec3 white = glm::mix(white_[first], white_[first + 1], share);
  return black + tint * (white - black);
}

ModelReflectance::ModelReflectance(const trace::Model& model) : model_(model) {
  const pan::Model& pan = *model.model();
  for (const pan::layout::Material& record : pan.materials()) {
    materials::Material material = pan::material_from(record, {});
    materials::fit(material);
    materials_.emplace_back(material);
  }
  const auto side = [&](const trace::Model::Part& part, std::uint32_t material, bool back) {
    Side result;
    result.material = material;
    if (part.mesh.texcoords.empty()) return result;
    result.texture = back ? -1 : pan.instances()[part.instance].texture;
    result.albedo = pan.materials()[material].albedo_map;
    return result;
  };
  for (const trace::Model::Part& part : model.parts()) {
    const std::uint32_t front = pan.instances()[part.instance].material;
    const std::int32_t back = pan.back_of(part.instance);
    std::array<Side, 2> sides{side(part, front, false), side(part, front, false)};
    if (back >= 0) sides[1] = side(part, static_cast<std::uint32_t>(back), true);
    sides[0].colored = !part.mesh.colors.empty();
    sides[1].colored = sides[0].colored && back < 0;
    sides_.push_back(sides);
  }
}

ModelReflectance::At ModelReflectance::at(const Point& point) const {
  const trace::Model::Part& part = model_.parts()[point.part];
  const Side& side = sides_[point.part][point.back];
  const trace::Place place = trace::place_of(part.mesh, point.triangle, point.barycentric);
  At result{&materials_[side.material], Vec3(1)};
  const auto texel = [&](std::int32_t texture, const Vec2& at) {
    const Vec4 rgba = model_.textures()[static_cast<std::size_t>(texture)].premultiplied(at);
    return rgba.w > 0 ? Vec3(rgba) / rgba.w : Vec3(0);
  };
  if (side.texture >= 0 || side.albedo >= 0) {
    const Vec2 at = trace::texcoord_of(part.mesh, place);
    if (side.texture >= 0) result.tint *= texel(side.texture, at);
    if (side.albedo >= 0) result.tint *= texel(side.albedo, at * part.repeat);
  }
  if (side.colored) {
    Vec3 sum(0);
    for (int k = 0; k < 3; ++k)
      sum += place.weight[k] * vec3(part.mesh.colors[place.corner[static_cast<std::size_t>(k)]]);
    result.tint *= sum;
  }
  result.tint = glm::max(result.tint, Vec3(0));
  return result;
}

}  // namespace panwright::transport
