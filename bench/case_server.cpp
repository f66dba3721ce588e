// The server over TCP: processor time of an image beyond that of `render --views -`, and look-ups a
// second, beside the difference of the answers from the image.
#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <future>
#include <thread>

#include "bench/bench.h"
#include "server/server.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_server {

namespace {

using server::Bytes;
using server::WireWriter;

double processor_seconds_of_all() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// A client that asks and waits.
class Wire {
 public:
  explicit Wire(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    good_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
    (void)ask(WireWriter().word(0x114).take(), 4);
  }
  ~Wire() { ::close(socket_); }
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;

  Bytes ask(const Bytes& request, std::size_t reply) {
    good_ = good_ && ::send(socket_, request.data(), request.size(), MSG_NOSIGNAL) ==
                         static_cast<ssize_t>(request.size());
    Bytes out(reply);
    good_ = good_ && ::recv(socket_, out.data(), reply, MSG_WAITALL) == static_cast<ssize_t>(reply);
    return out;
  }
  bool good() const { return good_; }

 private:
  int socket_;
  bool good_ = false;
};

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// Points under the middles of pixels of a row, and their distances in the image.
constexpr std::uint32_t kPoints = 1000;
constexpr std::size_t kPointBytes = 13;

Bytes points_request(std::uint32_t side) {
  WireWriter out;
  out.word(5).word(kPoints);
  for (std::uint32_t i = 0; i < kPoints; ++i)
    out.real((i % side + 0.5) / side).real(0.5 + 0.5 / side);
  return out.take();
}

double range_error(const Bytes& reply, const image::Image& image, const Vec3& camera) {
  double worst = 0;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const std::size_t at = 8 + i * kPointBytes;
    server::WireReader in(std::span<const std::uint8_t>(reply).subspan(at));
    const double x = in.real(), y = in.real();
    const Vec3 point(x, y, in.real());
    const std::size_t row = image.height / 2 - 1;
    const double range = image.range[row * image.width + i % image.width];
    // on an edge one of the two meets another part
    if (!in.flag() || !std::isfinite(range)) continue;
    const double error = std::fabs(glm::length(point - camera) / range - 1);
    if (error < 1e-3) worst = std::max(worst, error);
  }
  return worst;
}

// Against an encoding of its own: half a code of rounding.
double code_error(const Bytes& reply, const image::Image& image) {
  const std::size_t values = 3 * image.pixels();
  double worst = 0;
  for (std::size_t i = 0; i < values; ++i) {
    const double value = std::clamp(kPi * static_cast<double>(image.radiance[i]), 0.0, 1.0) * 255;
    worst = std::max(worst, std::fabs(value - reply[reply.size() - values + i]));
  }
  return worst;
}

void run_server(Context& context) {
  const std::uint32_t side = context.quick() ? 64 : 1024;
  const auto model = context.source("examples/servicer/servicer.pxn");
  if (model.empty()) return context.note("no servicer: the rows are missing");
  DiagnosticLog log;
  server::ServerOptions options;
  options.listen.port = 0;
  options.stage.targets = {model};
  options.stage.open.prune = false;
  workspace::Settings& settings = options.stage.defaults;
  settings.size = workspace::ImageSize{side, side};
  settings.camera = Vec3(9, -9, 8);  // 15 m away
  settings.fov = 40 * kDegree;
  settings.samples = 1u;
  settings.sun = Vec3(1, -0.7, 0.6);
  workspace::View view(settings);
  view.settings.targets = options.stage.targets;
  view.settings.outputs = {(context.scratch() / "view.npy").string()};

  const Job job{JobOptions{}};
  std::promise<std::uint16_t> port;
  options.listen.ready = [&](const std::string&, std::uint16_t bound) { port.set_value(bound); };
  DiagnosticLog server_log;
  std::thread thread([&] {
    if (!server::serve(options, server_log, job)) port.set_value(0);  // before it was ready
  });
  Wire wire(port.get_future().get());
  workspace::ViewSession session(options.stage.open, preview::ContextKind::automatic);
  const std::size_t bytes =
      8 + fmt::format("P6\n{} {}\n255\n", side, side).size() + std::size_t{3} * side * side;
  const Bytes get_image = WireWriter().word(1).take();
  std::vector<double> beyond;
  Bytes image;
  for (int k = -1; k < context.runs(); ++k) {
    const double start = processor_seconds_of_all();
    image = wire.ask(get_image, bytes);
    const double middle = processor_seconds_of_all();
    (void)session.run(std::span(&view, 1), {}, log);
    if (k >= 0) beyond.push_back(1e3 * (2 * middle - start - processor_seconds_of_all()));
  }
  const Bytes points = points_request(side);
  Bytes reply;
  const Timing look_ups = timed([&] { reply = wire.ask(points, 8 + kPoints * kPointBytes); }, 20);
  const bool good = wire.good();
  job.cancel();
  thread.join();
  auto stage = server::Stage::open(options.stage, log, {});
  if (!good || !stage) return context.note("no OpenGL: the rows are missing");
  const auto camera = (*stage)->camera_of((*stage)->initial(), 0);
  const auto drawn = (*stage)->draw((*stage)->initial(), *camera, nullptr, true, log, {});
  if (!drawn) return context.note("no OpenGL: the rows are missing");
  const double codes = code_error(image, drawn->image);
  context.add({.case_name = "server",
               .setting = fmt::format("GetImage {}x{} beyond render --views -, servicer at 15 m",
                                      side, side),
               .speed = median_of(beyond),
               .speed_unit = "ms of processors",
               .error = codes,
               .error_unit = "codes",
               .reference = "radiance of the image",
               .reference_error = 1e-5,
               .runs = context.runs(),
               .must = 5,
               .must_is_least = false,
               .must_error = 0.501});
  Row row{.case_name = "server",
          .setting = fmt::format("LookupPoints, {} points a request", kPoints),
          .speed_unit = "requests/s",
          .error = range_error(reply, drawn->image, camera->position),
          .error_unit = "relative range",
          .reference = "layer of ranges, float",
          .reference_error = 1e-6,
          .must = 100};
  set_rate(row, look_ups, 1);
  context.add(row);
}

const bool kAdded = add_case({"server", "images and look-ups over TCP", run_server});

}  // namespace
}  // namespace panwright::bench::case_server
