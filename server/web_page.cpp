#include "server/internal/web_page.h"

#include <fmt/format.h>
#include <libwebsockets.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <thread>

#include "image/png.h"
#include "server/internal/page.h"
#include "server/messages.h"

namespace panwright::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostViewers = 8;
constexpr std::size_t kPiece = 64 * 1024;  // bytes of a message that are handed over at once
constexpr unsigned kSeconds = 10;          // for a browser to ask, and to take a piece
constexpr int kMostSockets = 64;
constexpr std::size_t kMostBytes = 256;  // of a request of a browser
constexpr std::size_t kMostWaiting = 64;

struct Image {
  Drawing drawing;
  std::string text;
};

using Message = std::vector<std::uint8_t>;  // behind LWS_PRE bytes

std::shared_ptr<const Message> message_of(const Image& image) {
  const double stops = image.drawing.white > 0 ? -std::log2(image.drawing.white) : 0;
  const auto codes = image::png_codes(image.drawing.image, image::PngExposure(stops));
  auto out = std::make_shared<Message>(LWS_PRE);
  const auto length = static_cast<std::uint32_t>(image.text.size());
  out->reserve(LWS_PRE + 4 + length + codes.size());
  for (int k = 0; k < 4; ++k) out->push_back(static_cast<std::uint8_t>(length >> (8 * k)));
  out->insert(out->end(), image.text.begin(), image.text.end());
  out->insert(out->end(), codes.begin(), codes.end());
  return out;
}

std::string header_text(lws* wsi, lws_token_indexes token) {
  std::array<char, 256> text{};
  const int length = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), token);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
}

// Pages of other servers may not read the images, not even under a name that leads here.
bool is_own_page(const std::string& origin, const std::string& host) {
  if (origin.empty()) return true;  // no browser
  const bool has_address =
      host.starts_with("localhost:") || host.find_first_not_of("0123456789abcdef.:[]") == host.npos;
  return has_address && origin == "http://" + host;
}

// Whole, and of a kind that a page may ask.
bool is_allowed(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < sizeof(std::uint32_t)) return false;
  switch (static_cast<Request>(word_at(bytes))) {
    case Request::get_viewpoint_by_camera:
    case Request::set_viewpoint_by_quaternion_d:
    case Request::set_sun_by_degrees:
    case Request::set_joint_config: {
      const RequestSize size = request_size(bytes, kMostBytes);
      return size.state == RequestSize::State::complete && size.bytes == bytes.size();
    }
    default:
      return false;
  }
}

}  // namespace

struct WebPage::Impl {
  // Browser; lws keeps the memory.
  struct Viewer {
    std::shared_ptr<const Message> message;  // under way
    std::size_t sent = 0;                    // bytes of it
    std::uint64_t seen = 0;                  // number of the image
    bool open = true;                        // in memory of zeros: refused, and no viewer yet
  };

  const std::string page = page_text();
  lws_context* context = nullptr;
  lws_vhost* host = nullptr;
  std::thread thread;
  std::atomic<bool> ended{false};
  std::size_t viewers = 0;
  std::function<void()> asked;

  std::mutex mutex;
  std::vector<Bytes> requests;
  std::shared_ptr<const Image> image;
  std::uint64_t number = 0;
  // of the thread: the image as bytes
  std::shared_ptr<const Message> message;
  std::uint64_t encoded = 0;

  int http(lws* wsi, lws_callback_reasons reason, const char* path);
  int live(lws* wsi, lws_callback_reasons reason, Viewer* viewer,
           std::span<const std::uint8_t> received);
  bool take_request(lws* wsi, std::span<const std::uint8_t> bytes);
  int answer_page(lws* wsi);
  int send(lws* wsi, Viewer& viewer);
  void take_newest();
};

namespace {

template <class Impl>
Impl& impl_of(lws* wsi) {
  return *static_cast<Impl*>(lws_context_user(lws_get_context(wsi)));
}

}  // namespace

