// Images of a model on a context. Private to preview.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "pan/model.h"
#include "preview/context.h"
#include "preview/gl/gl_objects.h"
#include "preview/model/map_levels.h"

namespace panwright::preview {

// Use of a texture. The threshold is 0 except for cutouts.
struct TextureUse {
  std::int32_t texture = 0;
  TextureRole role = TextureRole::color;
  float threshold = 0;
  auto operator<=>(const TextureUse&) const = default;
};

// Textures, stored once for each use.
class GpuTextures {
 public:
  // Returns the number of a use; the same for equal uses. All calls precede upload().
  std::uint32_t number(const TextureUse& use);

  // Fails: E5003. Throws Cancelled.
  bool upload(const Context& context, const pan::Model& model, DiagnosticLog& log, const Job& job);

  GLuint id(std::uint32_t number) const { return textures_[number].id(); }
  const TextureUse& use(std::uint32_t number) const { return uses_[number]; }
  std::uint64_t bytes() const { return bytes_; }  // uploaded

 private:
  std::vector<TextureUse> uses_;
  std::map<TextureUse, std::uint32_t> numbers_;
  std::vector<GlTexture> textures_;  // one per use
  std::uint64_t bytes_ = 0;
};

}  // namespace panwright::preview
