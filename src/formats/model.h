/* What a mesh file holds: meshes with a material slot per face, materials, and a tree of nodes that place the meshes.
 * The reader is chosen by content, then by the extension: glTF and GLB, PLY, STL, else OBJ; each of them may be
 * compressed with gzip. A model is an asset like the meshes it owns: immutable once read, without anything of a script
 * in it. */
#ifndef GRAY_FORMATS_MODEL_H
#define GRAY_FORMATS_MODEL_H

#include "base/arena.h"
#include "base/error.h"
#include "base/path_policy.h"
#include "formats/list.h"
#include "image/image.h"
#include "material/openpbr.h"
#include "math/affine.h"
#include "mesh/mesh.h"

#define MODEL_NONE UINT32_MAX

/* A picture that a material names. */
struct model_texture {
    const char *name;           /* as the file has it; NULL: none */
    const char *path;           /* where it was found; NULL: embedded or missing */
    struct image *image;        /* embedded ones, owned by the model */
    double scale[2], offset[2]; /* place on the picture = scale * uv + offset, v counted from below */
    double strength;            /* of bumps and normals */
    double cutoff;              /* of opacities: > 0: all or nothing */
    bool by_alpha;              /* alpha says it, not the colour */
    bool without_alpha;         /* what alpha says is nothing */
    enum image_wrap wrap_u, wrap_v;
    enum image_filter filter;
};

/* As Wavefront's MTL has it, or, where `layered` is set, with the layers of OpenPBR: those of glTF. */
struct model_material {
    const char *name;
    struct vec3 ka, kd, ks, ke, filter; /* filter: Tf, the colour of what passes through */
    double shininess, dissolve, ior, reflect;
    /* Of layers kd is the colour of the base, ks that of the specular layer, dissolve the opacity; map_metal multiplies
     * roughness by its green and metalness by its blue. */
    bool layered;
    struct openpbr layers;
    double roughness, transmission;
    struct vec3 absorption;
    bool has_shininess, has_ior, two_sided, unlit;
    bool by_vertex; /* kd is multiplied by the colours of the vertices */
    int illum;
    struct model_texture map_kd, map_ks, map_ke, map_d, map_bump, map_normal, map_metal;
};

/* Tables while the file is read; a finished mesh afterwards. */
struct model_mesh {
    const char *name;
    struct list vertices, normals, uvs, colours;      /* double[3], double[3], double[2], float[3] by vertex */
    struct list starts;                               /* uint32_t: faces, and once finished the end */
    struct list vertex_index, normal_index, uv_index; /* uint32_t per corner; MODEL_NONE: this corner has none */
    struct list face_slot;                            /* uint32_t per face, or empty */
    bool normals_by_vertex, uvs_by_vertex;            /* their index lists are vertex_index */
    struct list slots;                                /* uint32_t: the material of a slot, or MODEL_NONE */
    struct list slot_names;                           /* const char *, as many, or none */
    struct mesh *mesh;
};

struct model_node {
    const char *name;
    uint32_t parent; /* an earlier node, or MODEL_NONE */
    uint32_t mesh;   /* or MODEL_NONE */
    struct transform parent_from_node;
};

/* The zero value: as the file has it. */
struct model_options {
    bool smooth;                           /* normals of our own instead of the file's */
    double smooth_angle;                   /* degrees: faces that meet at less are one smooth surface; 0: flat */
    bool weld, flip;                       /* one vertex for each place; faces reversed */
    const struct path_policy *path_policy; /* where files may be read; NULL: everywhere */
    bool single_file;                      /* no other file is opened (tests of readers with strangers' bytes) */
    size_t max;                            /* vertices, and corners, of a mesh; 0: as many as an index can name */
};

enum { MODEL_WARNINGS = 16 };

/* Owner: the caller, or the store it was given to; model_destroy. Zero value: nothing. */
struct model {
    struct arena arena; /* names */
    const char *path;
    struct model_options options;
    struct list materials, meshes, nodes; /* struct model_material, model_mesh, model_node */
    const char *warnings[MODEL_WARNINGS];
    int warning_count;
};

/* How many vertices, and how many corners, a mesh may have: some numbers of 32 bits are kept for other meanings. */
static inline size_t model_max(const struct model *model) {
    return model->options.max ? model->options.max : MODEL_NONE - 8;
}

/* Reads the file; meshes are made with the options. Errors are one line: FILE:LINE: what, or FILE: byte N: what. */
bool model_read(struct model *model, const char *path, const struct model_options *options, struct error *error);
/* The same from memory; `path` is for messages, for the extension, and for the folder of other files. */
bool model_parse(struct model *model, const char *path, const uint8_t *data, size_t size,
                 const struct model_options *options, struct error *error);
void model_destroy(struct model *model);

static inline struct model_material *model_materials(const struct model *model) {
    return model->materials.items;
}
static inline struct model_mesh *model_meshes(const struct model *model) {
    return model->meshes.items;
}
static inline struct model_node *model_nodes(const struct model *model) {
    return model->nodes.items;
}

/* --- for the readers --- */

/* All answer NULL or false without memory, having told so. */
struct model_mesh *model_add_mesh(struct model *model, struct error *error);
struct model_material *model_add_material(struct model *model, struct error *error); /* plain gray, nothing else */
struct model_node *model_add_node(struct model *model, struct error *error);         /* at the top, no mesh */
/* The last warnings are forgotten, not the first. */
void model_warn(struct model *model, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A file that the model names: beside it, by whatever spelling of the path; the folder alone as a last resort. */
bool model_find(struct model *model, const char *name, size_t length, const char **path, struct error *error);

/* Meshes from the tables, and the one node of files that have no nodes. */
bool model_finish(struct model *model, struct error *error);

bool ply_load(struct model *model, const uint8_t *data, size_t size, struct error *error);
bool stl_load(struct model *model, const uint8_t *data, size_t size, bool binary, struct error *error);
bool gltf_load(struct model *model, const uint8_t *data, size_t size, struct error *error);
/* The text of --version about its JSON parser: "jansson 2.14" or "none". */
const char *gltf_library(void);
bool obj_load(struct model *model, const char *text, size_t size, struct error *error);
/* A library of materials; `line` of the model names it. */
bool mtl_load(struct model *model, const char *path, const char *text, size_t size, struct error *error);

/* gzip (RFC 1952) in memory; what comes out is from mem.h. Refused when it grows more than 64 times beyond 16 MB. */
bool gunzip(const char *path, const uint8_t *data, size_t size, uint8_t **out, size_t *out_size, struct error *error);

#endif
