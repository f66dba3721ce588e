// Session of one client: requests of the PANGU protocol in, replies out (docs/server.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "server/encode.h"
#include "server/messages.h"
#include "server/packing.h"
#include "server/replies.h"
#include "server/stage.h"
#include "server/state.h"

namespace panwright::server {

struct SessionOptions {
  WireImages images;
  std::uint64_t most_reply = std::uint64_t{64} << 20;  // bytes, of look-ups and echoes
  ShownImage shown;                                    // called after each image; empty: no page
  DiagnosticLog* log = nullptr;                        // gets damaged tiles of terrain; null: none
};

struct Reply {
  enum class Then : std::uint8_t { next, close, quit };  // quit: of the server
  Bytes bytes;
  Then then = Then::next;
  std::string note;     // of what was ignored or left out; empty: nothing
  bool silent = false;  // there is no reply, and the session goes on
};

// Session over a state of its own, or one that it shares. A reply depends on the requests to the
// state so far, and on nothing else.
class Session {
 public:
  // Expects: a stage that outlives the session, and is on the thread of answer().
  Session(Stage& stage, std::shared_ptr<State> state, const SessionOptions& options)
      : stage_(stage), state_(std::move(state)), options_(options) {}

  // Answers one request. It never throws; where the job is cancelled, with WireError::time.
  //
  //   request  complete: of request_size()
  Reply answer(std::span<const std::uint8_t> request, const Job& job);

 private:
  Reply answer_kind(Request kind, WireReader& in, const Job& job);
  // nothing: another group of requests
  bool command(Request kind, WireReader& in, std::string& note);
  bool view_command(Request kind, WireReader& in, std::string& note);
  bool lens_command(Request kind, WireReader& in, std::string& note);
  bool light_command(Request kind, WireReader& in, std::string& note);
  bool lamp_command(Request kind, WireReader& in, std::string& note);
  bool object_command(Request kind, WireReader& in, std::string& note);
  bool lidar_command(Request kind, WireReader& in, std::string& note);
  Bytes image_request(Request kind, WireReader& in, const Job& job);
  Bytes object_request(Request kind, WireReader& in);
  Bytes surface_request(Request kind, WireReader& in, const Job& job);
  Bytes point_request(Request kind, WireReader& in, const Job& job);
  Bytes patch(WireReader& in, const Job& job);
  Bytes dem(WireReader& in, const Job& job);
  Bytes pulse(WireReader& in, const Job& job);
  Bytes scan(bool doubles, WireReader& in, const Job& job);
  Bytes snapshot(WireReader& in, const Job& job);
  Bytes radar(WireReader& in, const Job& job);
  Bytes image_of(std::uint32_t camera, const Job& job);
  void draw(const world::Camera& camera, const Lens* lens, bool ranges,
            const std::function<void(Drawing&)>& use, const Job& job);
  Bytes image_at(const world::Camera& camera, const Lens* lens, const Job& job);
  Bytes range_image(double offset, double scale, const Job& job);
  Bytes camera_properties(std::uint32_t camera) const;
  const Lens* lens_of(std::uint32_t camera) const;
  void name_damaged(Reply& reply);
  const State& state() const { return *state_; }

  Stage& stage_;
  std::shared_ptr<State> state_;
  SessionOptions options_;
  DiagnosticLog log_;  // of the request being answered
};

// Error of a request, which answer() makes the reply.
struct RequestError {
  WireError code;
  std::string text;
};

// Throws RequestError for a number of results whose reply is above the limit.
void check_reply(std::uint64_t count, std::uint64_t bytes_each, std::uint64_t most);

}  // namespace panwright::server
