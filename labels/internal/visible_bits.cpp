#include "labels/internal/visible_bits.h"

#include <bit>
#include <optional>

#include "labels/internal/ground_bits.h"

namespace panwright::labels {

namespace {

constexpr std::uint32_t kNoLeaf = ~0u;
constexpr std::uint64_t kWholePixel = ~std::uint64_t{0};

// True: a texture has no hole where a sample sees a triangle.
class HoleTest {
 public:
  HoleTest(const Shown& shown, const DrawnPart& drawn)
      : plane_(shown.plane),
        model_(shown.scene.targets()[drawn.target].target->model()),
        part_(drawn.part),
        camera_from_mesh_(drawn.camera_from_mesh) {}

  bool is_there(const Vec2& place, std::uint32_t triangle) const {
    const auto ray = plane_.view_ray(place);
    if (!ray) return false;
    const pan::MeshView& mesh = model_.parts()[part_].mesh;
    Vec3 corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& p = mesh.positions[mesh.indices[std::size_t{3} * triangle + k]];
      corner[k] = camera_from_mesh_(Vec3(p.x, p.y, p.z));
    }
    const Vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const Vec3 across = glm::cross(ray->direction, ac);
    const double volume = glm::dot(ab, across);
    if (volume == 0) return false;
    const Vec3 from = ray->origin - corner[0];
    const double u = glm::dot(from, across) / volume;
    const double v = glm::dot(ray->direction, glm::cross(from, ab)) / volume;
    return model_.is_there(part_, triangle, Vec2(u, v));
  }

 private:
  const ImagePlane& plane_;
  const trace::Model& model_;
  std::uint32_t part_;
  trace::Affine camera_from_mesh_;
};

void draw_piece(const Shown& shown, const Surfaces& surfaces, const SurfacePiece& piece,
                const Region& region, SampleBits& bits) {
  const double top = region.top + bits.top / region.scale;
  const double bottom = top + bits.height / region.scale;
  const auto& triangles = piece.placed.triangles;
  std::optional<HoleTest> holes;
  if (!piece.placed.numbers.empty()) holes.emplace(shown, surfaces.drawn[piece.drawn]);
  for (std::size_t group = 0; group < piece.rows.size(); ++group) {
    if (piece.rows[group].first >= bottom || piece.rows[group].second <= top) continue;
    const std::size_t end = std::min(triangles.size(), (group + 1) * SurfacePiece::kGroup);
    for (std::size_t k = group * SurfacePiece::kGroup; k < end; ++k) {
      PlacedTriangle local = triangles[k];
      for (Vec2& p : local) p = region.local(p);
      if (!holes) {
        for_spans(local, bits,
                  [&](int row, int begin, int last) { set_span(bits, row, begin, last); });
        continue;
      }
      for_spans(local, bits, [&](int row, int begin, int last) {
        for (int at = begin; at < last; ++at) {
          const auto bit = static_cast<unsigned>((row & 7) * 8 + (at & 7));
          const Vec2 place = region.place(at >> 3, row >> 3, bit);
          if (holes->is_there(place, piece.placed.numbers[k])) set_span(bits, row, at, at + 1);
        }
      });
    }
  }
}

// Decides which of several leaves a sample shows.
class Judge {
 public:
  Judge(const Shown& shown, const Region& region, std::vector<LeafBits>& leaves)
      : shown_(shown), region_(region), leaves_(leaves) {}

  // `contested`: samples that several leaves have.
  void decide(int x, int y, std::uint64_t contested) {
    if (contested == kWholePixel && by_layers(x, y)) return;
    while (contested != 0) {
      const std::uint64_t group = alike(x, y, contested);
      decide_group(x, y, group);
      contested &= ~group;
    }
  }

 private:
  // The samples that have the leaves of the first one.
  std::uint64_t alike(int x, int y, std::uint64_t contested) const {
    const std::uint64_t first = contested & -contested;
    for (const LeafBits& each : leaves_) {
      const std::uint64_t word = each.amodal.at(x, y);
      contested &= (word & first) != 0 ? word : ~word;
    }
    return contested;
  }

