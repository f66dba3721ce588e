// Log of requests, which a replay repeats.
//
// One JSON object a line: {"session":1,"state":1} where a session begins, {"session":1,"name":
// "GetImage","request":"00000001","bytes":49173,"reply":"…"} for each request in the order of
// execution; `reply` is the XXH3 hash of its bytes, 128 bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "server/session.h"
#include "server/stage.h"

namespace panwright::server {

class RequestLog {
 public:
  // Fails: E0103.
  static Result<std::unique_ptr<RequestLog>> create(const std::filesystem::path& path,
                                                    DiagnosticLog& log);
  void begin(std::uint64_t session, std::uint64_t state);
  void add(std::uint64_t session, std::span<const std::uint8_t> request, const Reply& reply);
  bool good() const { return file_.good(); }

 private:
  std::ofstream file_;
};

struct Replayed {
  std::uint64_t sessions = 0;
  std::uint64_t requests = 0;
  std::uint64_t different = 0;  // replies
  std::string first;            // of them: "request 12 (GetImage)"
};

// Repeats a log on a stage.
//
// Fails: E0101, E0102 for a line that is none of a log; E0001.
Result<Replayed> replay(const std::filesystem::path& path, Stage& stage,
                        const SessionOptions& options, DiagnosticLog& log, const Job& job);

}  // namespace panwright::server