// Headers now, the text when the socket takes it.
int WebPage::Impl::answer_page(lws* wsi) {
  std::array<unsigned char, LWS_PRE + 1024> room{};
  unsigned char *const start = room.data() + LWS_PRE, *at = start, *const end = &room.back();
  const auto add = [&](const char* name, std::string_view value) {
    return lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name),
                                       reinterpret_cast<const unsigned char*>(value.data()),
                                       static_cast<int>(value.size()), &at, end) != 0;
  };
  if (lws_add_http_common_headers(wsi, HTTP_STATUS_OK, "text/html; charset=utf-8", page.size(), &at,
                                  end) != 0 ||
      add("content-security-policy:",
          "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
          "connect-src 'self' ws:; frame-ancestors 'none'") ||
      add("cache-control:", "no-store") ||
      lws_finalize_write_http_header(wsi, start, &at, end) != 0)
    return 1;
  lws_callback_on_writable(wsi);
  return 0;
}

int WebPage::Impl::http(lws* wsi, lws_callback_reasons reason, const char* path) {
  if (reason == LWS_CALLBACK_HTTP) {
    if (std::string_view(path) == "/") return answer_page(wsi);
    if (lws_return_http_status(wsi, HTTP_STATUS_NOT_FOUND, nullptr) != 0) return -1;
    return lws_http_transaction_completed(wsi);
  }
  std::vector<unsigned char> bytes(LWS_PRE);
  bytes.insert(bytes.end(), page.begin(), page.end());
  const int written = lws_write(wsi, bytes.data() + LWS_PRE, page.size(), LWS_WRITE_HTTP_FINAL);
  if (written < static_cast<int>(page.size())) return -1;
  return lws_http_transaction_completed(wsi);
}

void WebPage::Impl::take_newest() {
  std::shared_ptr<const Image> newest;
  std::uint64_t now = 0;
  {
    const std::lock_guard lock(mutex);
    newest = image;
    now = number;
  }
  if (newest == nullptr || now == encoded) return;
  message = message_of(*newest);
  encoded = now;
}

// A piece of the message under way, or of the newest one.
int WebPage::Impl::send(lws* wsi, Viewer& viewer) {
  if (viewer.message == nullptr) {
    take_newest();
    if (message == nullptr || viewer.seen == encoded) return 0;
    viewer.message = message;
    viewer.seen = encoded;
    viewer.sent = 0;
  }
  const std::size_t size = viewer.message->size() - LWS_PRE;
  const std::size_t count = std::min(kPiece, size - viewer.sent);
  const bool first = viewer.sent == 0, last = viewer.sent + count == size;
  // lws writes its header into the bytes before
  std::vector<std::uint8_t> piece(LWS_PRE + count);
  std::copy_n(viewer.message->begin() + static_cast<std::ptrdiff_t>(LWS_PRE + viewer.sent), count,
              piece.begin() + LWS_PRE);
  const int flags = lws_write_ws_flags(LWS_WRITE_BINARY, first ? 1 : 0, last ? 1 : 0);
  if (lws_write(wsi, piece.data() + LWS_PRE, count, static_cast<lws_write_protocol>(flags)) <
      static_cast<int>(count))
    return -1;
  viewer.sent += count;
  if (last) viewer.message = nullptr;
  // a browser has no image to wait for in between
  lws_set_timeout(wsi, last ? NO_PENDING_TIMEOUT : PENDING_TIMEOUT_HTTP_CONTENT,
                  last ? 0 : kSeconds);
  lws_callback_on_writable(wsi);
  return 0;
}

// False: the browser may not say that, or says too much at once.
bool WebPage::Impl::take_request(lws* wsi, std::span<const std::uint8_t> bytes) {
  const bool whole = lws_is_first_fragment(wsi) != 0 && lws_is_final_fragment(wsi) != 0 &&
                     lws_remaining_packet_payload(wsi) == 0 && lws_frame_is_binary(wsi) != 0;
  if (!asked || !whole || !is_allowed(bytes)) return false;
  {
    const std::lock_guard lock(mutex);
    if (requests.size() >= kMostWaiting) return false;
    requests.emplace_back(bytes.begin(), bytes.end());
  }
  asked();
  return true;
}

