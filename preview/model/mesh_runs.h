// Bounds of the parts of a mesh. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/axis_box.h"
#include "pan/model.h"

namespace panwright::preview {

// Consecutive triangles of a mesh's index array.
struct MeshRun {
  AxisBox box;              // mesh frame
  std::uint32_t first = 0;  // triangles
  std::uint32_t count = 0;
};

// Returns at most kMostRuns runs of at least 64 triangles, the last one apart. Cost: O(triangles).
std::vector<MeshRun> mesh_runs(const pan::MeshView& mesh);
inline constexpr std::size_t kMostRuns = 4096;

// Cache of the runs of meshes, while their owners live.
class MeshRunCache {
 public:
  // owner: identifies the model; another model has another one.
  std::span<const MeshRun> find(const std::shared_ptr<const void>& owner, const pan::Model& model,
                                std::size_t mesh);

 private:
  struct Entry {
    std::weak_ptr<const void> owner;
    const void* key = nullptr;  // the owner, while it lives
    std::size_t mesh = 0;
    std::vector<MeshRun> runs;
  };
  std::vector<Entry> entries_;
};

}  // namespace panwright::preview
