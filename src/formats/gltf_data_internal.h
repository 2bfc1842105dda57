/* The numbers of a glTF file: buffers, views and accessors. */
#ifndef GRAY_FORMATS_GLTF_DATA_INTERNAL_H
#define GRAY_FORMATS_GLTF_DATA_INTERNAL_H

#include "formats/gltf_internal.h"

/* An array of elements with a few numbers each. */
struct gltf_accessor {
    const uint8_t *data; /* NULL: zeros */
    size_t stride;
    uint64_t count;
    int components;
    enum number_type type;
    bool normalized;
    uint64_t sparse_count;
    const uint8_t *sparse_indices, *sparse_values;
    enum number_type sparse_type;
};

/* Counts what is made of the file; false beyond a multiple of its bytes. */
bool gltf_produce(struct gltf *g, uint64_t count, const char *where);
bool gltf_view(struct gltf *g, uint32_t index, const uint8_t **data, size_t *size, size_t *stride);
/* Whether the file has the accessor's bytes; an extension that compresses them may leave them out. */
bool gltf_has_bytes(const struct gltf *g, uint32_t index);
bool gltf_accessor(struct gltf *g, uint32_t index, struct gltf_accessor *out);
/* Elements first .. first + count - 1, `components` numbers each. */
bool gltf_accessor_read(struct gltf *g, uint32_t index, const struct gltf_accessor *a, uint64_t first, uint64_t count,
                        double *out);
bool gltf_accessor_read_whole(struct gltf *g, uint32_t index, const struct gltf_accessor *a, uint32_t *out);
/* Decodes percent signs, into the model's arena; NULL: no memory. */
char *gltf_decode_uri(const struct gltf *g, const char *uri);
bool gltf_decode_data(const struct gltf *g, const char *uri, uint8_t **out, size_t *size, const char *where);

#endif
