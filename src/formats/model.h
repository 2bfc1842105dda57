/* The contents of a mesh file: meshes with a material slot per face, materials, and a tree of nodes that position
 * the meshes. The contents of the file, then its extension select the reader: glTF and GLB, PLY, STL, otherwise OBJ;
 * each of them may be compressed with gzip. A model is an asset like the meshes that it owns: immutable after
 * reading, and independent of scripts. */
#ifndef GRAY_FORMATS_MODEL_H
#define GRAY_FORMATS_MODEL_H

#include "base/arena.h"
#include "base/error.h"
#include "base/file.h"
#include "base/path_policy.h"
#include "formats/list.h"
#include "image/image.h"
#include "material/openpbr.h"
#include "math/affine.h"
#include "mesh/mesh.h"

#define MODEL_NONE UINT32_MAX

/* A picture that a material names. */
struct model_texture {
    const char *name;                     /* as written in the file; NULL: none */
    const char *path;                     /* the path of the file found; NULL: embedded or missing */
    struct image *image;                  /* the bytes of an embedded picture, owned by the model */
    double scale[2], cross[2], offset[2]; /* position = scale * uv + cross * vu + offset; v starts at the lower edge */
    bool second;                          /* by the second texture coordinates */
    double strength;                      /* of bumps and normals */
    double cutoff;                        /* for opacities: values above 0 are all or nothing */
    bool by_alpha;                        /* the alpha channel contains it, not the colour */
    bool without_alpha;                   /* the alpha channel is ignored */
    enum image_wrap wrap_u, wrap_v;
    enum image_filter filter;
};

/* A picture that multiplies an input of the layers. */
struct model_layer_map {
    struct model_texture map;
    enum material_input input;
    char channel;       /* 'r', 'g', 'a', or 'c': the colour */
    double factor, low; /* the input where the channel is 1 and 0 */
};
enum { MODEL_LAYER_MAPS = 10 };

/* As in Wavefront's MTL; materials of glTF set `layered` and have the layers of OpenPBR. */
struct model_material {
    const char *name;
    struct colour ka, kd, ks, ke, filter; /* filter: Tf, the colour of transmitted light */
    double shininess, dissolve, ior, reflect;
    /* Of layered materials, kd is the colour of the base, ks that of the specular layer, dissolve the opacity; the
     * green channel of map_metal multiplies roughness, its blue channel metalness. */
    bool layered;
    struct openpbr layers;
    double roughness, transmission;
    double dispersion; /* 1 / Abbe's number */
    struct colour absorption;
    bool has_shininess, has_ior, two_sided, unlit;
    bool by_vertex;      /* the colours of the mesh multiply kd */
    bool dissolve_of_tr; /* of Tr, not of d */
    int illum;
    struct model_texture map_kd, map_ks, map_ke, map_d, map_bump, map_normal, map_metal, map_coat_normal;
    /* Of layered materials: the colour is the reflectance head on (times gloss_colour), alpha times 1 - roughness the
     * gloss; both take the place of the numbers. */
    struct model_texture map_gloss;
    struct colour gloss_colour;
    struct model_layer_map layer_maps[MODEL_LAYER_MAPS];
    uint32_t layer_map_count;
};
/* The maps of a material, one after the other; NULL behind the last. */
struct model_texture *model_map(struct model_material *m, size_t index);

/* Tables while the file is read; afterwards a finished mesh. */
struct model_mesh {
    const char *name;
    struct list vertices, normals, uvs, colours;      /* double[3], double[3], double[2], float[3] by vertex */
    struct list second_uvs;                           /* double[2], as many as uvs, or empty */
    struct list starts;                               /* uint32_t: faces, and after finishing the end */
    struct list vertex_index, normal_index, uv_index; /* uint32_t per corner; MODEL_NONE: this corner has none */
    struct list face_slot;                            /* uint32_t per face, or empty */
    bool normals_by_vertex, uvs_by_vertex;            /* their index lists are vertex_index */
    bool colours_by_face;
    struct list slots;      /* uint32_t: the material of a slot, or MODEL_NONE */
    struct list slot_names; /* const char *, the same number, or none */
    struct mesh *mesh;
};

struct model_node {
    const char *name;
    uint32_t parent; /* an earlier node, or MODEL_NONE */
    uint32_t mesh;   /* or MODEL_NONE */
    struct transform parent_from_node;
};

/* A camera looks along -z of its own space; y is up. */
struct model_camera {
    const char *name; /* its own, or that of its node; "": none */
    struct affine model_from_camera;
    double vertical_angle; /* radians; 0: the camera is orthographic */
    double aspect;         /* width by height; 0: that of the picture */
    double half_size[2];   /* of an orthographic camera: half of width and height */
};

enum model_light_kind { MODEL_LIGHT_DIRECTIONAL, MODEL_LIGHT_POINT, MODEL_LIGHT_SPOT };

/* A light is at the origin of its own space and shines along -z. */
struct model_light {
    const char *name; /* as of cameras */
    enum model_light_kind kind;
    struct affine model_from_light;
    struct colour intensity; /* colour times candela; of directional lights times lux */
    double range;            /* it shines as far as this; 0: everywhere */
    double inner, outer;     /* radians, of spots: full light up to inner, none from outer on */
};

struct model_animation {
    const char *name; /* "": none */
    double duration;  /* seconds */
};

