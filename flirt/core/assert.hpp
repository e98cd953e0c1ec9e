// flirt/core/assert.hpp: FLIRT_ASSERT(condition) stops the program on a bug of the caller or of ours; checked in dev
// and sanitizer builds, free in release.
#pragma once

#ifdef FLIRT_ASSERTIONS
#include <cstdio>
#include <cstdlib>
#define FLIRT_ASSERT(condition)                                                              \
  do {                                                                                       \
    if (!(condition)) {                                                                      \
      std::fprintf(stderr, "%s:%d: assertion failed: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                          \
    }                                                                                        \
  } while (false)
#else
// Named but not evaluated, so that what only an assertion looks at is not unused.
#define FLIRT_ASSERT(condition) static_cast<void>(sizeof(!(condition)))
#endif
