#include "preview/model/mesh_runs.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview {

std::vector<MeshRun> mesh_runs(const pan::MeshView& mesh) {
  const std::size_t triangles = mesh.indices.size() / 3;
  const std::size_t length = std::max<std::size_t>(64, (triangles + kMostRuns - 1) / kMostRuns);
  std::vector<MeshRun> runs;
  for (std::size_t first = 0; first < triangles; first += length) {
    MeshRun run{{},
                static_cast<std::uint32_t>(first),
                static_cast<std::uint32_t>(std::min(length, triangles - first))};
    for (std::size_t i = 3 * first; i < 3 * (first + run.count); ++i) {
      const pan::layout::Float3& p = mesh.positions[mesh.indices[i]];
      run.box.add(Vec3(p.x, p.y, p.z));
    }
    runs.push_back(run);
  }
  return runs;
}

std::span<const MeshRun> MeshRunCache::find(const std::shared_ptr<const void>& owner,
                                            const pan::Model& model, std::size_t mesh) {
  for (const Entry& entry : entries_)
    if (entry.key == owner.get() && entry.mesh == mesh && !entry.owner.expired()) return entry.runs;
  std::erase_if(entries_, [](const Entry& entry) { return entry.owner.expired(); });
  entries_.push_back({owner, owner.get(), mesh, mesh_runs(model.mesh(mesh))});
  return entries_.back().runs;
}

}  // namespace panwright::preview
