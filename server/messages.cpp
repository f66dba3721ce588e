#include "server/messages.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "server/packing.h"

namespace panwright::server {

namespace {

constexpr RequestKind kKinds[] = {
#define PANWRIGHT_REQUEST(number, identifier, name, minor, fields, element, support, note) \
  {number, name, minor, fields, element, Support::support, note},
#include "server/messages.def"
#undef PANWRIGHT_REQUEST
};

struct FieldSizes {
  std::size_t bytes = 0;
  std::size_t count_at = 0;  // place of the word n; beyond bytes: none
};

FieldSizes sizes_of(std::string_view fields) {
  FieldSizes out;
  bool counted = false;
  for (std::size_t i = 0; i < fields.size();) {
    const char field = fields[i++];
    std::size_t repeat = 0;
    while (i < fields.size() && fields[i] >= '0' && fields[i] <= '9')
      repeat = 10 * repeat + static_cast<std::size_t>(fields[i++] - '0');
    if (field == 'n') {
      counted = true;
      out.count_at = out.bytes;
    }
    const std::size_t size = field == 'b' ? 1 : field == 'd' ? 8 : 4;
    out.bytes += size * (repeat == 0 ? 1 : repeat);
  }
  if (!counted) out.count_at = out.bytes + 1;
  return out;
}

}  // namespace

std::span<const RequestKind> request_kinds() { return kKinds; }

const RequestKind* request_kind(std::uint32_t number) {
  const auto* const found = std::ranges::lower_bound(kKinds, number, {}, &RequestKind::number);
  return found == std::end(kKinds) || found->number != number ? nullptr : found;
}

RequestSize request_size(std::span<const std::uint8_t> bytes, std::uint64_t most) {
  using Progress = RequestSize::State;
  constexpr std::size_t kWord = 4;
  if (bytes.size() < kWord) return {Progress::incomplete, kWord};
  const RequestKind* const kind = request_kind(word_at(bytes));
  if (kind == nullptr) return {Progress::unknown, kWord};
  const FieldSizes fields = sizes_of(kind->fields);
  std::uint64_t size = kWord + fields.bytes;
  if (!kind->element.empty()) {
    const std::size_t end = kWord + fields.count_at + kWord;
    if (bytes.size() < end) return {Progress::incomplete, end};
    size += std::uint64_t{word_at(bytes.subspan(end - kWord))} * sizes_of(kind->element).bytes;
  }
  if (size > most) return {Progress::too_large, size};
  return {bytes.size() < size ? Progress::incomplete : Progress::complete, size};
}

}  // namespace panwright::server
