#include "pan/internal/record_keys.h"

namespace panwright::pan::internal {

namespace {

// note: strings are hashed once each, so that many records with one long name stay cheap
Ids hashed_strings(const Model& model) {
  Ids ids(model.string_offsets().size() - 1);
  for (std::size_t i = 0; i < ids.size(); ++i)
    ids[i] = hash128(as_bytes(model.string(static_cast<std::uint32_t>(i))));
  return ids;
}

template <class Record>
Keys named_keys(std::span<const Record> records, const Ids& strings) {
  Keys keys;
  Numbering number;
  for (const Record& record : records) keys.push_back(number(strings[record.name]));
  return keys;
}

Keys node_keys(const Model& model, const Ids& strings) {
  Keys keys;
  Numbering number;
  for (const layout::Node& node : model.nodes()) {
    const Hash128 parent = node.parent < 0 ? Hash128{} : keys[node.parent];
    keys.push_back(number(joined({parent, strings[node.name]})));
  }
  return keys;
}

}  // namespace

Hash128 joined(std::initializer_list<Hash128> parts) {
  return hash128(std::as_bytes(std::span(parts.begin(), parts.size())));
}

Side::Side(const Model& m)
    : model(m),
      strings(hashed_strings(m)),
      nodes(node_keys(m, strings)),
      meshes(named_keys(m.meshes(), strings)),
      materials(named_keys(m.materials(), strings)),
      textures(named_keys(m.textures(), strings)),
      frames(named_keys(m.frames(), strings)),
      instances(instance_keys(m)),
      keypoints(named_keys(m.keypoints(), strings)),
      decals(named_keys(m.decals(), strings)),
      joints(named_keys(m.joints(), strings)) {
  for (const layout::Sheet& sheet : m.sheets()) sheets.push_back(meshes[sheet.mesh]);
  Numbering number;
  for (const layout::Level& level : m.levels())
    levels.push_back(number(joined({instances[level.instance], meshes[level.mesh]})));
}

Keys Side::instance_keys(const Model& m) const {
  Keys keys;
  Numbering number;
  for (const layout::Instance& instance : m.instances())
    keys.push_back(number(joined({nodes[instance.node], meshes[instance.mesh]})));
  return keys;
}

}  // namespace panwright::pan::internal
