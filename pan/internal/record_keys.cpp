#include "pan/internal/record_keys.h"

#include "pan/fields.h"

namespace panwright::pan::internal {

namespace {

using layout::SectionKind;

// note: strings are hashed once each, so that many records with one long name stay cheap
Ids hashed_strings(const Model& model) {
  Ids ids(model.string_offsets().size() - 1);
  for (std::size_t i = 0; i < ids.size(); ++i)
    ids[i] = hash128(as_bytes(model.string(static_cast<std::uint32_t>(i))));
  return ids;
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

Hash128 joined(std::span<const Hash128> parts) { return hash128(std::as_bytes(parts)); }

Side::Side(const Model& m) : model(m), strings(hashed_strings(m)) {
  keys_[static_cast<std::size_t>(SectionKind::nodes)] = node_keys(m, strings);
  // keys hold references to earlier sections alone
  for (const layout::SectionInfo& info : layout::kSections)
    if (table_info(info.kind).key[0] != '\0')
      keys_[static_cast<std::size_t>(info.kind)] = keys_of(info.kind);
}

Keys Side::keys_of(SectionKind kind) const {
  Keys out;
  Numbering number;
  const auto fields = fields_of(kind, table_info(kind).key);
  const std::size_t count = model.section(kind).size() / section_info(kind).stride;
  std::vector<Hash128> parts(fields.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = record_at(model, kind, i);
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const auto id = static_cast<std::size_t>(reference_of(*fields[k], record));
      parts[k] = is_string(*fields[k])      ? strings[id]
                 : is_reference(*fields[k]) ? keys(fields[k]->target)[id]
                                            : Hash128{id, 0};
    }
    out.push_back(number(joined(parts)));
  }
  return out;
}

}  // namespace panwright::pan::internal
