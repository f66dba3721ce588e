// Codes of replies of the PANGU protocol, and its errors.
#pragma once

#include <cstdint>
#include <string_view>

#include "server/packing.h"

namespace panwright::server {

namespace reply {
constexpr std::uint32_t kOkay = 0;
constexpr std::uint32_t kError = 1;
constexpr std::uint32_t kImage = 2;
constexpr std::uint32_t kFloat = 3;
constexpr std::uint32_t kFloatArray = 4;
constexpr std::uint32_t kPoint = 5;
constexpr std::uint32_t kPointArray = 6;
constexpr std::uint32_t kEcho = 8;
constexpr std::uint32_t kLidarPulse = 9;
constexpr std::uint32_t kLidarMeasurement = 10;
constexpr std::uint32_t kRadar = 11;
constexpr std::uint32_t kDouble = 12;
constexpr std::uint32_t kDoubleArray = 13;
constexpr std::uint32_t kJointList = 14;
constexpr std::uint32_t kFrameList = 15;
constexpr std::uint32_t kCameraProperties = 16;
constexpr std::uint32_t kRawImage = 17;
}  // namespace reply

// Codes of error replies. The session goes on after the first group, and ends after the second.
enum class WireError : std::int32_t {
  number = 1,     // a number that is not finite, or outside its bounds
  drawing = 2,    // the image cannot be drawn
  time = 3,       // the work takes longer than the limit
  version = 16,   // another protocol than 1.x
  request = 17,   // an unknown request
  size = 18,      // a request or a reply above the limit
  clients = 19,   // too many clients
  deadline = 20,  // the rest of a request did not come in time
};
constexpr bool ends_session(WireError error) { return error >= WireError::version; }

Bytes okay();
// The text is cut at 1,000 bytes.
Bytes error_reply(WireError error, std::string_view text);

}  // namespace panwright::server
