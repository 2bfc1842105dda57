/* Models as the bytes of a file. */
#ifndef GRAY_EXPORT_MODEL_WRITE_H
#define GRAY_EXPORT_MODEL_WRITE_H

#include "base/error.h"
#include "formats/list.h"
#include "formats/model_format.h"
#include "math/colour.h"
#include "math/vec3.h"

/* Numbers of vertices of the part and of a material of the model; the colours of its corners for a display. */
struct export_triangle {
    uint32_t vertex[3], material;
    uint8_t display[3][3];
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
    bool textured;      /* they are the average: each corner has its own colour */
};
/* Names are borrowed. Zero value: empty. Owner: the caller, export_model_destroy. */
struct export_model {
    struct list parts, materials; /* struct export_part, struct export_material */
    double tolerance;
};
/* A name that text files can hold: other bytes than letters, digits, '_', '-' and '.' become '_'. */
const char *export_plain_name(const char *name, char out[64]);
void export_model_destroy(struct export_model *model);
static inline struct export_part *export_parts(const struct export_model *model) {
    return model->parts.items;
}
static inline struct vec3 *export_points(const struct export_part *part) {
    return part->points.items;
}
static inline struct export_triangle *export_triangles(const struct export_part *part) {
    return part->triangles.items;
}
static inline void export_corners(const struct export_part *part, size_t triangle, struct vec3 out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = export_points(part)[export_triangles(part)[triangle].vertex[k]];
}

struct model_write_options {
    enum model_format format;
    enum model_unit unit;
    bool text;            /* STL: not binary */
    const char *mtl_name; /* OBJ: the name of the file of the materials */
};

/* Bytes. Zero value: empty. Owner: the caller, model_files_destroy. */
struct model_files {
    struct list model, mtl; /* mtl: of OBJ */
    struct list directory;  /* 3MF: of its zip; the file lacks its end, and the thumbnail */
};
/* Errors: no memory, too many triangles. */
bool model_write(const struct export_model *model, const struct model_write_options *options, struct model_files *files,
                 struct error *error);
/* Ends a 3MF file, with the bytes of a PNG file. */
bool model_add_thumbnail(struct model_files *files, const struct list *png, struct error *error);
/* Triangles with a colour for each vertex, as a display shows it: a GLB file, or else PLY. False: no memory. */
struct coloured_mesh {
    const struct vec3 *points;
    const uint8_t (*colours)[3]; /* by point */
    const uint32_t (*triangles)[3];
    size_t point_count, triangle_count;
};
bool coloured_mesh_write(const struct coloured_mesh *mesh, enum model_format format, struct list *out);
void model_files_destroy(struct model_files *files);

#endif
