// Framing of a protocol: what the bytes of a connection mean. Private to server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "server/packing.h"

namespace panwright::server {

// Next step of a connection.
struct Step {
  enum class Kind : std::uint8_t {
    more,     // the bytes are no whole request yet
    greeted,  // a greeting, after which the client is admitted
    request,
    refused,  // the reply is sent, and the connection ends
  };
  Kind kind = Kind::more;
  std::size_t bytes = 0;  // of the greeting or the request, at the front
  Bytes reply;            // to a greeting, or of a refusal
};

// Framing of one protocol. All members are const and thread-safe.
class Protocol {
 public:
  virtual ~Protocol() = default;
  // True: the client begins with a greeting, which has a deadline. False: it is admitted at once.
  virtual bool greets() const = 0;
  // Expects: at least one byte.
  virtual Step next(std::span<const std::uint8_t> received, bool admitted) const = 0;
  // Reply to one client too many.
  virtual Bytes crowded() const = 0;
  // Reply where the rest of a request did not come in time.
  virtual Bytes late() const = 0;
  virtual bool is_error(std::span<const std::uint8_t> reply) const = 0;
  // Name of a request in metrics.
  virtual std::string name_of(std::span<const std::uint8_t> request) const = 0;
};

}  // namespace panwright::server
