#include "base/heap.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace panwright {

void keep_freed_memory() {
#ifdef M_TRIM_THRESHOLD
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  // setting the one above would keep it at its least; older allocators take no more than the first
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_MMAP_THRESHOLD, 128 << 20);
#endif
}

void share_heap() {
#ifdef M_ARENA_MAX
  mallopt(M_ARENA_MAX, 1);
#endif
}

}  // namespace panwright
