#include "importers/gltf/document.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "base/file.h"

namespace panwright::importers::gltf {

std::size_t component_bytes(int component) {
  switch (component) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

std::string pointer(std::string_view collection, std::size_t index) {
  return fmt::format("/{}/{}", collection, index);
}

SourceSpan Document::place_of(std::uint32_t offset) const {
  if (!text) return {source, 0, 0};
  return {source, json_begin + offset, json_begin + offset + 1};
}

void Document::report(Code code, std::uint32_t offset, const std::string& object,
                      std::string message, std::string hint) {
  log.report(code, place_of(offset), std::move(message), std::move(hint), object);
}

const Json& Document::nearest(std::string_view object) const {
  const Json* at = &root;
  while (object.starts_with('/')) {
    object.remove_prefix(1);
    const std::string_view part = object.substr(0, object.find('/'));
    object.remove_prefix(part.size());
    const Json* next = at->find(part);
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    if (!next && at->is(Json::Kind::array) && error == std::errc() &&
        end == part.data() + part.size() && index < at->items.size())
      next = &at->items[index];
    if (!next) break;
    at = next;
  }
  return *at;
}

bool Document::charge(std::uint64_t bytes, const std::string& object) {
  if (bytes <= options.limits.memory && memory <= options.limits.memory - bytes) {
    memory += bytes;
    return true;
  }
  report(Code("E6002"), nullptr, object,
         fmt::format("{} bytes more are over the limit of {} bytes of memory", bytes,
                     options.limits.memory));
  return false;
}

NamedFile Document::find_named(const Json& uri, const std::string& object, bool part) {
  NamedFile found = find_file(
      files, {.text = uri.text, .including = {file.path}, .percent_encoded = true, .part = part});
  if (found.outcome != Files::Outcome::found) return found;
  if (!found.deviation.empty()) report(Code("W6215"), &uri, object, found.deviation);
  const auto is_known = [&](const scene::Input& input) { return input.path == found.path; };
  if (std::ranges::none_of(inputs, is_known))
    inputs.push_back({found.path, hash128(as_bytes(*found.bytes)), found.bytes->size()});
  return found;
}

}  // namespace panwright::importers::gltf
