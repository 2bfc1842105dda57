#include "device/cuda_calls.h"

#include <dlfcn.h>
#include <string.h>

bool cuda_calls_load(struct cuda_calls *calls, struct error *error) {
    static const char *const names[] = {
#define CUDA_CALL_NAME(member, name, arguments) name,
        CUDA_CALLS(CUDA_CALL_NAME)
#undef CUDA_CALL_NAME
    };
    void *found[sizeof names / sizeof *names];
    void *library = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library)
        return error_set(error, ERROR_MACHINE, "there is no driver for a card: %s", dlerror());
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        found[i] = dlsym(library, names[i]);
        if (!found[i])
            return error_set(error, ERROR_MACHINE, "the driver of the card is too old: libcuda.so.1 has no %s",
                             names[i]);
    }
    _Static_assert(sizeof found == sizeof *calls, "a member for each name");
    memcpy(calls, found, sizeof found);
    return true;
}
