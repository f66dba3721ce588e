// Settings of the heap, for programs that draw image after image.
#pragma once

namespace panwright {

// Keeps freed memory for later use. Drawing on a CPU takes and frees tens of megabytes a frame,
// which would come back as new pages each time: up to a tenth of its time.
void keep_freed_memory();

// Gives all threads that begin later the heap of the process, not one of their own, which gives
// freed memory back: 10 ms of an image of 60.
void share_heap();

}  // namespace panwright
