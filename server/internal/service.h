// Service of one protocol: connections on one thread, answers on another. Private to server.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "base/diagnostic.h"
#include "base/job.h"
#include "server/internal/protocol.h"
#include "server/listen.h"
#include "server/session.h"

namespace panwright::server {

// Runs work on the worker's thread, after what waits there. Called from any thread.
using Post = std::function<void(std::function<void(const Job& job)> work)>;

// Answers of all clients. All calls come from the worker's thread; none throws, but open().
class Answerer {
 public:
  virtual ~Answerer() = default;
  // False: failed, and reported. post: until end(); its work may come after it, and throws nothing.
  virtual bool open(const Post& post) = 0;
  virtual void begin(std::uint64_t client) = 0;
  virtual Reply answer(std::uint64_t client, std::span<const std::uint8_t> request,
                       const Job& job) = 0;
  virtual void leave(std::uint64_t client) = 0;
  // Frees what open() and clients have.
  virtual void end() = 0;
};

// Serves until the job is cancelled or a client quits it.
//
//   returns  true: ended as it should
// Fails: E0201 for an address, a port or a path that is not free; as the answerer.
bool run_service(const ListenOptions& options, const Protocol& protocol, Answerer& answerer,
                 DiagnosticLog& log, const Job& job);

}  // namespace panwright::server
