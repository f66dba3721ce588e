#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "server/request_log.h"
#include "server/server.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"

namespace panwright::tools {

namespace command_serve {
namespace {

using Json = nlohmann::ordered_json;
using workspace::SettingId;

// Settings of images that a session does not set by its requests.
constexpr SettingId kSettings[] = {SettingId::camera,       SettingId::look_at,
                                   SettingId::up,           SettingId::quat,
                                   SettingId::camera_frame, SettingId::pose,
                                   SettingId::joint,        SettingId::sun,
                                   SettingId::sun_distance, SettingId::sun_irradiance,
                                   SettingId::lamp,         SettingId::white,
                                   SettingId::planet,       SettingId::sky,
                                   SettingId::stars,        SettingId::star_catalogue,
                                   SettingId::date,         SettingId::orbit,
                                   SettingId::fov,          SettingId::intrinsics,
                                   SettingId::distortion,   SettingId::camera_file,
                                   SettingId::size,         SettingId::exposure,
                                   SettingId::noise_seed,   SettingId::line_time,
                                   SettingId::ev,           SettingId::quality,
                                   SettingId::samples,      SettingId::pixel_error,
                                   SettingId::engine,       SettingId::shadows,
                                   SettingId::levels,       SettingId::imposters,
                                   SettingId::psf};

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  ViewOptions view;
  std::string address = "127.0.0.1";
  std::uint32_t port = server::kDefaultPort;
  std::string format = "ppm";
  bool grey = false;
  bool shared = false;
  std::uint32_t most_clients = 16;
  std::uint64_t most_request = std::uint64_t{16} << 20;
  double most_seconds = 60;
  std::string log;
  std::string replay;
  bool coverage = false;
  std::string gl = "auto";
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.targets,
           "Objects: .pan, .pxn or CAD files, numbered from 0; NAME=FILE names one, 7=FILE numbers "
           "it")
      .type("[NAME=]FILE…");
  const char* const group = "Server";
  arguments.add("--port", options.port, "TCP port (default 10363); 0: a free one, which is printed")
      .range(0u, 65535u)
      .type("N")
      .group(group);
  arguments
      .add(
          "--address", options.address,
          "Address to listen on (default 127.0.0.1: this machine alone); any other warns, as there "
          "is no password")
      .type("ADDRESS")
      .group(group);
  arguments
      .add("--format", options.format,
           "Bytes of images: ppm (default), 8 bits, linear; raw: without header; float: PFM of "
           "radiance")
      .one_of({"ppm", "raw", "float"})
      .type("KIND")
      .group(group);
  arguments.flag("--grey", options.grey, "Send one channel: the mean of the bands").group(group);
  arguments.flag("--shared", options.shared, "Share one world among all clients").group(group);
  arguments.add("--clients", options.most_clients, "Largest number of clients (default 16)")
      .range(1u, 1024u)
      .type("N")
      .group(group);
  arguments.add("--max-request", options.most_request, "Largest request (default 16MB)")
      .bytes()
      .type("BYTES")
      .group(group);
  arguments.add("--request-seconds", options.most_seconds, "Longest time of a request (default 60)")
      .positive()
      .type("S")
      .group(group);
  arguments.add("--log", options.log, "Write each request and the hash of its reply")
      .type("FILE.jsonl")
      .group(group);
  arguments
      .add("--replay", options.replay,
           "Repeat the requests of a log, compare the replies, and end; other options as then")
      .type("FILE.jsonl")
      .group(group);
  arguments
      .flag("--coverage", options.coverage,
            "List the requests of the protocol and what of them has no meaning yet, and end")
      .group(group);
  for (const SettingId id : kSettings) declare(arguments, options.view, id);
  arguments.add("--gl", options.gl, "OpenGL context: auto (default), egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

void list_coverage(bool text, Json& out) {
  constexpr const char* kWords[] = {"full", "part", "none"};
  out["requests"] = Json::array();
  for (const server::RequestKind& kind : server::request_kinds()) {
    const char* const support = kWords[static_cast<std::size_t>(kind.support)];
    out["requests"].push_back({{"number", kind.number},
                               {"name", kind.name},
                               {"version", fmt::format("1.{:02}", kind.minor)},
                               {"support", support},
                               {"note", kind.note}});
    if (text)
      print("{:>3}  {:<31} 1.{:02}  {}{}{}\n", kind.number, kind.name, kind.minor, support,
            kind.note.empty() ? "" : "  ", kind.note);
  }
}

Result<server::ServerOptions> options_of(const Options& options, DiagnosticLog& log) {
  auto read = options.read.opening(log);
  auto typed = options.view.settings(log);
  if (!read || !typed) return failed;
  if (options.targets.empty() && !workspace::shows_sky(*typed)) {
    log.report(Code("E0201"), {},
               "no model is given, expected FILE, as in: panwright serve model.pan");
    return failed;
  }
  server::ServerOptions out;
  out.stage.targets = options.targets;
  out.stage.open = *std::move(read);
  // hidden surfaces cost an image less than their removal
  out.stage.open.prune = false;
  out.stage.defaults = *std::move(typed);
  out.stage.context = *preview::context_kind_from_name(options.gl);
  out.session.images.format = options.format == "raw"     ? server::WireFormat::raw
                              : options.format == "float" ? server::WireFormat::floats
                                                          : server::WireFormat::ppm;
  out.session.images.grey = options.grey;
  out.address = options.address;
  out.port = static_cast<std::uint16_t>(options.port);
  out.shared = options.shared;
  out.most_clients = options.most_clients;
  out.most_request = options.most_request;
  out.most_seconds = options.most_seconds;
  out.log = options.log;
  return out;
}

int replay_log(const Options& options, const server::ServerOptions& server,
               CommandContext& context) {
  DiagnosticLog& log = context.log();
  auto stage = server::Stage::open(server.stage, log, context.job());
  if (!stage) return context.finish();
  const auto done = server::replay(options.replay, **stage, server.session, log, context.job());
  if (!done) return context.finish();
  context.result()["sessions"] = done->sessions;
  context.result()["requests"] = done->requests;
  context.result()["different"] = done->different;
  context.result()["first_different"] = done->first;
  if (!options.common.json) {
    print("{}: {} of {} have the same reply\n", options.replay, done->requests - done->different,
          counted(done->requests, "request"));
    if (done->different > 0) print("the first other one is at {}\n", done->first);
  }
  constexpr int kDifferent = 1;
  return context.finish(done->different > 0 ? kDifferent : 0);
}

int run(const Options& options, const Host& host) {
  CommandContext context("serve", options.common, host);
  DiagnosticLog& log = context.log();
  if (options.coverage) {
    list_coverage(!options.common.json, context.result());
    return context.finish();
  }
  auto server = options_of(options, log);
  if (!server) return context.finish();
  if (!options.replay.empty()) return replay_log(options, *server, context);
  if (!options.log.empty() && !context.files().will_write(options.log, "--log", log))
    return context.finish();
  server->ready = [&](const std::string& address, std::uint16_t port) {
    if (options.common.json)
      print("{}\n", Json{{"address", address}, {"port", port}}.dump());
    else
      print("listening on {}:{}\n", address, port);
    std::fflush(stdout);
    if (!address.starts_with("127.") && address != "::1")
      print(stderr,
            "panwright: warning: any machine that reaches {} can use this server, without a "
            "password\n",
            address);
  };
  (void)server::serve(*server, log, context.job());
  return context.finish();
}

}  // namespace
}  // namespace command_serve

Command serve_command() {
  return command("serve", "Serve images and look-ups to simulators by the PANGU protocol",
                 command_serve::declare_all, command_serve::run);
}

}  // namespace panwright::tools
