// The server over TCP and with shared memory: processor time of an image beyond that of `render
// --views -`, and look-ups a second, beside the difference of the answers from the image.
#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <span>
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
double code_error(const Bytes& reply, std::span<const float> radiance) {
  const std::size_t values = radiance.size();
  double worst = 0;
  for (std::size_t i = 0; i < values; ++i) {
    const double value = std::clamp(kPi * static_cast<double>(radiance[i]), 0.0, 1.0) * 255;
    worst = std::max(worst, std::fabs(value - reply[reply.size() - values + i]));
  }
  return worst;
}

std::size_t image_bytes(std::uint32_t side) {
  return 8 + fmt::format("P6\n{} {}\n255\n", side, side).size() + std::size_t{3} * side * side;
}

void run_look_ups(Context& context) {
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

  const Job job{JobOptions{}};
  std::promise<std::uint16_t> port;
  options.listen.ready = [&](const std::string&, std::uint16_t bound) { port.set_value(bound); };
  DiagnosticLog server_log;
  std::thread thread([&] {
    if (!server::serve(options, server_log, job)) port.set_value(0);  // before it was ready
  });
  Wire wire(port.get_future().get());
  const Bytes points = points_request(side);
  Bytes reply;
  const Timing look_ups = timed([&] { reply = wire.ask(points, 8 + kPoints * kPointBytes); }, 20);
  const bool good = wire.good();
  job.cancel();
  thread.join();
  auto stage = server::Stage::open(options.stage, log, {});
  if (!good || !stage) return context.note("no OpenGL: the rows are missing");
  const auto camera = (*stage)->camera_of((*stage)->initial(), 0);
  image::Image drawn;
  const auto keep = [&](server::Drawing& drawing) { drawn = std::move(drawing.image); };
  if (!(*stage)->draw((*stage)->initial(), *camera, nullptr, true, keep, log, {}))
    return context.note("no OpenGL: the rows are missing");
  Row row{.case_name = "server",
          .setting = fmt::format("LookupPoints, {} points a request", kPoints),
          .speed_unit = "requests/s",
          .error = range_error(reply, drawn, camera->position),
          .error_unit = "relative range",
          .reference = "layer of ranges, float",
          .reference_error = 1e-6,
          .must = 100};
  set_rate(row, look_ups, 1);
  context.add(row);
}

