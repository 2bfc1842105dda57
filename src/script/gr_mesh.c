/* Meshes from tables and from files. Both are assets: equal tables, or the same file, give one mesh, so that a script
 * that builds its scene again for every picture does not build its meshes again. */
#include "base/file.h"
#include "base/suggestion.h"
#include "compat/lenient.h"
#include "compat/lenient_picture.h"
#include "formats/font.h"
#include "formats/model_node.h"
#include "mesh/mesh_smooth.h"
#include "script/gr_model_internal.h"
#include "script/rows_internal.h"
#include "script/script_internal.h"

#include <math.h>
#include <string.h>

enum {
    MESH_NAME,
    MESH_MATERIAL,
    MESH_FILE,
    MESH_SMOOTH,
    MESH_WELD,
    MESH_FLIP,
    MESH_CULL,
    MESH_THIN_WALLED,
    MESH_MEDIUM,
    MESH_MATERIALS,
    MESH_TIME,
    MESH_ANIMATION,
    MESH_VARIANT,
    MESH_VERTS, /* gr.model has those before it */
    MESH_NORMALS,
    MESH_FACES,
    MESH_FACE_NORMALS,
    MESH_UVS,
    MESH_FACE_UVS,
    MESH_FACE_MATERIALS
};
static const struct script_parameter mesh_parameters[] = {
    [MESH_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'mesh'", NAME_HELP},
    [MESH_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},
    [MESH_FILE] = {"file", KIND_FILE, OPTIONAL, ANY, NULL, NULL,
                   "An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces."},
    [MESH_SMOOTH] =
        {"smooth", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 180), "degrees", "the given normals",
         "Crease angle: faces that meet at a smaller angle are shaded as one smooth surface; 0: all faces are flat."},
    [MESH_WELD] = {"weld", KIND_BOOLEAN, OPTIONAL | OR_NUMBER, ABOVE(0), NULL, "false",
                   "Whether vertices at the same position become one; a number: those closer than this."},
    [MESH_FLIP] = {"flip", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the faces are reversed."},
    [MESH_CULL] = {"cull", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(NODE_CULLS), NULL, "'none'",
                   "Which faces rays ignore: those seen from behind, or those seen from the front."},
    [MESH_THIN_WALLED] = THIN_WALLED,
    [MESH_MEDIUM] = MEDIUM,
    [MESH_MATERIALS] = {"materials", KIND_MATERIALS, OPTIONAL, ANY, NULL, "the file's",
                        "Materials by the names of the parts in the file; with face_materials, a list."},
    [MESH_TIME] = {"time", KIND_NUMBER, OPTIONAL, ANY, "seconds", "at rest",
                   "The moment of the file's animation (glTF)."},
    [MESH_ANIMATION] = {"animation", KIND_TEXT, OPTIONAL, ANY, NULL, "the first one",
                        "The name of an animation in the file, or its number from 1."},
    [MESH_VARIANT] = {"variant", KIND_TEXT, OPTIONAL, ANY, NULL, "the file's default",
                      "The name of a variant of the materials in the file (glTF)."},
    [MESH_VERTS] = {"verts", KIND_POINTS, OPTIONAL, ANY, NULL, NULL, "The vertices."},
    [MESH_NORMALS] = {"normals", KIND_POINTS, OPTIONAL, ANY, NULL, "none: flat", "Vertex normals, of any length."},
    [MESH_FACES] = {"faces", KIND_FACES, OPTIONAL, ANY, NULL, NULL, "Polygons: tuples of indices into verts, from 0."},
    [MESH_FACE_NORMALS] = {"face_normals", KIND_FACES, OPTIONAL, ANY, NULL, "faces",
                           "For each face a tuple of indices into normals, from 0."},
    [MESH_UVS] = {"uvs", KIND_PAIRS, OPTIONAL, ANY, NULL, "none",
                  "Texture coordinates, {u, v}; v = 0 is the lower edge of an image."},
    [MESH_FACE_UVS] = {"face_uvs", KIND_FACES, OPTIONAL, ANY, NULL, "faces",
                       "For each face a tuple of indices into uvs, from 0."},
    [MESH_FACE_MATERIALS] = {"face_materials", KIND_NUMBERS, OPTIONAL, ANY, NULL, "material for all",
                             "With faces: the index into materials of each face, from 1."},
};

static void read_options(const struct script_value *args, struct model_options *options) {
    options->smooth = args[MESH_SMOOTH].given;
    options->smooth_angle = args[MESH_SMOOTH].number;
    options->weld = args[MESH_WELD].boolean;
    options->weld_distance = args[MESH_WELD].number;
    options->flip = args[MESH_FLIP].boolean;
    options->animated = args[MESH_TIME].given || args[MESH_ANIMATION].given;
    options->time = args[MESH_TIME].number;
    options->animation = args[MESH_ANIMATION].given ? args[MESH_ANIMATION].text : NULL;
    options->variant = args[MESH_VARIANT].given ? args[MESH_VARIANT].text : NULL;
}

static void warn_of_model(struct script_context *context, const struct model *model, int first) {
    for (int i = first; i < model->warning_count; i++)
        sandbox_warn(&context->sandbox, "%s", model->warnings[i]);
}

/* Finds the file of a mesh. Scenes of courses name it without its ending, as gr.mesh('cow', 'cow'), and the puppets
 * of one course have the name of the mesh first: gr.mesh('sphere', 'torso'). */
static bool find_mesh(struct script_context *context, const struct script_value *args, char path[PATH_SIZE],
                      struct error *error) {
    static const char *const endings[] = {".obj", ".ply", ".stl", ".glb", ".gltf"};
    const char *name = args[MESH_FILE].text, *slash = strrchr(name, '/');
    if (files_require(&context->sandbox, name, path, error))
        return true;
    if (error->kind != ERROR_SCENE || error->limit || error->refused || strchr(slash ? slash : name, '.'))
        return false;
    const char *bases[] = {name, args[MESH_NAME].given ? args[MESH_NAME].text : name};
    for (size_t k = 0; k < 2 * COUNT(endings); k++) {
        char file[PATH_SIZE];
        struct error other;
        const char *base = bases[k / COUNT(endings)];
        int length = snprintf(file, sizeof file, "%s%s", base, endings[k % COUNT(endings)]);
        if (length >= PATH_SIZE || !files_require(&context->sandbox, file, path, &other))
            continue;
        if (base != name)
            sandbox_warn(&context->sandbox, "there is no mesh '%s'; '%s' is shown", name, file);
        return true;
    }
    return false;
}

static struct model *model_of_file(struct script_context *context, const struct script_value *args,
                                   struct error *error) {
    char path[PATH_SIZE], canonical[PATH_SIZE];
    struct model_options options = {.path_policy = context->sandbox.path_policy,
                                    .search = files_search,
                                    .search_context = &context->sandbox,
                                    .forgive = context->lenient != NULL};
    read_options(args, &options);
    if (!find_mesh(context, args, path, error))
        return NULL;
    if (!file_canonical(path, canonical, sizeof canonical)) {
        error_set(error, ERROR_SCENE, "cannot find '%s'", args[MESH_FILE].text);
        return NULL;
    }
    bool fresh;
    struct model *model = model_asset(context->scene.assets, path, canonical, &options, &fresh, error);
    if (model && fresh)
        warn_of_model(context, model, 0);
    return model;
}

/* Checks that every index is below count, and that every face has three corners or more. Indices in messages start at
 * 1, as in Lua. */
static bool check_faces(const struct script_value *faces, const char *name, uint32_t count, const char *of,
                        struct error *error) {
    for (uint32_t f = 0; f < faces->count; f++) {
        uint32_t corners = faces->starts[f + 1] - faces->starts[f];
        if (corners < 3)
            return error_set(error, ERROR_SCENE, "%s[%u] has %u corners, not 3 or more", name, f + 1, corners);
        for (uint32_t k = 0; k < corners; k++) {
            uint32_t index = faces->indices[faces->starts[f] + k];
            if (index >= count && count == 0)
                return error_set(error, ERROR_SCENE, "%s[%u][%u] is %u, but %s is empty", name, f + 1, k + 1, index,
                                 of);
            if (index >= count)
                return error_set(error, ERROR_SCENE, "%s[%u][%u] is %u, but %s ends with number %u, counted from 0",
                                 name, f + 1, k + 1, index, of, count - 1);
        }
    }
    return true;
}

/* The arrays that the indices of faces refer to. */
struct face_targets {
    uint32_t count;
    const char *name;
};

/* The indices of the corners into normals or uvs: those of `own`, or those of the vertices if there are none. */
static bool corner_indices(const struct script_value *faces, const struct script_value *own, const char *own_name,
                           struct face_targets targets, const uint32_t **indices, struct error *error) {
    const struct script_value *used = own->given ? own : faces;
    if (!check_faces(used, own->given ? own_name : "faces", targets.count, targets.name, error))
        return false;
    if (used->count != faces->count)
        return error_set(error, ERROR_SCENE, "%s has %u entries, but faces has %u", own_name, used->count,
                         faces->count);
    for (uint32_t f = 0; f < faces->count; f++)
        if (used->starts[f + 1] != faces->starts[f + 1])
            return error_set(error, ERROR_SCENE, "%s[%u] and faces[%u] have different numbers of corners", own_name,
                             f + 1, f + 1);
    *indices = used->indices;
    return true;
}

/* The slots of the faces: numbers of `materials`, counted from 1 there and from 0 here. */
static bool face_slots(struct script_context *context, const struct script_value *args, const uint32_t **out,
                       struct error *error) {
    const struct script_value *numbers = &args[MESH_FACE_MATERIALS], *materials = &args[MESH_MATERIALS];
    *out = NULL;
    if (!numbers->given && !materials->given)
        return true;
    if (!numbers->given)
        return error_set(error, ERROR_SCENE, "face_materials is missing: it says which face has which material");
    if (!materials->given || materials->names)
        return error_set(error, ERROR_SCENE, "materials must be a list, since face_materials has indices into it");
    if (numbers->single || numbers->count != args[MESH_FACES].count)
        return error_set(error, ERROR_SCENE, "face_materials has %u entries, but faces has %u", numbers->count,
                         args[MESH_FACES].count);
    uint32_t *slots = arena_alloc_array(&context->sandbox.call, numbers->count, sizeof *slots);
    if (!slots)
        return error_no_memory(error, "the materials of the faces");
    for (uint32_t f = 0; f < numbers->count; f++) {
        double number = numbers->numbers[f];
        if (!(number >= 1 && number <= materials->count) || number != floor(number))
            return error_set(error, ERROR_SCENE, "face_materials[%u] is %.15g, but materials has %u entries", f + 1,
                             number, materials->count);
        slots[f] = (uint32_t)number - 1;
    }
    *out = slots;
    return true;
}

static struct mesh *mesh_from_tables(struct script_context *context, const struct script_value *args, const char *name,
                                     struct error *error) {
    const struct script_value *verts = &args[MESH_VERTS], *faces = &args[MESH_FACES], *normals = &args[MESH_NORMALS];
    const struct script_value *uvs = &args[MESH_UVS];
    struct mesh_input input = {.name = name,
                               .vertex_count = verts->count,
                               .face_count = faces->count,
                               .vertices = verts->points,
                               .face_start = faces->starts,
                               .vertex_index = faces->indices};
    if (!check_faces(faces, "faces", verts->count, "verts", error))
        return NULL;
    if (normals->given) {
        input.normal_count = normals->count;
        input.normals = normals->points;
        if (!corner_indices(faces, &args[MESH_FACE_NORMALS], "face_normals",
                            (struct face_targets){normals->count, "normals"}, &input.normal_index, error))
            return NULL;
    }
    if (uvs->given) {
        input.uv_count = uvs->count;
        input.uvs = uvs->pairs;
        if (!corner_indices(faces, &args[MESH_FACE_UVS], "face_uvs", (struct face_targets){uvs->count, "uvs"},
                            &input.uv_index, error))
            return NULL;
    }
    if (!face_slots(context, args, &input.face_material, error))
        return NULL;
    /* The same steps as for the files of models, in the same order. */
    struct model_options options = {0};
    struct mesh_tables own = {0};
    read_options(args, &options);
    struct mesh *mesh = NULL;
    if ((!options.weld || mesh_input_weld(&input, &own, options.weld_distance, error)) &&
        (!options.flip || mesh_input_flip(&input, &own, error)) &&
        (!options.smooth || mesh_input_smooth(&input, &own, options.smooth_angle, error)))
        mesh = assets_mesh(context->scene.assets, &input, error);
    mesh_tables_destroy(&own);
    return mesh;
}

/* Every name must be that of a part. */
static bool check_parts(const struct model *model, const struct script_value *materials, struct error *error) {
    if (materials->given && !materials->names)
        return error_set(error, ERROR_SCENE, "materials of a file have names, as in {paint = m}");
    for (uint32_t i = 0; i < materials->count; i++) {
        struct suggestion suggestion;
        const char *part;
        if (model_has_part(model, materials->names[i]))
            continue;
        suggest_begin(&suggestion, materials->names[i]);
        for (size_t k = 0; (part = model_part(model, k)); k++)
            suggest_offer(&suggestion, part);
        if (suggestion.best)
            return error_set(error, ERROR_SCENE, "materials: %s has no part '%.100s'; did you mean '%.100s'?",
                             model->path, materials->names[i], suggestion.best);
        return error_set(error, ERROR_SCENE, "materials: %s has no part '%.100s'", model->path, materials->names[i]);
    }
    return true;
}

/* The list as the slots of a mesh from tables. */
static bool keep_slots(struct script_context *context, const struct script_value *materials, struct node *node,
                       struct error *error) {
    const struct material **slots = arena_alloc_array(&context->scene.arena, materials->count, sizeof *slots);
    if (!slots)
        return error_no_memory(error, "the materials of a mesh");
    memcpy(slots, materials->materials, materials->count * sizeof *slots);
    node->slots = slots;
    node->slot_count = materials->count;
    for (uint32_t i = 0; i < materials->count; i++)
        slots[i] = slots[i] ? slots[i] : node->material;
    node->material = NULL;
    return true;
}

static bool gr_mesh(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    /* A file, or vertices and faces. */
    bool from_file = args[MESH_FILE].given, from_tables = args[MESH_VERTS].given || args[MESH_FACES].given;
    if (from_file && from_tables)
        return error_set(error, ERROR_SCENE, "file and verts exclude each other");
    if (!from_file && !args[MESH_VERTS].given)
        return error_set(error, ERROR_SCENE, "verts is missing (or file, the name of a mesh file)");
    if (!from_file && !args[MESH_FACES].given)
        return error_set(error, ERROR_SCENE, "faces is missing");

    const char *name = args[MESH_NAME].given ? args[MESH_NAME].text : "mesh";
    enum node_cull cull = (enum node_cull)args[MESH_CULL].choice;
    const struct material *material;
    if (!choose_material(context, &args[MESH_MATERIAL], &args[MESH_MEDIUM], &material, error))
        return false;
    if (from_file) {
        /* A file: its nodes, with materials for its parts. */
        struct model *model = model_of_file(context, args, error);
        const struct script_value *parts = &args[MESH_MATERIALS];
        struct model_placing placing = {.name = name,
                                        .material = material,
                                        .cull = cull,
                                        .walls = walls_of(&args[MESH_THIN_WALLED]),
                                        .part_names = parts->names,
                                        .part_materials = parts->materials,
                                        .part_count = parts->count};
        if (args[MESH_FACE_MATERIALS].given)
            return error_set(error, ERROR_SCENE, "face_materials goes with faces, not with a file");
        if (!model && context->scene.is_model) /* the message is complete */
            return error_elsewhere(error);
        if (!model && context->lenient && error->kind == ERROR_SCENE && !error->limit) {
            lenient_warn(context, "%s: a cube takes its place", error->text);
            *error = (struct error){0};
            result->pointer = lenient_placeholder(context, name, material, error);
            return result->pointer != NULL;
        }
        if (!model || !check_parts(model, parts, error))
            return false;
        int warned = model->warning_count;
        result->pointer = model_add_nodes(&context->scene, model, &placing, error);
        warn_of_model(context, model, warned);
        return result->pointer && models_note(context, result->pointer, model, error);
    }
    /* Tables: one node. */
    struct mesh *mesh = mesh_from_tables(context, args, name, error);
    struct node *node = mesh ? scene_node(&context->scene, NODE_GEOMETRY, name, error) : NULL;
    if (!node)
        return false;
    node->material = material;
    node->cull = cull;
    node->walls = walls_of(&args[MESH_THIN_WALLED]);
    node->shape.kind = SHAPE_MESH;
    node->shape.mesh = mesh;
    if (args[MESH_MATERIALS].count > 0 && !keep_slots(context, &args[MESH_MATERIALS], node, error))
        return false;
    result->pointer = node;
    return true;
}

static bool gr_model(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    struct script_value all[COUNT(mesh_parameters)] = {{0}};
    if (!args[MESH_FILE].given)
        return error_set(error, ERROR_SCENE, "file is missing");
    memcpy(all, args, MESH_VERTS * sizeof *args);
    return gr_mesh(context, all, result, error);
}

/* gr.glyphs: a font file is mapped for the time of one call. */

enum { GLYPHS_FONT, GLYPHS_TEXT };
static const struct script_parameter glyphs_parameters[] = {
    [GLYPHS_FONT] = {"font", KIND_FILE, 0, ANY, NULL, NULL, "A font file: TrueType, OpenType or Type 1."},
    [GLYPHS_TEXT] = {"text", KIND_TEXT, 0, ANY, NULL, NULL, "One line of text, in UTF-8."},
};

/* The bytes of letter k of a text in UTF-8. */
static int letter_bytes(const char *at) {
    int count = 1;
    while ((at[count] & 0xc0) == 0x80)
        count++;
    return count;
}

/* One warning names the letters of a text that the font lacks. */
static void warn_of_missing(struct script_context *context, const char *path, const char *string,
                            const struct font_text *text) {
    enum { NAMED = 8 };
    char names[NAMED * 8 + 1] = "", more[32] = "";
    uint32_t count = 0;
    for (uint32_t k = 0; k < text->count; string += letter_bytes(string), k++) {
        bool is_new = text->glyphs[k].missing;
        for (uint32_t i = 0; i < k && is_new; i++)
            is_new = text->glyphs[i].code != text->glyphs[k].code;
        if (is_new && ++count <= NAMED)
            (void)snprintf(names + strlen(names), sizeof names - strlen(names), "%s\"%.*s\"", count > 1 ? ", " : "",
                           letter_bytes(string), string);
    }
    if (count > NAMED)
        (void)snprintf(more, sizeof more, " and %u others", count - NAMED);
    if (count > 0)
        sandbox_warn(&context->sandbox, "%s has no letter for %s%s", path, names, more);
}

static bool gr_glyphs(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    char path[PATH_SIZE];
    struct file_bytes bytes;
    struct font_text *text = arena_alloc(&context->sandbox.call, sizeof *text);
    if (!text)
        return error_no_memory(error, "letters");
    /* Errors that do not depend on files are reported before files are searched. */
    if (!FONTS_READABLE)
        return font_layout(&(struct font_file){args[GLYPHS_FONT].text, NULL, 0}, "", &context->sandbox.call, text,
                           error);
    if (!files_require(&context->sandbox, args[GLYPHS_FONT].text, path, error) ||
        !path_policy_map(context->sandbox.path_policy, path, FILE_LIMIT, &bytes, error))
        return false;
    uint64_t refusals = mem_refusals();
    bool done = font_layout(&(struct font_file){path, bytes.data, bytes.size}, args[GLYPHS_TEXT].text,
                            &context->sandbox.call, text, error);
    file_unmap(&bytes);
    if (!done)
        (void)error_of_file(error, path, refusals);
    if (done)
        warn_of_missing(context, path, args[GLYPHS_TEXT].text, text);
    result->pointer = text;
    return done;
}

#define VN_FORM(first) first " verts normals faces face_normals"

static const struct script_function mesh_rows[] = {
    GR("mesh", mesh_parameters, RESULT_NODE, gr_mesh, "A mesh of polygons, flat or with vertex normals.",
       "material verts faces", "name file", "name verts faces", "material file", "name verts normals faces"),
    {"model",
     OWNER_GR,
     mesh_parameters,
     MESH_VERTS,
     {"file"},
     RESULT_NODE,
     gr_model,
     "The same as gr.mesh of a file: its node, which also has its cameras and lights.",
     false,
     NULL},
    GR("fast_mesh", mesh_parameters, RESULT_NODE, gr_mesh, "The same as gr.mesh: every mesh is fast.",
       "material verts faces", "name verts faces"),
    GR("vn_mesh", mesh_parameters, RESULT_NODE, gr_mesh, "A mesh with vertex normals.", VN_FORM("material"),
       VN_FORM("name")),
    GR("fast_vn_mesh", mesh_parameters, RESULT_NODE, gr_mesh, "The same as gr.vn_mesh.", VN_FORM("material"),
       VN_FORM("name")),
};
const struct function_rows mesh_functions = {mesh_rows, COUNT(mesh_rows)};

static const struct script_function glyph_rows[] = {
    GR("glyphs", glyphs_parameters, RESULT_GLYPHS, gr_glyphs,
       "Outlines of a line of text, in ems: a list of letters with code, x, advance, missing and contours (cubic, for "
       "gr.prism), and the fields width, ascender, descender and line.",
       "font text"),
};
const struct function_rows glyph_functions = {glyph_rows, COUNT(glyph_rows)};
