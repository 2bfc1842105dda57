/* Grids of numbers from files: NRRD (Teem's "nearly raw raster data": attached header, raw or gzip, little-endian, one
 * number for each of the voxels of three axes) and raw files, whose type and size the caller knows. */
#ifndef GRAY_FORMATS_VOXELS_H
#define GRAY_FORMATS_VOXELS_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Types of numbers, little-endian: the word of a script (gr.medium has them in this order), further words of NRRD,
 * bytes. */
#define VOXEL_TYPES(X)                                                                                                 \
    X(VOXEL_FLOAT, "float", "", 4)                                                                                     \
    X(VOXEL_DOUBLE, "double", "", 8)                                                                                   \
    X(VOXEL_UINT8, "uint8", "uchar|unsigned char|uint8_t", 1)                                                          \
    X(VOXEL_INT16, "int16", "short|short int|signed short|signed short int|int16_t", 2)                                \
    X(VOXEL_UINT16, "uint16", "ushort|unsigned short|unsigned short int|uint16_t", 2)
#define VOXEL_TYPE(type, word, more, bytes) type,
enum voxel_type { VOXEL_TYPES(VOXEL_TYPE) VOXEL_TYPE_COUNT };
#undef VOXEL_TYPE

enum { VOXELS_LIMIT = 4096 }; /* along an axis */

/* All values are finite and at least 0; x varies fastest. */
struct voxels {
    uint32_t count[3];
    const float *values; /* in the arena */
};

/* Reads a file that begins as NRRD does. Errors name the path: not such a file, a field that is not supported, sizes
 * that do not fit the data, a value that is negative or not finite, no memory. */
bool voxels_read_nrrd(const char *path, struct arena *arena, struct voxels *out, struct error *error);
/* Reads a file of nothing but the values; out->count is given. */
bool voxels_read_raw(const char *path, enum voxel_type type, struct arena *arena, struct voxels *out,
                     struct error *error);
/* An NRRD file from memory; `path` is for messages. */
bool voxels_parse_nrrd(const char *path, const uint8_t *data, size_t size, struct arena *arena, struct voxels *out,
                       struct error *error);

#endif
