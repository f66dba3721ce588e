// Connection of one client. Private to server.
#pragma once

#include <array>
#include <asio.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "server/packing.h"
#include "server/replies.h"
#include "server/session.h"

namespace panwright::server {

class Connection;

// Shared side of all connections; all calls come from the thread of the sockets.
class Host {
 public:
  virtual ~Host() = default;
  // A client has sent its version. False: there are too many.
  virtual bool admit(Connection& connection) = 0;
  // Answers a whole request by Connection::reply().
  virtual void submit(std::shared_ptr<Connection> connection, Bytes request) = 0;
  // A client's session has ended.
  virtual void leave(Connection& connection) = 0;
  virtual void closed(Connection& connection) = 0;
  virtual void quit(Connection& connection) = 0;
  virtual std::string metrics() = 0;
  virtual void count(std::size_t bytes_in, std::size_t bytes_out, bool error) = 0;
  virtual std::uint64_t most_request() const = 0;
};

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(asio::ip::tcp::socket socket, Host& host, std::uint64_t number)
      : socket_(std::move(socket)),
        deadline_(socket_.get_executor()),
        host_(host),
        number_(number) {}

  void start();
  // The answer to the request under way.
  void reply(Reply reply);
  void close();
  std::uint64_t number() const { return number_; }

 private:
  void read();
  void process();
  void process_greeting();
  void send(Bytes bytes, bool last);
  void refuse(WireError error, std::string_view text);
  void drain();
  void set_deadline(double seconds, bool says_so);

  asio::ip::tcp::socket socket_;
  asio::steady_timer deadline_;
  Host& host_;
  const std::uint64_t number_;
  std::array<std::uint8_t, 1 << 16> chunk_;
  Bytes buffer_;                                 // received, not yet answered
  Bytes sent_;                                   // under way
  std::chrono::steady_clock::time_point begun_;  // of the request that is incomplete
  bool waits_ = false;                           // for the rest of one
  bool greeted_ = false;
  bool ended_ = false;  // nothing more is read as a request
};

}  // namespace panwright::server
