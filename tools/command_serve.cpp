#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "server/lines.h"
#include "server/request_log.h"
#include "server/server.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "tools/view_lines.h"

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
                                   SettingId::psf,          SettingId::max_image_memory};

constexpr std::uint32_t kNoPage = ~0u;

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
  bool json_lines = false;
  std::uint32_t web = kNoPage;
  bool web_control = false;
  std::string path;
  std::string folder;
  std::uint32_t most_clients = 16;
  std::uint64_t most_request = std::uint64_t{16} << 20;
  double most_seconds = 60;
  std::string log;
  std::string replay;
  bool coverage = false;
  std::string gl = "auto";
};

void declare_page(Arguments& arguments, Options& options, const char* group) {
  arguments
      .add("--web", options.web,
           "Show the last image and its state on a page for browsers, on this port; 0: a free one")
      .range(0u, 65535u)
      .type("PORT")
      .group(group);
  arguments
      .flag("--web-control", options.web_control,
            "Let whoever opens that page move the camera, the Sun and joints of the world it shows")
      .group(group);
}

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
      .add("--socket", options.path,
           "Listen on a Unix socket of this name, which this user alone can open, in place of TCP")
      .type("PATH")
      .group(group);
  arguments
      .flag("--json-lines", options.json_lines,
            "Speak JSON Lines in place of the PANGU protocol: each line is a view, and is answered "
            "as by render --views -")
      .group(group);
  arguments
      .add("--folder", options.folder,
           "With --json-lines: folder of outputs that views name (default: they can name none)")
      .type("DIR")
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
  declare_page(arguments, options, group);
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
  out.shared = options.shared;
  out.log = options.log;
  if (options.web != kNoPage) out.page.port = static_cast<std::uint16_t>(options.web);
  out.page.steers = options.web_control;
  out.page.ready = [&options](const std::string& address, std::uint16_t port) {
    const bool is_six = address.find(':') != address.npos;
    const std::string page =
        fmt::format("http://{}{}{}:{}/", is_six ? "[" : "", address, is_six ? "]" : "", port);
    if (options.common.json)
      print("{}\n", Json{{"page", page}}.dump());
    else
      print("page on {}\n", page);
    std::fflush(stdout);
  };
  return out;
}

// Options that have no meaning beside others.
bool check_combinations(const Options& options, DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  const auto refuse = [&](bool given, const char* name) {
    if (given)
      log.report(Code("E0201"), {},
                 fmt::format("{} {} --json-lines", name,
                             options.json_lines ? "cannot be combined with" : "requires"));
  };
  if (options.json_lines) {
    refuse(options.format != "ppm", "--format");
    refuse(options.grey, "--grey");
    refuse(options.shared, "--shared");
    refuse(options.web_control, "--web-control");
    refuse(!options.log.empty(), "--log");
    refuse(!options.replay.empty(), "--replay");
  } else {
    refuse(!options.folder.empty(), "--folder");
  }
  const auto clash = [&](bool given, const char* name, const char* other) {
    if (given)
      log.report(Code("E0201"), {}, fmt::format("{} cannot be combined with {}", name, other));
  };
  const Options defaults;
  clash(!options.path.empty() && options.address != defaults.address, "--address", "--socket");
  clash(!options.path.empty() && options.port != defaults.port, "--port", "--socket");
  if (options.web_control && options.web == kNoPage)
    log.report(Code("E0201"), {}, "--web-control requires --web");
  clash(!options.replay.empty() && options.web != kNoPage, "--web", "--replay");
  std::error_code ignored;
  if (!options.folder.empty() && !std::filesystem::is_directory(options.folder, ignored))
    log.report_file(Code("E0101"), options.folder, "folder not found", "create it");
  return log.errors() == errors;
}

server::ListenOptions listen_of(const Options& options) {
  server::ListenOptions out;
  out.address = options.address;
  out.port = static_cast<std::uint16_t>(options.port);
  out.path = options.path;
  out.most_clients = options.most_clients;
  out.most_request = options.most_request;
  out.most_seconds = options.most_seconds;
  out.ready = [&options](const std::string& where, std::uint16_t port) {
    const bool is_path = !options.path.empty();
    if (options.common.json)
      print("{}\n", is_path ? Json{{"socket", where}}.dump()
                            : Json{{"address", where}, {"port", port}}.dump());
    else
      print("listening on {}\n", is_path ? where : fmt::format("{}:{}", where, port));
    std::fflush(stdout);
    if (!is_path && !where.starts_with("127.") && where != "::1")
      print(stderr,
            "panwright: warning: any machine that reaches {} can use this server, without a "
            "password\n",
            where);
  };
  return out;
}

// A client of JSON Lines.
class Lines final : public server::LineSession {
 public:
  Lines(workspace::ViewSession& session, const ViewLineOptions& options, const DiagnosticLog& log)
      : views_(session, options, log) {}
  std::string answer(std::string_view line, const Job& job) override {
    return views_.answer(line, job);
  }

 private:
  ViewLines views_;
};

void serve_lines(const Options& options, const server::ServerOptions& from,
                 CommandContext& context) {
  DiagnosticLog& log = context.log();
  ViewLineOptions views;
  views.defaults = from.stage.defaults;
  if (!options.targets.empty()) views.defaults.targets = options.targets;
  if (!from.stage.open.parameters.empty()) views.defaults.define = from.stage.open.parameters;
  views.foreign = true;
  views.folder = options.folder;
  std::optional<workspace::ViewSession> session;
  server::LineServerOptions server;
  server.listen = listen_of(options);
  server.page = from.page;
  server.listen.most_request =
      std::min<std::uint64_t>(options.most_request, workspace::kMaxViewLine);
  server.open = [&] {
    server::SharedImages::remove_left_over();
    session.emplace(from.stage.open, from.stage.context);
    return session->world(views.defaults, {}, log, context.job()) != nullptr;
  };
  server.begin = [&](server::ShownImage shown) {
    ViewLineOptions own = views;
    own.shown = std::move(shown);
    return std::make_unique<Lines>(*session, own, log);
  };
  server.end = [&] { session.reset(); };
  server.refusal = [](std::string_view why) {
    return Json{{"ok", false},
                {"errors", 1},
                {"diagnostics", {{{"code", "E0203"}, {"severity", "error"}, {"message", why}}}}}
        .dump();
  };
  (void)server::serve_lines(server, log, context.job());
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
  if (!server || !check_combinations(options, log)) return context.finish();
  if (!options.replay.empty()) return replay_log(options, *server, context);
  if (!options.log.empty() && !context.files().will_write(options.log, "--log", log))
    return context.finish();
  server->listen = listen_of(options);
  if (options.json_lines)
    serve_lines(options, *server, context);
  else
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
