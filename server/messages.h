// Requests of the PANGU protocol: their layouts (docs/server.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace panwright::server {

enum class Request : std::uint32_t {
#define PANWRIGHT_REQUEST(number, identifier, name, minor, fields, element, support, note) \
  identifier = number,
#include "server/messages.def"
#undef PANWRIGHT_REQUEST
};

enum class Support : std::uint8_t { full, part, none };

struct RequestKind {
  std::uint32_t number = 0;
  std::string_view name;
  unsigned minor = 0;        // of the version 1.minor that has it first
  std::string_view fields;   // as server/messages.def
  std::string_view element;  // empty: no elements
  Support support = Support::full;
  std::string_view note;
};

// All kinds, ascending.
std::span<const RequestKind> request_kinds();
// Null: unknown.
const RequestKind* request_kind(std::uint32_t number);

// Progress of a request of which some bytes have come.
struct RequestSize {
  enum class State : std::uint8_t { incomplete, complete, unknown, too_large };
  State state = State::incomplete;
  std::uint64_t bytes = 0;  // at least; of a complete request all of it
};

// Sizes the first request of a stream of bytes without reading beyond them.
//
//   most  limit of bytes of one request
RequestSize request_size(std::span<const std::uint8_t> bytes, std::uint64_t most);

}  // namespace panwright::server
