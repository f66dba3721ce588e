// Server of the PANGU protocol over TCP (docs/server.md).
//
// One thread moves bytes. Another one owns the stage and answers whole requests one after the
// other, so that slow or hostile clients delay no other. A client has one request under way: what
// it sends beyond waits in its socket, and the queue is never longer than the number of clients.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "base/diagnostic.h"
#include "base/job.h"
#include "server/session.h"
#include "server/stage.h"

namespace panwright::server {

constexpr std::uint16_t kDefaultPort = 10363;

struct ServerOptions {
  StageOptions stage;
  SessionOptions session;
  std::string address = "127.0.0.1";
  std::uint16_t port = kDefaultPort;  // 0: any
  bool shared = false;                // all sessions have one state
  std::size_t most_clients = 16;
  std::uint64_t most_request = std::uint64_t{16} << 20;  // bytes of one request
  double most_seconds = 60;                              // of one request
  std::string log;                                       // RequestLog; empty: none
  // Called once, when clients can connect.
  std::function<void(const std::string& address, std::uint16_t port)> ready;
};

// Serves until the job is cancelled or a client quits it. `GET /metrics` of HTTP on the same port
// answers Metrics::json().
//
//   returns  true: ended as it should
// Fails: as Stage::open(); E0103 for the log; E0201 for an address or a port that is not free.
bool serve(const ServerOptions& options, DiagnosticLog& log, const Job& job);

}  // namespace panwright::server
