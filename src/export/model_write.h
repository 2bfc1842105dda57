/* Models as the bytes of a file. */
#ifndef GRAY_EXPORT_MODEL_WRITE_H
#define GRAY_EXPORT_MODEL_WRITE_H

#include "base/error.h"
#include "formats/list.h"
#include "formats/model_format.h"
#include "math/colour.h"
#include "math/vec3.h"

/* Numbers of vertices of the part and of a material of the model. */
struct export_triangle {
    uint32_t vertex[3], material;
};
struct csg;
struct export_part {
    const char *name;
    const struct csg *csg;         /* the solid, which lives as long as its world */
    bool closed;                   /* the mesh is */
    struct list points, triangles; /* struct vec3, struct export_triangle */
};
struct export_material {
    char name[64]; /* in files: only letters, digits, '_', '-' and '.' */
    struct colour diffuse;
    uint8_t display[3]; /* the same for a display */
};
/* Names are borrowed. Zero value: empty. Owner: the caller, export_model_destroy. */
struct export_model {
    struct list parts, materials; /* struct export_part, struct export_material */
    double tolerance;
};
void export_model_destroy(struct export_model *model);
static inline struct export_part *export_parts(const struct export_model *model) {
    return model->parts.items;
}

struct model_write_options {
    enum model_format format;
    enum model_unit unit;
    bool text;            /* STL: not binary */
    const char *mtl_name; /* OBJ: the name of the file of the materials */
};

/* `bytes`, and of OBJ `mtl` too: lists of bytes that the caller destroys. Errors: no memory, too many triangles. */
bool model_write(const struct export_model *model, const struct model_write_options *options, struct list *bytes,
                 struct list *mtl, struct error *error);

#endif
