#include "server/internal/connection.h"

#include <fmt/format.h>

#include <algorithm>

#include "server/messages.h"

namespace panwright::server {

namespace {

constexpr double kGreetingSeconds = 5;     // and for the first bytes of a request
constexpr double kBytesPerSecond = 65536;  // slowest client, in both directions
constexpr double kDrainSeconds = 1;
constexpr std::uint32_t kHttpGet = 0x47455420;  // "GET "
constexpr std::size_t kMostHttp = 8192;         // bytes of a request line with its headers

}  // namespace

void Connection::start() {
  asio::error_code ignored;
  socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.set_option(asio::socket_base::keep_alive(true), ignored);
  set_deadline(kGreetingSeconds, false);
  read();
}

void Connection::close() {
  ended_ = true;
  asio::error_code ignored;
  deadline_.cancel();
  if (!socket_.is_open()) return;
  socket_.close(ignored);
  host_.closed(*this);
}

// says_so: with an error reply, else the connection is closed at once.
void Connection::set_deadline(double seconds, bool says_so) {
  deadline_.expires_after(std::chrono::microseconds(static_cast<std::int64_t>(1e6 * seconds)));
  deadline_.async_wait([self = shared_from_this(), says_so](const asio::error_code& error) {
    if (error || !self->socket_.is_open()) return;
    if (says_so && !self->ended_)
      self->refuse(WireError::deadline, "the rest of the request did not come in time");
    else
      self->close();
  });
}

void Connection::read() {
  socket_.async_read_some(asio::buffer(chunk_), [self = shared_from_this()](
                                                    const asio::error_code& error, std::size_t n) {
    if (error) return self->close();
    self->host_.count(n, 0, false);
    if (self->ended_) return;
    self->buffer_.insert(self->buffer_.end(), self->chunk_.begin(),
                         self->chunk_.begin() + static_cast<std::ptrdiff_t>(n));
    self->process();
  });
}

// The version, or a request for metrics.
void Connection::process_greeting() {
  constexpr std::size_t kWord = 4;
  if (buffer_.size() < kWord) {
    read();
    return;
  }
  const std::uint32_t version = word_at(buffer_);
  if (version == kHttpGet) {
    const std::string_view text(reinterpret_cast<const char*>(buffer_.data()), buffer_.size());
    if (text.find("\r\n\r\n") == text.npos && buffer_.size() < kMostHttp) {
      read();
      return;
    }
    const bool known = text.starts_with("GET /metrics ");
    const std::string body = known ? host_.metrics() + "\n" : "expected /metrics\n";
    const std::string answer = fmt::format(
        "HTTP/1.0 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
        known ? "200 OK" : "404 Not Found", known ? "application/json" : "text/plain", body.size(),
        body);
    send(Bytes(answer.begin(), answer.end()), true);
    return;
  }
  if (version >> 8 != 1) {
    refuse(WireError::version,
           fmt::format("version 0x{:x} of the protocol, expected 0x1xx", version));
    return;
  }
  buffer_.erase(buffer_.begin(), buffer_.begin() + kWord);
  greeted_ = true;
  if (!host_.admit(*this)) {
    refuse(WireError::clients, "the server has as many clients as it takes");
    return;
  }
  send(okay(), false);
}

void Connection::process() {
  if (!greeted_) {
    process_greeting();
    return;
  }
  if (buffer_.empty()) {
    // a client may think for as long as it likes
    waits_ = false;
    deadline_.cancel();
    return read();
  }
  const RequestSize size = request_size(buffer_, host_.most_request());
  switch (size.state) {
    case RequestSize::State::unknown:
      return refuse(WireError::request, fmt::format("unknown request {}", word_at(buffer_)));
    case RequestSize::State::too_large:
      return refuse(WireError::size, fmt::format("a request of {} bytes, expected at most {}",
                                                 size.bytes, host_.most_request()));
    case RequestSize::State::incomplete: {
      const auto now = std::chrono::steady_clock::now();
      if (!waits_) begun_ = now;
      waits_ = true;
      // the deadline follows from what has come, not from when it came
      const double allowed =
          kGreetingSeconds + static_cast<double>(buffer_.size()) / kBytesPerSecond;
      const double passed = std::chrono::duration<double>(now - begun_).count();
      set_deadline(std::max(allowed - passed, 0.0), true);
      return read();
    }
    case RequestSize::State::complete:
      break;
  }
  waits_ = false;
  deadline_.cancel();
  const auto end = buffer_.begin() + static_cast<std::ptrdiff_t>(size.bytes);
  Bytes request;
  if (end == buffer_.end()) {
    request.swap(buffer_);
  } else {
    request.assign(buffer_.begin(), end);
    buffer_.erase(buffer_.begin(), end);
  }
  host_.submit(shared_from_this(), std::move(request));
}

void Connection::reply(Reply reply) {
  if (!socket_.is_open()) return;
  if (reply.then == Reply::Then::quit) host_.quit(*this);
  if (reply.bytes.empty()) return drain();
  send(std::move(reply.bytes), reply.then != Reply::Then::next);
}

void Connection::send(Bytes bytes, bool last) {
  const bool error = greeted_ && bytes.size() >= 4 && word_at(bytes) == reply::kError;
  host_.count(0, bytes.size(), error);
  sent_ = std::move(bytes);
  set_deadline(kGreetingSeconds + static_cast<double>(sent_.size()) / kBytesPerSecond, false);
  asio::async_write(socket_, asio::buffer(sent_),
                    [self = shared_from_this(), last](const asio::error_code& failed, std::size_t) {
                      if (failed) return self->close();
                      self->deadline_.cancel();
                      self->sent_ = {};
                      if (last)
                        self->drain();
                      else
                        self->process();
                    });
}

void Connection::refuse(WireError error, std::string_view text) {
  ended_ = true;
  asio::error_code ignored;
  socket_.cancel(ignored);  // the read under way
  send(error_reply(error, text), true);
}

// Ends the connection so that the client reads what was sent: what still comes is dropped.
void Connection::drain() {
  ended_ = true;
  asio::error_code ignored;
  socket_.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  host_.leave(*this);
  set_deadline(kDrainSeconds, false);
  const auto step = [](auto&& again, const std::shared_ptr<Connection>& self) -> void {
    self->socket_.async_read_some(asio::buffer(self->chunk_),
                                  [self, again](const asio::error_code& error, std::size_t) {
                                    if (error)
                                      self->close();
                                    else
                                      again(again, self);
                                  });
  };
  step(step, shared_from_this());
}

}  // namespace panwright::server
