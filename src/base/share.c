/* Sharing through memfd: a file without a name in memory. Its pages are allocated when it is created (fallocate), since
 * a missing page would later kill the process that touches it. */
#define _GNU_SOURCE
#include "base/share.h"

#include "base/fault.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static bool no_memory(struct error *error, size_t size, const char *why) {
    return error_set(error, ERROR_MACHINE, "out of memory: the picture or model needs %.1f MB: %s", 1e-6 * (double)size,
                     why);
}

/* A size above the machine's memory would not fail in time: the kernel hands out pages until it has to kill a
 * process. */
static bool fits_machine(size_t size) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages <= 0 || page <= 0 || size / (size_t)page < (size_t)pages;
}

static bool map_block(struct share *share, struct error *error) {
    void *block = fault_now(FAULT_OF_CALL)
                      ? MAP_FAILED
                      : mmap(NULL, share->size, PROT_READ | PROT_WRITE, MAP_SHARED, share->descriptor, 0);
    if (block == MAP_FAILED) {
        no_memory(error, share->size, strerror(errno));
        (void)close(share->descriptor);
        *share = (struct share){0};
        return false;
    }
    /* Shared only through the descriptor, not with processes forked later. */
    (void)madvise(block, share->size, MADV_DONTFORK);
    share->block = block;
    return true;
}

/* seals: beside those of the size. */
static int create(size_t size, int seals, struct error *error) {
    if (!fits_machine(size)) {
        (void)no_memory(error, size, "this machine has less in all");
        return -1;
    }
    int descriptor = MAY_FAIL(memfd_create("gray-film", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (descriptor < 0) {
        (void)error_set(error, ERROR_MACHINE, "the memory of the picture cannot be shared: %s", strerror(errno));
        return -1;
    }
    int failed;
    do {
        failed = MAY_FAIL(fallocate(descriptor, 0, 0, (off_t)size));
    } while (failed != 0 && errno == EINTR);
    if (failed == 0 && fcntl(descriptor, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | seals) == 0)
        return descriptor;
    (void)no_memory(error, size, strerror(errno));
    (void)close(descriptor);
    return -1;
}

bool share_create(struct share *share, size_t size, struct error *error) {
    *share = (struct share){.size = size ? size : 1};
    share->descriptor = create(share->size, F_SEAL_SEAL, error);
    return share->descriptor >= 0 && map_block(share, error);
}

int share_create_open(size_t size, struct error *error) {
    return create(size, 0, error);
}

bool share_freeze(int descriptor) {
    return fcntl(descriptor, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_SEAL) == 0;
}

void *share_map_copy(int descriptor, size_t *size, struct error *error) {
    struct stat status;
    bool known = fstat(descriptor, &status) == 0 && status.st_size > 0;
    void *block =
        known ? mmap(NULL, (size_t)status.st_size, PROT_READ | PROT_WRITE, MAP_PRIVATE, descriptor, 0) : MAP_FAILED;
    int why = errno;
    (void)close(descriptor);
    if (block == MAP_FAILED) {
        (void)error_set(error, ERROR_MACHINE, "the memory of a scene cannot be reached: %s", strerror(why));
        return NULL;
    }
    *size = (size_t)status.st_size;
    return block;
}

bool share_attach(struct share *share, int descriptor, size_t size, struct error *error) {
    struct stat status;
    *share = (struct share){0};
    if (fstat(descriptor, &status) != 0 || status.st_size < 1 || (uint64_t)status.st_size < size) {
        (void)close(descriptor);
        return error_set(error, ERROR_MACHINE, "the shared picture has the wrong size");
    }
    *share = (struct share){.size = size ? size : (size_t)status.st_size, .descriptor = descriptor};
    return map_block(share, error);
}

void share_destroy(struct share *share) {
    if (!share->block)
        return;
    (void)munmap(share->block, share->size);
    (void)close(share->descriptor);
    *share = (struct share){0};
}
