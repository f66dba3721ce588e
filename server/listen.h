// Place and limits of a server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace panwright::server {

struct ListenOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any
  std::string path;        // of a Unix socket, for this user alone, in place of TCP; empty: none
  std::size_t most_clients = 16;
  std::uint64_t most_request = std::uint64_t{16} << 20;  // bytes of one request
  double most_seconds = 60;                              // of one request
  // Called once, when clients can connect: with the address and the port, or the path and 0.
  std::function<void(const std::string& where, std::uint16_t port)> ready;
};

// Page for browsers that shows the last image. It is on the address of ListenOptions, and on
// 127.0.0.1 beside a Unix socket.
struct PageOptions {
  std::optional<std::uint16_t> port;  // 0: any; none: no page
  bool steers = false;                // it may move camera, Sun and joints
  // Called once, before ListenOptions::ready.
  std::function<void(const std::string& address, std::uint16_t port)> ready;
};

}  // namespace panwright::server