  // Rays to those at its corners; to all where these differ.
  void decide_group(int x, int y, std::uint64_t group) {
    constexpr std::uint64_t kColumn = 0x0101010101010101u;
    std::uint64_t probes = (group & -group) | std::uint64_t{1} << (63 - std::countl_zero(group));
    for (const bool from_left : {true, false})
      for (unsigned k = 0; k < 8; ++k) {
        const std::uint64_t column = group & kColumn << (from_left ? k : 7 - k);
        if (column == 0) continue;
        probes |=
            from_left ? std::uint64_t{1} << (63 - std::countl_zero(column)) : column & -column;
        break;
      }
    std::uint32_t winner = kNoLeaf;
    bool equal = true;
    std::uint64_t shot = 0;
    for (std::uint64_t rest = probes; rest != 0 && equal; rest &= rest - 1) {
      const std::uint32_t leaf = nearest(x, y, static_cast<unsigned>(std::countr_zero(rest)));
      give(x, y, rest & -rest, leaf);
      shot |= rest & -rest;
      equal = shot == (rest & -rest) || leaf == winner;
      winner = leaf;
    }
    if (equal) {
      give(x, y, group & ~shot, winner);
      return;
    }
    for (std::uint64_t rest = group & ~shot; rest != 0; rest &= rest - 1)
      give(x, y, rest & -rest, nearest(x, y, static_cast<unsigned>(std::countr_zero(rest))));
  }

  // Index of the leaf in leaves_ that a sample shows; where a ray passes by, by rounding, the first
  // that has it.
  std::uint32_t nearest(int x, int y, unsigned bit) const {
    const auto ray = shown_.plane.view_ray(region_.place(x, y, bit));
    const trace::Hit hit = ray ? shown_.scene.nearest(*ray) : trace::Hit{};
    std::uint32_t first = kNoLeaf;
    const std::uint32_t leaf = hit ? leaf_of(hit) : kNoLeaf;
    for (std::uint32_t k = 0; k < leaves_.size(); ++k) {
      if ((leaves_[k].amodal.at(x, y) >> bit & 1u) == 0) continue;
      if (leaves_[k].leaf == leaf) return k;
      if (first == kNoLeaf) first = k;
    }
    return first;
  }

  std::uint32_t leaf_of(const trace::Hit& hit) const {
    return shown_.things.leaf_of[hit.target][shown_.scene.node_of(hit)];
  }

  void give(int x, int y, std::uint64_t samples, std::uint32_t winner) {
    if (samples == 0 || winner == kNoLeaf) return;
    LeafBits& leaf = leaves_[winner];
    leaf.visible[leaf.amodal.index(x, y)] |= samples;
  }

  // Of a whole pixel: its leaf in the image, where that and all around it are of one leaf.
  bool by_layers(int x, int y) {
    const image::Image* layers = shown_.layers;
    if (layers == nullptr || region_.scale != 1) return false;
    const int column = static_cast<int>(region_.left) + x, row = static_cast<int>(region_.top) + y;
    const int width = static_cast<int>(layers->width), height = static_cast<int>(layers->height);
    std::uint32_t leaf = kNoLeaf;
    for (int j = std::max(row - 1, 0); j <= std::min(row + 1, height - 1); ++j)
      for (int i = std::max(column - 1, 0); i <= std::min(column + 1, width - 1); ++i) {
        const std::uint32_t here =
            leaf_at(static_cast<std::size_t>(j) * layers->width + static_cast<std::size_t>(i));
        if (here == kNoLeaf || (leaf != kNoLeaf && here != leaf)) return false;
        leaf = here;
      }
    std::uint32_t winner = kNoLeaf;
    for (std::uint32_t k = 0; k < leaves_.size(); ++k) {
      const std::uint64_t word = leaves_[k].amodal.at(x, y);
      if (word != 0 && word != kWholePixel) return false;
      if (word != 0 && leaves_[k].leaf == leaf) winner = k;
    }
    if (winner == kNoLeaf) return false;
    give(x, y, kWholePixel, winner);
    return true;
  }

  std::uint32_t leaf_at(std::size_t pixel) const {
    const std::uint32_t target = shown_.layers->target_id[pixel];
    const std::uint32_t node = shown_.layers->node_id[pixel];
    if (target == 0 || node == 0 || target > shown_.things.leaf_of.size()) return kNoLeaf;
    const auto& of_node = shown_.things.leaf_of[target - 1];
    return node > of_node.size() ? kNoLeaf : of_node[node - 1];
  }

