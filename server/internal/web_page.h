// Page for browsers that shows the last image of a server, what it shows, and how long it took.
// Private to server.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/diagnostic.h"
#include "base/result.h"
#include "server/stage.h"

namespace panwright::server {

// It has a thread of its own, which alone turns images into bytes, and only for browsers: those
// that are slow miss images, and delay no client. Browsers can change nothing.
//
// A message of the WebSocket at /live: uint32 bytes of the text, little-endian; the text, JSON;
// then 3·width·height sRGB codes, row 0 the top row.
class WebPage {
 public:
  // Fails: E0201 for an address or a port that is not free.
  static Result<std::unique_ptr<WebPage>> open(const std::string& address, std::uint16_t port,
                                               DiagnosticLog& log);
  ~WebPage();
  WebPage(const WebPage&) = delete;
  WebPage& operator=(const WebPage&) = delete;

  std::uint16_t port() const;
  // Shows an image in place of the one before.
  //
  //   text  JSON of text_of()
  void show(Drawing drawing, std::string text);

 private:
  struct Impl;
  explicit WebPage(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Numbers that a page has of an image.
struct Shown {
  std::uint64_t client = 0;
  std::uint64_t images = 0;              // of all clients so far
  double last = 0, median = 0, p99 = 0;  // seconds to answer
};

std::string text_of(const Shown& shown, const world::Camera& camera, const State& state);

}  // namespace panwright::server