/* Searches for a file that does not exist under the name that the file in `folder` ("" or with a final slash) contains.
 * *path is NULL if there is none. *refused: the name leads out of the readable folders, so gray does not search. False
 * with an error. */
typedef bool model_search(void *context, const char *folder, const char *name, const char **path, bool *refused,
                          struct error *error);

/* Zero values: as in the file. */
struct model_options {
    bool smooth;           /* computed normals instead of the file's */
    double smooth_angle;   /* degrees: faces that meet at a smaller angle form one smooth surface; 0: flat */
    bool weld, flip;       /* one vertex for each position; faces reversed */
    double weld_distance;  /* with weld: vertices closer than this become one; 0: only those at equal positions */
    bool forgive;          /* faces with indices of nothing are left out */
    bool animated;         /* the nodes are as the animation moves them at the time; else at rest */
    double time;           /* seconds */
    const char *animation; /* a name, or a number from 1; NULL: the first one */
    const char *variant;   /* of the materials (KHR_materials_variants); NULL: none */
    const struct path_policy *path_policy; /* the readable folders; NULL: all */
    model_search *search;                  /* or NULL; only while the file is read */
    void *search_context;
    bool single_file; /* no other file is opened (tests of readers with unknown bytes) */
    size_t max;       /* vertices, and corners, of a mesh; 0: the maximum of an index */
};

enum { MODEL_WARNINGS = 16 };

/* Owner: the caller, or the store that receives it; model_destroy. Zero value: empty. */
struct model {
    struct arena arena; /* names */
    const char *path;
    struct model_options options;
    struct list materials, meshes, nodes;    /* struct model_material, model_mesh, model_node */
    struct list cameras, lights, animations; /* struct model_camera, model_light, model_animation */
    const char *warnings[MODEL_WARNINGS];
    int warning_count;
    bool refused;           /* model_find: the last name leads out of the readable folders */
    struct file_set broken; /* pictures that could not be read: thousands of materials may name one */
};

/* The maximum number of vertices, and of corners, of a mesh: some numbers of 32 bits have other meanings. */
static inline size_t model_max(const struct model *model) {
    return model->options.max ? model->options.max : MODEL_NONE - 8;
}

/* Whether the file has an ending of models, also before ".gz". */
bool model_is_named(const char *path);
/* Whether it is that of STL, whose models have z up. */
bool model_is_stl(const char *path);
/* Reads the file and makes meshes with the options. Errors are one line: FILE:LINE: what, or FILE: byte N: what. */
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
static inline struct model_camera *model_cameras(const struct model *model) {
    return model->cameras.items;
}
static inline struct model_light *model_lights(const struct model *model) {
    return model->lights.items;
}
static inline struct model_animation *model_animations(const struct model *model) {
    return model->animations.items;
}

/* --- for the readers --- */

/* All of these return NULL or false after reporting lack of memory. */
struct model_mesh *model_add_mesh(struct model *model, struct error *error);
struct model_material *model_add_material(struct model *model, struct error *error); /* plain gray, nothing else */
struct model_node *model_add_node(struct model *model, struct error *error);         /* at the top, no mesh */
/* Equal warnings are kept once. The last one that is kept says that there are more. */
void model_warn(struct model *model, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A file that the model names. gray tries its folder with any spelling of the path, then the bare name, then the search
 * of the options. If *path is NULL, model_why_missing() returns the reason. */
bool model_find(struct model *model, const char *name, size_t length, const char **path, struct error *error);
const char *model_why_missing(const struct model *model);
/* An error that says so if the text has two bytes a letter. */
bool text_is_readable(const char *path, const void *data, size_t size, struct error *error);

/* What a reader leaves out, of one kind: how many, and the line of the first (or its byte, in binary files). */
struct left_out {
    size_t count, at;
};
void left_out_add(struct left_out *out, size_t at);
/* One warning, unless nothing of the kind was left out. `what` is a sentence without its full stop. */
void model_warn_left_out(struct model *model, const char *path, const struct left_out *out, bool binary,
                         const char *what);

/* Lines whose first words a reader of text does not know, or cannot show. The words point into the file. */
enum { UNREAD_WORDS = 6 };
struct unread {
    struct left_out lines;
    struct {
        const char *text;
        size_t length, count;
    } words[UNREAD_WORDS];
    int word_count;
};
void unread_add(struct unread *unread, const char *word, size_t length, size_t line);
/* `path` is that of the file with these lines. */
void model_warn_unread(struct model *model, const char *path, const struct unread *unread);

/* The colours of the mesh multiply its materials; faces without a material get a white one. */
bool model_show_colours(struct model *model, struct model_mesh *mesh, struct error *error);
/* A warning, once for each name, of a picture that model_find just did not find. `where`: "FILE" or "FILE:LINE". */
void model_warn_missing(struct model *model, const char *where, const char *name);

bool ply_load(struct model *model, const uint8_t *data, size_t size, struct error *error);
bool stl_load(struct model *model, const uint8_t *data, size_t size, bool binary, struct error *error);
bool gltf_load(struct model *model, const uint8_t *data, size_t size, struct error *error);
bool obj_load(struct model *model, const char *text, size_t size, struct error *error);
/* Reads a library of materials; `line` of the model names it. */
bool mtl_load(struct model *model, const char *path, const char *text, size_t size, struct error *error);

#endif
