// Server of the PANGU protocol over TCP or a Unix socket (docs/server.md).
//
// One thread moves bytes. Another one owns the stage and answers whole requests one after the
// other, so that slow or hostile clients delay no other. A client has one request under way: what
// it sends beyond waits in its socket, and the queue is never longer than the number of clients.
#pragma once

#include <cstdint>
#include <string>

#include "base/diagnostic.h"
#include "base/job.h"
#include "server/listen.h"
#include "server/session.h"
#include "server/stage.h"

namespace panwright::server {

constexpr std::uint16_t kDefaultPort = 10363;

struct ServerOptions {
  StageOptions stage;
  SessionOptions session;
  ListenOptions listen;
  bool shared = false;  // all sessions have one state
  std::string log;      // RequestLog; empty: none
  // One that steers has a session over the world of the client whose image came last; before any,
  // over one of its own.
  PageOptions page;
};

// Serves until the job is cancelled or a client quits it. `GET /metrics` of HTTP on the same port
// answers Metrics::json().
//
//   returns  true: ended as it should
// Fails: as Stage::open(); E0103 for the log; E0201 for an address, a port or a path that is not
// free.
bool serve(const ServerOptions& options, DiagnosticLog& log, const Job& job);

}  // namespace panwright::server