// A program of ours, its standard input and output in our hands.
class Process {
 public:
  Process(const std::filesystem::path& program, std::vector<std::string> words) {
    std::array<int, 2> in{}, out{};
    if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) return;
    words.insert(words.begin(), program.string());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, in[0], 0);
    ::posix_spawn_file_actions_adddup2(&actions, out[1], 1);
    good_ =
        ::posix_spawn(&pid_, words[0].c_str(), &actions, nullptr, pointers.data(), environ) == 0;
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(in[0]);
    ::close(out[1]);
    to_ = in[1];
    from_ = out[0];
  }
  ~Process() {
    ::close(to_);
    if (good_) {
      ::kill(pid_, SIGTERM);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(from_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  int to() const { return to_; }
  int from() const { return from_; }
  double processor_seconds() const {
    clockid_t clock{};
    timespec time{};
    if (!good_ || ::clock_getcpuclockid(pid_, &clock) != 0) return 0;
    (void)::clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

 private:
  pid_t pid_ = 0;
  int to_ = -1, from_ = -1;
  bool good_ = false;
};

// A line out, or empty for none, and a line back; empty: there is none.
std::string line_of(int to, int from, std::string line) {
  if (!line.empty()) line += '\n';
  if (::write(to, line.data(), line.size()) != static_cast<ssize_t>(line.size())) return {};
  std::string out;
  std::array<char, 4096> some;
  while (out.empty() || out.back() != '\n') {
    const ssize_t count = ::read(from, some.data(), some.size());
    if (count <= 0) return {};
    out.append(some.data(), static_cast<std::size_t>(count));
  }
  return out;
}

// What follows a key of an answer, up to a quote or a comma.
std::string member_of(const std::string& answer, const std::string& key) {
  const std::size_t at = answer.find("\"" + key + "\":");
  if (at == answer.npos) return {};
  const std::size_t begin = answer.find_first_not_of("\": ", at + key.size() + 2);
  return answer.substr(begin, answer.find_first_of("\",}]", begin) - begin);
}

// Images that a server shares, by name: mapped once.
class Mapped {
 public:
  ~Mapped() {
    if (memory_ != nullptr) ::munmap(memory_, bytes_);
  }
  // Null: it is not there.
  const char* at(const std::string& name, std::size_t offset) {
    if (name != name_) {
      if (memory_ != nullptr) ::munmap(memory_, bytes_);
      memory_ = nullptr;
      name_ = name;
      const int file = ::shm_open(name.c_str(), O_RDONLY, 0);
      struct stat info {};
      if (file < 0 || ::fstat(file, &info) != 0) return nullptr;
      bytes_ = static_cast<std::size_t>(info.st_size);
      void* const mapped = ::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, file, 0);
      ::close(file);
      if (mapped == MAP_FAILED) return nullptr;
      memory_ = mapped;
    }
    return memory_ == nullptr ? nullptr : static_cast<const char*>(memory_) + offset;
  }

 private:
  std::string name_;
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
};

int connected(const std::string& path) {
  const int out = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  path.copy(to.sun_path, sizeof to.sun_path - 1);
  (void)::connect(out, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  return out;
}

// Processor time of answers beyond that of files in memory, in turn, in ms.
class Comparison {
 public:
  // Null: one of the two is not there.
  Comparison(Context& context, std::vector<std::string> server)
      : side_(context.quick() ? 64 : 1024), runs_(2 * context.runs()) {
    const auto program = context.program("panwright");
    const auto model = context.source("examples/servicer/servicer.pxn");
    if (program.empty() || model.empty() || ::mkdtemp(folder_.data()) == nullptr) return;
    const auto words = [&](std::vector<std::string> first) {
      first.insert(first.end(),
                   {model.string(), "--size", fmt::format("{0}x{0}", side_), "--fov", "40",
                    "--samples", "1", "--sun", "1 -0.7 0.6", "--camera", "9 -9 8"});
      return first;
    };
    views_ = std::make_unique<Process>(program, words({"render", "--views", "-"}));
    server.insert(server.begin(), "serve");
    if (server.back() == "--socket") server.push_back(wire());
    server_ = std::make_unique<Process>(program, words(server));
    greeting_ = line_of(server_->to(), server_->from(), {});
  }
  ~Comparison() {
    views_.reset();
    server_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;

  std::uint32_t side() const { return side_; }
  std::string wire() const { return folder_ + "/wire"; }
  const std::string& greeting() const { return greeting_; }  // of the server; empty: there is none

  // Asks for each image first as a file, then of the server.
  //
  //   ask    false: no answer
  //   check  of the floats of the file
  // Returns one value a run; none: an answer was missing.
  std::vector<double> run(const std::function<bool()>& ask,
                          const std::function<void(std::span<const float>)>& check) {
    std::vector<double> beyond;
    const std::string file = folder_ + "/frame.npy", view = "{\"output\":\"" + file + "\"}";
    std::vector<float> radiance(std::size_t{3} * side_ * side_);
    for (int k = -2; k < runs_; ++k) {
      const double before_view = views_->processor_seconds();
      if (member_of(line_of(views_->to(), views_->from(), view), "ok") != "true") return {};
      const double before = server_->processor_seconds(), own = processor_seconds_of_all();
      const double by_file = views_->processor_seconds() - before_view;
      if (!ask()) return {};
      const double by_server =
          server_->processor_seconds() - before + processor_seconds_of_all() - own;
      if (k >= 0) beyond.push_back(1e3 * (by_server - by_file));
      std::ifstream in(file, std::ios::binary);
      const auto size = static_cast<std::streamoff>(radiance.size() * sizeof(float));
      in.seekg(-size, std::ios::end);
      if (!in.read(reinterpret_cast<char*>(radiance.data()), size)) return {};
      check(radiance);
    }
    return beyond;
  }

 private:
  std::uint32_t side_;
  int runs_;
  std::string folder_ = "/dev/shm/pw-bench-XXXXXX";
  std::unique_ptr<Process> views_, server_;
  std::string greeting_;
};

void add_row(Context& context, const Comparison& comparison, const char* what,
             std::vector<double> beyond, Row row) {
  if (beyond.empty()) return context.note(std::string(what) + ": no OpenGL, the row is missing");
  row.case_name = "server";
  row.setting = fmt::format("{} {}x{} beyond render --views - to /dev/shm, servicer at 15 m", what,
                            comparison.side(), comparison.side());
  row.runs = static_cast<int>(beyond.size());
  row.speed = median_of(std::move(beyond));
  row.speed_unit = "ms of processors";
  row.must_is_least = false;
  context.add(row);
}

void run_wire(Context& context) {
  Comparison comparison(context, {"--port", "0"});
  const std::size_t colon = comparison.greeting().rfind(':');
  const int port =
      colon == std::string::npos ? 0 : std::atoi(comparison.greeting().c_str() + colon + 1);
  Wire wire(static_cast<std::uint16_t>(port));
  double codes = 0;
  Bytes image;
  const auto ask = [&] {
    image = wire.ask(WireWriter().word(1).take(), image_bytes(comparison.side()));
    return wire.good();
  };
  const auto check = [&](std::span<const float> radiance) {
    codes = std::max(codes, code_error(image, radiance));
  };
  auto beyond = comparison.run(ask, check);
  add_row(context, comparison, "GetImage", std::move(beyond),
          {.error = codes,
           .error_unit = "codes",
           .reference = "radiance of the file",
           .reference_error = 1e-5,
           .must = 5,
           .must_error = 0.501});
}

void run_shared(Context& context) {
  Comparison comparison(context, {"--json-lines", "--socket"});
  const int socket = connected(comparison.wire());
  Mapped mapped;
  const char* pixels = nullptr;
  double different = 0;
  const auto ask = [&] {
    const std::string answer = line_of(socket, socket, "{\"image\":\"shared\"}");
    const std::string offset = member_of(answer, "offset");
    // its own name, not that of the view
    const std::size_t shared = answer.find("\"shared\":");
    if (offset.empty() || shared == answer.npos) return false;
    pixels = mapped.at(member_of(answer.substr(shared), "name"), std::stoull(offset));
    return pixels != nullptr;
  };
  const auto check = [&](std::span<const float> radiance) {
    if (std::memcmp(radiance.data(), pixels, radiance.size_bytes()) != 0) ++different;
  };
  auto beyond = comparison.run(ask, check);
  ::close(socket);
  add_row(context, comparison, "shared memory", std::move(beyond),
          {.error = different,
           .error_unit = "images that differ",
           .reference = "bytes of the files",
           .must = 1,
           .must_error = 0.5});
}

void run(Context& context) {
  run_wire(context);
  run_look_ups(context);
  run_shared(context);
}

const bool kAdded = add_case({"server", "images and look-ups over TCP and by shared memory", run});

}  // namespace
}  // namespace panwright::bench::case_server
