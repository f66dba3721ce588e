#include "compiler/internal/storage.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "compiler/internal/shared_borders.h"

namespace panwright::compiler::internal {

void snap_meshes(const scene::Scene& scene, const pan::StorageForm& form,
                 std::span<const double> tolerances, pan::Contents& out, StorageReport& report,
                 const Job& job) {
  std::vector<PlacedSurface> placed;
  std::vector<Mat4> world;
  const std::vector<Mat4> nodes = scene::world_from_nodes(scene);
  for (std::uint32_t i = 0; i < out.instances.size(); ++i) {
    placed.push_back({out.instances[i].mesh, i});
    world.push_back(nodes[out.instances[i].node]);
  }
  for (const pan::layout::Level& level : out.levels) placed.push_back({level.mesh, level.instance});
  std::vector<double> most(out.meshes.size(), std::numeric_limits<double>::infinity());
  if (!tolerances.empty())
    for (const PlacedSurface& at : placed)
      most[at.mesh] = std::min(most[at.mesh], kStorageShare * tolerances[at.instance]);
  std::vector<Surface> surfaces;
  for (const pan::PackedMesh& mesh : out.meshes) surfaces.push_back(surface_of(mesh));
  const auto shared = shared_borders(surfaces, placed, world, Compared::all, job);
  const std::uint32_t normals = pan::normal_bits(form.bits);
  std::vector<std::uint32_t> bits(out.meshes.size());
  parallel_for(
      out.meshes.size(),
      [&](std::size_t i) {
        pan::PackedMesh& mesh = out.meshes[i];
        // too many to compare: none moves
        const std::vector<char> exact =
            shared ? (*shared)[i] : std::vector<char>(mesh.vertex_count(), 1);
        bits[i] = pan::bits_within(mesh, form.bits, most[i]);
        pan::snap(mesh, bits[i], normals, exact);
      },
      job);
  for (const std::uint32_t each : bits) report.meshes_with_more_bits += each != form.bits;
  for (pan::layout::Level& level : out.levels)
    level.error += out.meshes[level.mesh].stream.position_error +
                   out.meshes[out.instances[level.instance].mesh].stream.position_error;
}

void encode_meshes(const pan::StorageForm& form, pan::Contents& out, StorageReport& report,
                   const Job& job) {
  const std::uint32_t normals = pan::normal_bits(form.bits);
  Phase phase(job, "encoding", out.meshes.size());
  parallel_for(
      out.meshes.size(),
      [&](std::size_t i) {
        // those of levels may be new
        if (normals > 0) pan::snap_normals(out.meshes[i], normals);
        pan::encode(out.meshes[i]);
        phase.advance();
      },
      job);
  for (const pan::PackedMesh& mesh : out.meshes) {
    report.position_error = std::max(report.position_error, mesh.stream.position_error);
    report.normal_error = std::max(report.normal_error, mesh.stream.normal_error);
    report.bytes += mesh.stream.length;
  }
}

}  // namespace panwright::compiler::internal
