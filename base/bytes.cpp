#include "base/bytes.h"

namespace panwright {

void ByteWriter::add(std::span<const std::byte> more) {
  bytes_.insert(bytes_.end(), more.begin(), more.end());
}

}  // namespace panwright
