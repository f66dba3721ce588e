// Transfer of pixels from framebuffers into memory. Private to preview.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/job.h"
#include "preview/gl/gl_objects.h"

namespace panwright::preview {

// Format of one pixel in a framebuffer and in memory.
struct PixelFormat {
  GLenum internal = GL_RGBA32F;
  GLenum format = GL_RGBA;
  GLenum type = GL_FLOAT;
  std::size_t bytes = 16;
};

// A ring of framebuffers of one color: while one is read, the next one is drawn. Only take() waits.
//
// With a GPU, pixels are copied into a buffer as soon as they are drawn, and read once a fence has
// passed. A software context copies on the calling thread, after all pending draws: there the fence
// comes first, then the copy.
class ReadBack {
 public:
  static constexpr std::size_t kSlots = 2;

  // through_buffers: true: pixels go through a buffer of the context
  ReadBack(const GladGLContext& gl, const PixelFormat& format, bool through_buffers)
      : gl_(gl), format_(format), through_buffers_(through_buffers) {}
  ~ReadBack() { drop(); }
  ReadBack(const ReadBack&) = delete;
  ReadBack& operator=(const ReadBack&) = delete;

  const PixelFormat& format() const { return format_; }
  bool empty() const { return used_ == 0; }
  bool full() const { return used_ == kSlots; }
  std::size_t oldest() const { return first_; }  // number of a slot. Expects: !empty()
  std::size_t newest() const { return (first_ + used_ - 1) % kSlots; }
  std::size_t next() const { return (first_ + used_) % kSlots; }  // Expects: !full()

  // Target of the next pixels. Expects: !full().
  RenderTarget& target() { return slots_[next()].target; }

  // Takes the next slot for the drawn pixels [0, width) × [0, height) of target(). False: the
  // context has no memory for them.
  bool submit(std::uint32_t width, std::uint32_t height);

  enum class Wait { done, cancelled, failed };
  // Waits for the oldest pixels, calls use with them, rows as in the framebuffer, and frees the
  // slot; on failure it stays. Expects: !empty().
  Wait take(const Job& job, const std::function<void(const void*)>& use);

  // Forgets the newest pixels, or all. current: true if the context is.
  void drop_newest(bool current = true);
  void drop(bool current = true);

 private:
  struct Slot {
    RenderTarget target;
    GlBuffer buffer;
    const void* mapped = nullptr;  // of the buffer, as long as it lives
    std::size_t buffer_bytes = 0;
    GLsync drawn = nullptr;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
  };
  bool ensure_buffer(Slot& slot, std::size_t bytes);
  void forget(Slot& slot, bool current);

  const GladGLContext& gl_;
  const PixelFormat format_;
  const bool through_buffers_;
  std::array<Slot, kSlots> slots_;
  std::size_t first_ = 0;
  std::size_t used_ = 0;
  std::vector<std::byte> memory_;  // of copies that need no buffer
};

// Waits until all pending draws of the context are done, with polls of the job.
ReadBack::Wait wait_until_drawn(const GladGLContext& gl, const Job& job);

}  // namespace panwright::preview