int WebPage::Impl::live(lws* wsi, lws_callback_reasons reason, Viewer* viewer,
                        std::span<const std::uint8_t> received) {
  switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return viewers < kMostViewers && is_own_page(header_text(wsi, WSI_TOKEN_ORIGIN),
                                                   header_text(wsi, WSI_TOKEN_HOST))
                 ? 0
                 : 1;
    case LWS_CALLBACK_ESTABLISHED:
      new (viewer) Viewer;
      ++viewers;
      lws_callback_on_writable(wsi);
      return 0;
    case LWS_CALLBACK_CLOSED:
      if (viewer == nullptr || !viewer->open) return 0;
      viewer->~Viewer();
      --viewers;
      return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return send(wsi, *viewer);
    case LWS_CALLBACK_RECEIVE:
      return take_request(wsi, received) ? 0 : -1;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      lws_callback_on_writable_all_protocol(context, lws_get_protocol(wsi));
      return 0;
    default:
      return 0;
  }
}

Result<std::unique_ptr<WebPage>> WebPage::open(const ListenOptions& listen,
                                               const PageOptions& options,
                                               std::function<void()> asked, DiagnosticLog& log) {
  const auto live = [](lws* wsi, lws_callback_reasons reason, void* user, void* in,
                       std::size_t length) {
    return impl_of<Impl>(wsi).live(wsi, reason, static_cast<Impl::Viewer*>(user),
                                   {static_cast<const std::uint8_t*>(in), length});
  };
  // a browser takes the first of its list that is here: the page sees by it whether it may steer
  static const lws_protocols kProtocols[] = {
      {"http",
       [](lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t length) {
         if (reason == LWS_CALLBACK_HTTP || reason == LWS_CALLBACK_HTTP_WRITEABLE)
           return impl_of<Impl>(wsi).http(wsi, reason, static_cast<const char*>(in));
         return lws_callback_http_dummy(wsi, reason, user, in, length);
       },
       0, 0, 0, nullptr, 0},
      {"panwright", live, sizeof(Impl::Viewer), kMostBytes, 0, nullptr, 0},
      {nullptr, nullptr, 0, 0, 0, nullptr, 0}};
  static const lws_protocols kSteering[] = {
      kProtocols[0],
      kProtocols[1],
      {"panwright-steer", live, sizeof(Impl::Viewer), kMostBytes, 0, nullptr, 0},
      kProtocols[2]};
  const std::string address = listen.path.empty() ? listen.address : "127.0.0.1";
  auto impl = std::make_unique<Impl>();
  if (options.steers) impl->asked = std::move(asked);
  lws_set_log_level(0, nullptr);
  lws_context_creation_info info{};
  info.port = *options.port;
  info.iface = address.c_str();
  info.protocols = options.steers ? kSteering : kProtocols;
  info.user = impl.get();
  info.gid = static_cast<gid_t>(-1);
  info.uid = static_cast<uid_t>(-1);
  info.timeout_secs = kSeconds;
  info.keepalive_timeout = kSeconds;
  info.fd_limit_per_thread = kMostSockets;
  info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  // lws makes the process ignore it, and needs it not
  struct sigaction before {};
  sigaction(SIGPIPE, nullptr, &before);
  impl->context = lws_create_context(&info);
  sigaction(SIGPIPE, &before, nullptr);
  if (impl->context != nullptr) impl->host = lws_create_vhost(impl->context, &info);
  if (impl->host == nullptr) {
    if (impl->context != nullptr) lws_context_destroy(impl->context);
    log.report(Code("E0201"), {},
               fmt::format("cannot show a page on {}:{}; expected an address of this machine and "
                           "a free port",
                           address, *options.port),
               "--web 0 takes a free port");
    return failed;
  }
  if (options.ready)
    options.ready(address, static_cast<std::uint16_t>(lws_get_vhost_listen_port(impl->host)));
  impl->thread = std::thread([raw = impl.get()] {
    while (!raw->ended && lws_service(raw->context, 0) >= 0) {
    }
  });
  return std::unique_ptr<WebPage>(new WebPage(std::move(impl)));
}

