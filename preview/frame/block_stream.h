// Uniform blocks in one buffer. Private to preview.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <optional>
#include <vector>

#include "preview/gl/gl_objects.h"

namespace panwright::preview {

// Returns the stride of uniform blocks in a buffer, bytes.
inline std::size_t block_stride(const GladGLContext& gl, std::size_t block_bytes) {
  GLint alignment = 1;
  gl.GetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  const auto step = static_cast<std::size_t>(std::max(alignment, 1));
  return (block_bytes + step - 1) / step * step;
}

// Uniform blocks of all receivers of a frame, one behind the other.
template <class Block>
class BlockStream {
 public:
  // Uploads blocks, unless they are those of the last call.
  //
  //   fill  writes a block, zero before: fill(index, block)
  template <class Fill>
  void upload(const GladGLContext& gl, std::size_t count, Fill fill) {
    if (!stream_) {
      stride_ = block_stride(gl, sizeof(Block));
      stream_.emplace(gl);
    }
    next_.assign(count * stride_, std::byte{});
    for (std::size_t i = 0; i < count; ++i) {
      Block block{};
      fill(i, block);
      std::memcpy(next_.data() + i * stride_, &block, sizeof block);
    }
    if (next_ == uploaded_) return;
    first_ = stream_->upload(next_);
    uploaded_.swap(next_);
  }

  // Expects: upload().
  void bind(const GladGLContext& gl, GLuint binding, std::size_t index) const {
    gl.BindBufferRange(GL_UNIFORM_BUFFER, binding, stream_->id(),
                       static_cast<GLintptr>(first_ + index * stride_), sizeof(Block));
  }

 private:
  std::vector<std::byte> uploaded_;
  std::vector<std::byte> next_;
  std::optional<StreamBuffer> stream_;
  std::size_t stride_ = 0;  // bytes
  std::size_t first_ = 0;   // bytes, in stream_
};

}  // namespace panwright::preview
