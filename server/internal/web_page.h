// Page for browsers that shows the last image of a server, what it shows, and how long it took.
// Private to server.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "server/listen.h"
#include "server/metrics.h"
#include "server/packing.h"
#include "server/stage.h"

namespace panwright::server {

// It has a thread of its own, which alone turns images into bytes, and only for browsers: those
// that are slow miss images, and delay no client.
//
// A message of the WebSocket at /live: uint32 bytes of the text, little-endian; the text, JSON;
// then 3·width·height sRGB codes, row 0 the top row. Where the page steers, a browser sends whole
// requests of the PANGU protocol, a message each: GetViewpointByCamera and those that move the
// session's camera, the Sun and joints. Any other message ends its connection.
class WebPage {
 public:
  // asked: called when requests wait, on the page's thread
  // Fails: E0201 for an address or a port that is not free.
  // Expects: a port.
  static Result<std::unique_ptr<WebPage>> open(const ListenOptions& listen,
                                               const PageOptions& options,
                                               std::function<void()> asked, DiagnosticLog& log);
  ~WebPage();
  WebPage(const WebPage&) = delete;
  WebPage& operator=(const WebPage&) = delete;

  // Returns what shows images of a client in place of the one before. Expects: it is called on one
  // thread, while the page lives.
  ShownImage shown_of(std::uint64_t client);
  // Returns the requests of browsers since the last call.
  std::vector<Bytes> take_requests();

 private:
  struct Impl;
  explicit WebPage(std::unique_ptr<Impl> impl);
  void show(Drawing drawing, std::string text);
  std::unique_ptr<Impl> impl_;
  LatencyHistogram latency_;  // of images
};

}  // namespace panwright::server