WebPage::WebPage(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

WebPage::~WebPage() {
  impl_->ended = true;
  lws_cancel_service(impl_->context);
  impl_->thread.join();
  lws_context_destroy(impl_->context);
}

std::vector<Bytes> WebPage::take_requests() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->requests, {});
}

void WebPage::show(Drawing drawing, std::string text) {
  auto image = std::make_shared<const Image>(Image{std::move(drawing), std::move(text)});
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->image.swap(image);
    ++impl_->number;
  }
  lws_cancel_service(impl_->context);
}

namespace {

Json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }
Json quaternion_json(const Quat& q) { return {q.w, q.x, q.y, q.z}; }

Json joints_json(const world::Instance& object) {
  Json out = Json::array();
  const auto values = object.joint_values();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto& joint = object.model()->joints()[k];
    if (static_cast<geometry::JointKind>(joint.kind) == geometry::JointKind::fixed) continue;
    Json numbers = Json::array();
    for (std::size_t i = 0; i < geometry::value_count(static_cast<geometry::JointKind>(joint.kind));
         ++i)
      numbers.push_back(values[k][i]);
    out.push_back({{"name", object.model()->joint_name(k)}, {"index", k}, {"values", numbers}});
  }
  return out;
}

// The number of an object on the wire; null: another one has it as a name.
Json number_of(const world::World& world, std::size_t index) {
  const std::string& name = world[index].name();
  const bool is_number =
      !name.empty() && name.size() < 10 && name.find_first_not_of("0123456789") == name.npos;
  if (is_number && std::to_string(std::stoul(name)) == name) return std::stoul(name);
  return world.find(std::to_string(index)) ? Json() : Json(index);
}

Json objects_json(const world::World& world) {
  Json out = Json::array();
  for (std::size_t i = 0; i < world.size(); ++i) {
    const world::Instance& object = world[i];
    out.push_back({{"name", object.name()},
                   {"number", number_of(world, i)},
                   {"visible", object.visible()},
                   {"position", vector_json(object.pose().translation)},
                   {"quat", quaternion_json(object.pose().rotation)},
                   {"joints", joints_json(object)}});
  }
  return out;
}

Json camera_json(const world::Camera& camera) {
  Json out = {{"position", vector_json(camera.position)},
              {"quat", quaternion_json(camera.world_from_camera)}};
  const Vec2 half = 0.5 * Vec2(camera.width, camera.height) / camera.focal;
  if (camera.projection == world::Projection::orthographic)
    out["ortho_m"] = {2 * half.x, 2 * half.y};
  else
    out["fov_deg"] = {2 * std::atan(half.x) / kDegree, 2 * std::atan(half.y) / kDegree};
  return out;
}

}  // namespace

ShownImage WebPage::shown_of(std::uint64_t client) {
  return [this, client](Drawing&& drawing, const world::Camera& camera, const world::World& world,
                        double time, double seconds) {
    latency_.add(seconds);
    const world::Sun& sun = world.sun();
    const Json out = {{"client", client},
                      {"images", latency_.count()},
                      {"width", camera.width},
                      {"height", camera.height},
                      {"time", time},
                      {"camera", camera_json(camera)},
                      {"sun",
                       {{"direction", vector_json(glm::normalize(sun.direction))},
                        {"distance_au", sun.distance}}},
                      {"objects", objects_json(world)},
                      {"answer_ms",
                       {{"last", 1e3 * seconds},
                        {"median, at most", 1e3 * latency_.quantile(0.5)},
                        {"99 %, at most", 1e3 * latency_.quantile(0.99)}}}};
    show(std::move(drawing), out.dump(-1, ' ', false, Json::error_handler_t::replace));
  };
}

}  // namespace panwright::server
