// Solar cells as a texture. Private to exporters.
#pragma once

#include <vector>

#include "image/texture_bake.h"
#include "materials/material.h"

namespace panwright::exporters {

// Shares of cells, grid lines and gaps over a surface; they add up to 1. Without cells, all cell.
class CellPattern {
 public:
  CellPattern() = default;
  // drawn: as a texture, if the pattern repeats with the texture coordinates; else by the mean.
  // Cost of a texture: O(texels), at most 2048² of them.
  CellPattern(const materials::Cells& cells, bool drawn);

  bool drawn() const { return !rgba_.empty(); }
  const Vec3& mean() const { return mean_; }
  image::BakeSource source() const { return {rgba_, width_, height_, false}; }  // shares as RGB
  // Returns the shares of a texel of the source, 0 to 1; the mean if it is not drawn.
  Vec3 shares(const Vec4& texel) const;
  // Returns the shares of the separate parts: each alone, or the mean.
  std::vector<Vec3> parts() const;

 private:
  Vec3 mean_{1, 0, 0};
  std::vector<std::uint8_t> rgba_;
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
};

}  // namespace panwright::exporters
