/* What gray calls of the CUDA driver API (version 10.2 or newer; NVIDIA, "CUDA Driver API", reference manual), by the
 * names that libcuda.so.1 exports. */
#ifndef GRAY_DEVICE_CUDA_CALLS_H
#define GRAY_DEVICE_CUDA_CALLS_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* X(member, exported name, types of the arguments). All return 0 or an error. */
#define CUDA_CALLS(X)                                                                                                  \
    X(init, "cuInit", (unsigned flags))                                                                                \
    X(version, "cuDriverGetVersion", (int *version))                                                                   \
    X(device, "cuDeviceGet", (int *device, int number))                                                                \
    X(device_name, "cuDeviceGetName", (char *name, int size, int device))                                              \
    X(attribute, "cuDeviceGetAttribute", (int *value, int attribute, int device))                                      \
    X(context_create, "cuCtxCreate_v2", (void **context, unsigned flags, int device))                                  \
    X(context_destroy, "cuCtxDestroy_v2", (void *context))                                                             \
    X(context_use, "cuCtxSetCurrent", (void *context))                                                                 \
    X(context_limit, "cuCtxSetLimit", (int limit, size_t value))                                                       \
    X(memory, "cuMemGetInfo_v2", (size_t * idle, size_t * all))                                                        \
    X(take, "cuMemAlloc_v2", (uint64_t * address, size_t size))                                                        \
    X(upload, "cuMemcpyHtoDAsync_v2", (uint64_t to, const void *from, size_t size, void *stream))                      \
    X(download, "cuMemcpyDtoHAsync_v2", (void *to, uint64_t from, size_t size, void *stream))                          \
    X(module_load, "cuModuleLoadData", (void **module, const void *image))                                             \
    X(module_function, "cuModuleGetFunction", (void **function, void *module, const char *name))                       \
    X(stream_create, "cuStreamCreate", (void **stream, unsigned flags))                                                \
    X(stream_wait, "cuStreamSynchronize", (void *stream))                                                              \
    X(launch, "cuLaunchKernel",                                                                                        \
      (void *function, unsigned blocks_x, unsigned blocks_y, unsigned blocks_z, unsigned threads_x,                    \
       unsigned threads_y, unsigned threads_z, unsigned shared, void *stream, void **arguments, void **extra))         \
    X(error_text, "cuGetErrorString", (int error, const char **text))

struct cuda_calls {
#define CUDA_CALL_MEMBER(member, name, arguments) int(*member) arguments;
    CUDA_CALLS(CUDA_CALL_MEMBER)
#undef CUDA_CALL_MEMBER
};

enum { CUDA_PROCESSORS = 16, CUDA_MAJOR = 75, CUDA_MINOR = 76 }; /* attributes of a card */
enum { CUDA_STACK = 0 };                                         /* limit: bytes of a thread */

/* Loads libcuda.so.1; it stays loaded. Errors: no library, or an older one. */
bool cuda_calls_load(struct cuda_calls *calls, struct error *error);

#endif