  const Shown& shown_;
  const Region& region_;
  std::vector<LeafBits>& leaves_;
};

std::size_t place_in(const Region& region, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(region.width) +
         static_cast<std::size_t>(x);
}

struct PixelRange {
  int left = 0, top = 0, right = 0, bottom = 0;
};

// The part of a region within the image.
PixelRange image_part(const Region& region, const world::Camera& camera) {
  const auto bounded = [](double v, int limit) {
    return static_cast<int>(std::clamp(v, 0.0, double(limit)));
  };
  const Vec2 low = region.local(Vec2(0)), high = region.local(Vec2(camera.width, camera.height));
  return {bounded(low.x, region.width), bounded(low.y, region.height),
          bounded(high.x, region.width), bounded(high.y, region.height)};
}

// The rectangle of the region that a leaf's box touches.
SampleBits bits_of(const Region& region, const AxisRectangle& box) {
  SampleBits bits;
  if (box.empty()) return bits;
  const auto bounded = [](double v, int limit) {
    return static_cast<int>(std::clamp(v, 0.0, double(limit)));
  };
  const Vec2 low = region.local(box.low), high = region.local(box.high);
  bits.left = bounded(std::floor(low.x), region.width);
  bits.top = bounded(std::floor(low.y), region.height);
  bits.width = bounded(std::ceil(high.x), region.width) - bits.left;
  bits.height = bounded(std::ceil(high.y), region.height) - bits.top;
  if (bits.width <= 0 || bits.height <= 0) bits.width = bits.height = 0;
  bits.words.resize(static_cast<std::size_t>(bits.width) * static_cast<std::size_t>(bits.height));
  return bits;
}

}  // namespace

std::vector<LeafBits> region_bits(const Shown& shown, const Surfaces& surfaces,
                                  const Region& region, const std::vector<char>& wanted) {
  std::vector<LeafBits> leaves;
  for (std::uint32_t leaf = 0; leaf < surfaces.boxes.size(); ++leaf) {
    SampleBits bits = bits_of(region, surfaces.boxes[leaf]);
    if (bits.words.empty()) continue;
    for (const std::uint32_t piece : surfaces.of_leaf[leaf])
      draw_piece(shown, surfaces, surfaces.pieces[piece], region, bits);
    if (surfaces.ground[leaf]) draw_ground(shown, *surfaces.ground[leaf], region, bits);
    leaves.push_back({leaf, std::move(bits), {}});
  }
  const std::size_t size =
      static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
  // samples of any leaf, of several, and of a wanted one
  std::vector<std::uint64_t> any(size), several(size), asked(size);
  for (const LeafBits& each : leaves)
    for (int y = each.amodal.top; y < each.amodal.top + each.amodal.height; ++y)
      for (int x = each.amodal.left; x < each.amodal.left + each.amodal.width; ++x) {
        const std::uint64_t word = each.amodal.words[each.amodal.index(x, y)];
        const std::size_t at = place_in(region, x, y);
        several[at] |= any[at] & word;
        any[at] |= word;
        if (wanted[each.leaf]) asked[at] |= word;
      }
  const PixelRange image = image_part(region, shown.plane.camera());
  Judge judge(shown, region, leaves);
  for (LeafBits& each : leaves) {
    each.visible.resize(each.amodal.words.size());
    const SampleBits& bits = each.amodal;
    for (int y = std::max(bits.top, image.top); y < std::min(bits.top + bits.height, image.bottom);
         ++y)
      for (int x = std::max(bits.left, image.left);
           x < std::min(bits.left + bits.width, image.right); ++x) {
        const std::size_t at = bits.index(x, y);
        each.visible[at] = bits.words[at] & ~several[place_in(region, x, y)];
      }
  }
  for (int y = image.top; y < image.bottom; ++y)
    for (int x = image.left; x < image.right; ++x) {
      const std::size_t at = place_in(region, x, y);
      const std::uint64_t contested = several[at] & asked[at];
      if (contested != 0) judge.decide(x, y, contested);
    }
  return leaves;
}

}  // namespace panwright::labels
