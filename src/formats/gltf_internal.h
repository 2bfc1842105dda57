/* Declarations that only the files of the glTF reader use. */
#ifndef GRAY_FORMATS_GLTF_INTERNAL_H
#define GRAY_FORMATS_GLTF_INTERNAL_H

#include "base/file.h"
#include "formats/model.h"
#include "formats/scan_internal.h"

#include <jansson.h>

/* A buffer is read at its first use. */
struct gltf_buffer {
    const uint8_t *data;
    size_t size;
    bool fetched;
    uint8_t *decoded;       /* ours, from a data URI */
    struct file_bytes file; /* owned: from a file in the model's folder */
};

struct gltf {
    struct model *model;
    const char *path;
    struct error *error;
    json_t *root;
    const uint8_t *binary; /* the second chunk of a GLB, or NULL */
    size_t binary_size;
    struct gltf_buffer *buffers;
    size_t buffer_count;
    struct image **images; /* embedded buffers, once decoded */
    size_t image_count;
    uint64_t bytes;    /* of the file and of everything it refers to */
    uint64_t produced; /* vertices and corners so far */
    struct list lacks; /* struct gltf_lack */
    uint32_t variant;  /* of the materials, or MODEL_NONE */
    uint32_t *plain;   /* the meshes of the model as the file has them, or MODEL_NONE */
};

/* What the reader leaves out: one warning for each kind. */
struct gltf_lack {
    const char *what;
    char first[96], last[96]; /* elements */
    size_t count;
};

/* Sets the error "FILE: WHERE: what" and returns false. */
bool gltf_fail(const struct gltf *g, const char *where, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* An element of the file is left out, for this reason. */
void gltf_lacks(struct gltf *g, const char *where, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Sets the error that the file has no `kind` ("animation") of that name or number, and which of `list` it has. */
bool gltf_choice_fails(const struct gltf *g, const char *kind, const json_t *list, const char *wanted);
/* The name of an object in the model's arena, or "". NULL with an error: no memory. */
const char *gltf_name(const struct gltf *g, const json_t *object);
/* The array of that name at the root, or NULL. */
json_t *gltf_array(const struct gltf *g, const char *name);
/* An integer >= 0; `otherwise` if it is absent. False: the value is something else. */
bool gltf_whole(const struct gltf *g, const json_t *object, const char *key, uint64_t otherwise, uint64_t *out,
                const char *where);
/* The same as an index into the root array `of`; MODEL_NONE if it is absent. */
bool gltf_index(const struct gltf *g, const json_t *object, const char *key, const char *of, uint32_t *out,
                const char *where);
/* The numbers of an array, all of them or none; `out` does not change if there is no array. */
bool gltf_numbers(const struct gltf *g, const json_t *object, const char *key, double *out, int count,
                  const char *where);

#endif
