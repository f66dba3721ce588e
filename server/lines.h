// Server of text lines over TCP or a Unix socket: each line of a client is answered by one line.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/job.h"
#include "server/listen.h"
#include "server/stage.h"

namespace panwright::server {

// Answers of one client, each called on one thread, one after the other.
class LineSession {
 public:
  virtual ~LineSession() = default;
  // Answers a line, both without their ends; an empty answer is not sent. May throw nothing.
  //
  //   job  cancelled when its time is over
  virtual std::string answer(std::string_view line, const Job& job) = 0;
};

struct LineServerOptions {
  ListenOptions listen;  // most_request: bytes of a line
  PageOptions page;      // Expects: it does not steer
  // Opens what sessions share. False: failed, and reported.
  std::function<bool()> open;
  // shown: called after each image; empty: there is no page
  std::function<std::unique_ptr<LineSession>(ShownImage shown)> begin;
  // Frees what open() made.
  std::function<void()> end;
  // Answer to a client that is refused, by its reason.
  std::function<std::string(std::string_view)> refusal;
};

// Serves until the job is cancelled. open(), begin() and end() are called on the thread of the
// answers. Clients have the limits of server.h; one whose line is too long, or late, is refused.
//
//   returns  true: ended as it should
// Fails: E0201 for an address, a port or a path that is not free; as open().
bool serve_lines(const LineServerOptions& options, DiagnosticLog& log, const Job& job);

}  // namespace panwright::server
