// Detection of a sanitizer, which takes much of the address space and of the time: gcc and clang
// define different macros.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PANWRIGHT_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PANWRIGHT_SANITIZED
#endif
#endif
