/* A scene becomes the JSON of a file in Lua (gltf_scene.lua), which has a state of its own for all moments. Here is
 * what it asks: the nodes in their order, and the numbers of their poses, shapes, materials and lights. */
#include "export/gltf_write.h"

#include "base/hash.h"
#include "base/json_write.h"
#include "export/gltf_paint_internal.h"
#include "formats/model_format.h"
#include "light/light.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "world/node_path.h"

#include <lauxlib.h>
#include <lualib.h>
#include <math.h>

extern const char *const gltf_scene_lua[];

struct gltf_scene {
    struct gltf_options options;
    struct gltf_buffer buffer;
    struct key_map images;
    lua_State *lua; /* its result is the table on the stack */
    /* While the file is written: */
    bool is_binary;
    gltf_warn *warn;
    void *context;
    /* While a moment is added: */
    struct gltf_painter painter;
    const struct gltf_moment *moment;
    struct error *error;
    struct scene_traversal traversal;
    uint32_t next_primitive, next_light;
    struct gltf_surface surface; /* of the last primitive */
    struct gltf_paint paint;
};

static struct gltf_scene *scene_of(lua_State *L) {
    return *(struct gltf_scene **)lua_getextraspace(L);
}

/* --- maps --- */

static void push_map(lua_State *L, const struct affine *map) {
    push_numbers(L, map->m[0], 12);
}

/* The motion of a node within a still scene, from time 0 to time 1; returns in how many steps its pose is linear. */
static int motion_of(const struct node *node, struct motion *out) {
    enum { STEPS = 8 }; /* where the pose is turned and stretched */
    *out = motion_of_velocity(node->velocity);
    if (!node->moves_to || node->moves_to == node)
        return 1;
    struct transform from = node_parent_from_node(node), to = node_parent_from_node(node->moves_to);
    return motion_interpolate(&from, &to, node->velocity, out) ? STEPS : 1;
}

/* The map of the node, without its spin: its own, or at a time of a still scene. */
static int node_map(lua_State *L) {
    const struct node *node = scene_traversal_node(&scene_of(L)->traversal);
    struct transform own = node_parent_from_node(node), map = own;
    struct motion motion;
    if (!lua_isnoneornil(L, 1)) {
        (void)motion_of(node, &motion);
        map = motion_at(&motion, lua_tonumber(L, 1));
        if (!motion.has_end)
            map = transform_compose(&map, &own);
    }
    push_map(L, &map.forward);
    return 1;
}

static int node_spin(lua_State *L) {
    const struct node_spin *spin = scene_traversal_node(&scene_of(L)->traversal)->spin;
    struct transform map = transform_rotate_about(spin->axis, el_fmod(spin->degrees * lua_tonumber(L, 1), 360));
    push_map(L, &map.forward);
    return 1;
}

/* --- the tree --- */

/* The next event of the traversal: its word, the depth, and a table about the node. */
static int visit(lua_State *L) {
    struct gltf_scene *scene = scene_of(L);
    struct scene_traversal *t = &scene->traversal;
    enum scene_event event = SCENE_LEAVE;
    while (event == SCENE_LEAVE)
        event = scene_traversal_next(t);
    if (event == SCENE_NO_MEMORY)
        return luaL_error(L, GLTF_NO_MEMORY);
    if (event == SCENE_END)
        return 0;
    if (pool_cancelled(scene->options.pool)) {
        (void)error_set(scene->error, ERROR_CANCELLED, "stopped while a model was made");
        return lua_error(L);
    }
    const struct node *node = scene_traversal_node(t);
    lua_pushstring(L, event == SCENE_ENTER ? "enter" : "children");
    lua_pushinteger(L, t->depth);
    lua_createtable(L, 0, 8);
    field_text(L, "name", node->name);
    if (event == SCENE_CHILDREN) {
        const struct scene_step *step = &t->steps[t->depth - 1];
        const struct transform identity = transform_identity(), map = scene_step_map(step, &identity);
        field_number(L, "placement", step->placement);
        push_map(L, &map.forward);
        lua_setfield(L, -2, "map");
        return 3;
    }
    struct motion unused;
    uint32_t count = world_primitives_of(scene->moment->world, node, scene->next_primitive);
    field_number(L, "first", scene->next_primitive);
    field_number(L, "count", count);
    scene->next_primitive += count;
    field_flag(L, "is_operand", t->depth > 1 && scene_traversal_operand(t) != SCENE_CHILD);
    field_flag(L, "is_childless", node->child_count == 0);
    field_flag(L, "moves", node_moves(node));
    field_number(L, "degrees", node->spin ? node->spin->degrees : 0);
    field_number(L, "steps", node_moves(node) ? motion_of(node, &unused) : 1);
    return 3;
}

/* --- meshes --- */

/* The tolerance of a primitive, as a share of its size; `solid`: that of one that is meshed as a solid. */
static double share_of(const struct gltf_scene *scene, uint32_t primitive, bool solid) {
    const struct world *world = scene->moment->world;
    const struct box *box = &world->boxes[primitive], all = world_finite_bounds(world);
    double size = vec3_max_abs(vec3_sub(box->max, box->min)), wanted = scene->options.tolerance;
    double share = wanted > 0 && size > 0 ? math_min(math_max(wanted / size, 1e-6), 0.1) : 1e-3;
    double wide = math_min(1e-3 * vec3_max_abs(vec3_sub(all.max, all.min)) / size, 4e-3);
    return solid && !(wanted > 0) ? math_max(share, wide) : share;
}

/* Of all that makes the surface of a solid. If its texture may depend on the place, the number of its prototype, too:
 * such solids share a mesh only as instances. */
static uint64_t hash_solid(const struct gltf_scene *scene, uint32_t primitive) {
    const struct world *world = scene->moment->world;
    const struct csg *csg = primitive_prototype(world, primitive)->geometry.csg;
    const double share = share_of(scene, primitive, true);
    uint64_t hash = hash_bytes(&share, sizeof share, 2);
    bool plain = true;
    for (uint32_t i = 0; i < csg->leaf_count; i++) {
        const struct csg_leaf *leaf = &csg->leaves[i];
        const uint32_t numbers[] = {leaf->material, leaf->slot_count, leaf->cull};
        hash = hash_bytes(numbers, sizeof numbers, hash);
        hash = hash_bytes(&leaf->shape, sizeof leaf->shape, hash);
        hash = hash_bytes(&leaf->csg_from_leaf.forward, sizeof leaf->csg_from_leaf.forward, hash);
        plain = plain && leaf->slot_count < 2 && world->surfaces.materials[leaf->material].plain;
    }
    for (uint32_t i = 0; i < csg->program_length; i++) {
        const uint32_t numbers[] = {csg->program[i].operation, csg->program[i].leaf, i < csg->solid_length};
        hash = hash_bytes(numbers, sizeof numbers, hash);
    }
    const uint32_t *prototype = &world->primitives[primitive].prototype;
    return plain ? hash : hash_bytes(prototype, sizeof *prototype, hash);
}

/* Equal primitives have equal keys. Those in a space of their own, whose map is the second result, differ by where they
 * are only if a texture does. */
static int mesh_key(lua_State *L) {
    const struct world *world = scene_of(L)->moment->world;
    const uint32_t primitive = (uint32_t)lua_tointeger(L, 1);
    const struct prototype *prototype = primitive_prototype(world, primitive);
    struct transform map;
    if (prototype->geometry.csg) {
        lua_pushinteger(L, (lua_Integer)(hash_solid(scene_of(L), primitive) | 1));
        return 1;
    }
    const uint32_t numbers[] = {prototype->material, prototype->slot_count, prototype->geometry.shape.kind};
    uint64_t hash = hash_bytes(numbers, sizeof numbers, 1);
    bool is_unit = gltf_surface_is_unit(&prototype->geometry, &map);
    if (!is_unit || !world->surfaces.materials[prototype->material].plain)
        hash = hash_bytes(&prototype->geometry.shape, sizeof(struct shape), hash);
    lua_pushinteger(L, (lua_Integer)(hash | 1));
    if (is_unit)
        push_map(L, &map.forward);
    return 1 + is_unit;
}

static bool make_surface(struct gltf_scene *scene, uint32_t primitive) {
    const struct gltf_source source = {scene->moment->world, primitive, share_of(scene, primitive, false),
                                       share_of(scene, primitive, true), scene->options.pool};
    gltf_surface_destroy(&scene->surface);
    scene->paint = (struct gltf_paint){0};
    return gltf_surface_make(&source, &scene->surface, scene->error) &&
           (scene->surface.triangles.count == 0 ||
            gltf_paint_make(&scene->painter, primitive, &scene->surface, &scene->paint, scene->error));
}

/* Sets the list of the materials in the order of their triangles; one may stand there several times. */
static void set_materials(lua_State *L, const struct gltf_surface *surface) {
    uint32_t last = GLTF_NONE;
    lua_newtable(L);
    for (size_t i = 0; i < surface->triangles.count; i++) {
        const uint32_t material = gltf_triangles(surface)[i].material;
        if (material == last)
            continue;
        lua_pushinteger(L, last = material);
        lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
    }
    lua_setfield(L, -2, "materials");
}

/* Makes the triangles and textures of a primitive: a table about them. */
static int surface_of(lua_State *L) {
    static const char *const maps[] = {GLTF_MAPS(LIST_WORD)};
    struct gltf_scene *scene = scene_of(L);
    const uint32_t primitive = (uint32_t)lua_tointeger(L, 1);
    const struct gltf_paint *paint = &scene->paint;
    if (!make_surface(scene, primitive))
        return lua_error(L);
    lua_newtable(L);
    field_text(L, "name", primitive_node(scene->moment->world, primitive)->name);
    field_text(L, "why", scene->surface.why);
    set_materials(L, &scene->surface);
    field_flag(L, "has_normals", scene->surface.has_normals);
    field_flag(L, "is_open", scene->surface.is_open);
    field_flag(L, "by_vertex", paint->by_vertex);
    field_flag(L, "has_holes", paint->has_holes);
    field_flag(L, "has_veils", paint->has_veils);
    field_number(L, "strongest", paint->strongest);
    for (int i = 0; paint->baked && i < GLTF_MAP_COUNT; i++) {
        if (paint->maps[i] == GLTF_NONE)
            continue;
        gltf_push_view(L, &scene->buffer, paint->maps[i]);
        lua_setfield(L, -2, maps[i]);
    }
    return 1;
}

static int material_of(lua_State *L) {
    const struct gltf_scene *scene = scene_of(L);
    gltf_paint_push(L, &scene->painter, (uint32_t)lua_tointeger(L, 1), &scene->surface, &scene->paint);
    return 1;
}

/* The directions of u, at right angles to the normals: the last number is -1 where v runs to their right. */
static const float *make_tangents(lua_State *L, const struct gltf_surface *s) {
    const struct gltf_vertex *all = gltf_vertices(s);
    const size_t count = s->vertices.count;
    struct vec3 *sums = lua_newuserdatauv(L, (2 * count + 1) * sizeof *sums, 0); /* along u, and along v */
    float *out = lua_newuserdatauv(L, (4 * count + 1) * sizeof *out, 0);
    memset(sums, 0, 2 * count * sizeof *sums);
    for (size_t i = 0; i < s->triangles.count; i++) {
        const uint32_t *v = gltf_triangles(s)[i].vertex;
        struct vec3 along[2];
        gltf_directions(s, &gltf_triangles(s)[i], NULL, along);
        for (uint32_t k = 0; k < 6; k++) {
            struct vec3 *sum = &sums[2 * v[k / 2] + k % 2];
            *sum = vec3_add(*sum, along[k % 2]);
        }
    }
    for (size_t i = 0; i < count; i++) {
        struct vec3 n = gltf_point(all[i].normal), other;
        struct vec3 t = vec3_add_scaled(sums[2 * i], n, -vec3_dot(n, sums[2 * i]));
        if (vec3_max_abs(t) > 0)
            t = vec3_normalize(t);
        else
            frame_tangents(n, &t, &other);
        for (int k = 0; k < 3; k++)
            out[4 * i + (size_t)k] = (float)vec3_get(t, k);
        out[4 * i + 3] = vec3_dot(vec3_cross(n, t), sums[2 * i + 1]) < 0 ? -1 : 1;
    }
    return out;
}

/* An attribute of the vertices by its name in the file, as an accessor. */
static int attribute(lua_State *L) {
    enum { UV = 2, TANGENT = 4 };
    static const char *const names[] = {"POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0", "TANGENT", NULL};
    static const size_t offsets[] = {offsetof(struct gltf_vertex, point), offsetof(struct gltf_vertex, normal),
                                     offsetof(struct gltf_vertex, uv), offsetof(struct gltf_vertex, colour)};
    struct gltf_scene *scene = scene_of(L);
    const struct gltf_surface *s = &scene->surface;
    const size_t count = s->vertices.count;
    const int which = luaL_checkoption(L, 1, NULL, names);
    const size_t width = which == UV ? 2 : 3;
    if (which == TANGENT)
        return gltf_push_floats(L, &scene->buffer, make_tangents(L, s), count, 4, GLTF_VERTICES);
    float *numbers = lua_newuserdatauv(L, (count * width + 1) * sizeof *numbers, 0);
    for (size_t i = 0; i < count; i++) {
        memcpy(numbers + i * width, (const char *)&gltf_vertices(s)[i] + offsets[which], width * sizeof *numbers);
        if (which == UV) /* v from above */
            numbers[2 * i + 1] = 1 - numbers[2 * i + 1];
    }
    return gltf_push_floats(L, &scene->buffer, numbers, count, (int)width, GLTF_VERTICES);
}

/* Of the triangles of one material. */
static int indices(lua_State *L) {
    struct gltf_scene *scene = scene_of(L);
    const struct gltf_surface *s = &scene->surface;
    const uint32_t material = (uint32_t)lua_tointeger(L, 1);
    uint32_t *numbers = lua_newuserdatauv(L, (3 * s->triangles.count + 1) * sizeof *numbers, 0);
    size_t count = 0;
    for (size_t i = 0; i < s->triangles.count; i++)
        for (int k = 0; k < 3 && gltf_triangles(s)[i].material == material; k++)
            numbers[count++] = gltf_triangles(s)[i].vertex[k];
    return gltf_push_indices(L, &scene->buffer, numbers, count, s->vertices.count);
}

/* A list of numbers, vectors of that width, as an accessor. */
static int floats(lua_State *L) {
    const size_t count = lua_rawlen(L, 1);
    const int width = (int)lua_tointeger(L, 2);
    float *numbers = lua_newuserdatauv(L, (count + 1) * sizeof *numbers, 0);
    for (size_t i = 0; i < count; i++) {
        lua_rawgeti(L, 1, (lua_Integer)i + 1);
        numbers[i] = (float)lua_tonumber(L, -1);
        lua_pop(L, 1);
    }
    return gltf_push_floats(L, &scene_of(L)->buffer, numbers, count / (size_t)width, width, GLTF_NO_TARGET);
}

/* --- the camera and the lights --- */

static void set_camera(lua_State *L, const struct gltf_moment *moment) {
    static const char *const projections[] = {PROJECTIONS(LIST_WORD)};
    const struct lens *lens = moment->lens;
    lua_newtable(L);
    field_numbers(L, "eye", &moment->camera->eye.x, 3);
    field_numbers(L, "view", &moment->camera->view.x, 3);
    field_numbers(L, "up", &moment->camera->up.x, 3);
    field_number(L, "fov", moment->camera->fov);
    field_number(L, "view_height", lens->view_height);
    field_number(L, "aspect", moment->aspect);
    field_text(L, "projection", projections[lens->projection]);
    field_flag(L, "is_special",
               lens->aperture > 0 || lens->stereo != STEREO_NONE || lens->columns > 0 || lens->shift_x != 0 ||
                   lens->shift_y != 0);
    lua_setfield(L, -2, "camera");
}

/* A table about the next light of the world. */
static int next_light(lua_State *L) {
    static const char *const kinds[] = {LIGHT_KINDS(LIST_WORD)}, *const attenuations[] = {ATTENUATIONS(LIST_WORD)};
    struct gltf_scene *scene = scene_of(L);
    struct light_target middle;
    if (scene->next_light == scene->moment->world->light_count)
        return 0;
    const struct light *light = &scene->moment->world->lights[scene->next_light++];
    const double largest = colour_max_abs(light->colour);
    struct colour shown = gltf_light_of(&scene->painter, colour_scale(light->colour, 1 / largest));
    lua_newtable(L);
    field_text(L, "kind", kinds[light->kind]);
    field_text(L, "attenuation", attenuations[light->attenuation]);
    field_numbers(L, "middle", light_middle(light, &middle) ? &middle.at.x : (const double[3]){0, 0, 0}, 3);
    field_numbers(L, "direction", &light->direction.x, 3);
    field_numbers(L, "edge1", &light->edge1.x, 3);
    field_numbers(L, "edge2", &light->edge2.x, 3);
    field_numbers(L, "colour", &light->colour.r, 3);
    field_numbers(L, "shown", &shown.r, 3); /* the colour in the file */
    field_numbers(L, "falloff", light->falloff, 3);
    field_number(L, "range", light->range);
    field_number(L, "intensity", light->intensity);
    field_number(L, "inner", el_acos(light->cos_inner));
    field_number(L, "outer", el_acos(light->cos_outer));
    field_number(L, "radius", light->radius);
    field_flag(L, "emissive", light->emissive);
    field_flag(L, "one_sided", light->one_sided);
    field_flag(L, "has_profile", light->profile);
    field_flag(L, "leaves_out", light->lit);
    return 1;
}

/* --- other helpers --- */

static int arc_tangent(lua_State *L) {
    lua_pushnumber(L, el_atan2(lua_tonumber(L, 1), lua_tonumber(L, 2)));
    return 1;
}

static int warn_of(lua_State *L) {
    scene_of(L)->warn(scene_of(L)->context, lua_tostring(L, 1));
    return 0;
}

static int buffer(lua_State *L) {
    gltf_push_buffer(L, &scene_of(L)->buffer, scene_of(L)->is_binary);
    return 1;
}

/* --- the state --- */

static void *allocate(void *unused, void *block, size_t old_size, size_t size) {
    (void)unused, (void)old_size;
    if (size > 0)
        return mem_resize(block, size);
    mem_free(block);
    return NULL;
}

static const char *read_line(lua_State *L, void *lines, size_t *size) {
    const char *const **at = lines, *line = **at;
    (void)L;
    *size = line ? strlen(line) : 0;
    *at += line != NULL;
    return line;
}

static int open_state(lua_State *L) {
    static const luaL_Reg helpers[] = {
        {"node_map", node_map},     {"node_spin", node_spin},   {"visit", visit},
        {"mesh_key", mesh_key},     {"surface_of", surface_of}, {"material_of", material_of},
        {"attribute", attribute},   {"indices", indices},       {"floats", floats},
        {"next_light", next_light}, {"atan2", arc_tangent},     {"quote", json_quote},
        {"buffer", buffer},         {"warn_of", warn_of},       {NULL, NULL}};
    const char *const *lines = gltf_scene_lua;
    luaL_openlibs(L);
    lua_pushglobaltable(L);
    luaL_setfuncs(L, helpers, 0);
    if (lua_load(L, read_line, (void *)&lines, "=gltf_scene.lua", "t") != LUA_OK)
        return lua_error(L);
    lua_call(L, 0, 1);
    return 1;
}

struct gltf_scene *gltf_scene_create(const struct gltf_options *options) {
    struct gltf_scene *scene = mem_alloc_zero(1, sizeof *scene);
    if (!scene)
        return NULL;
    scene->options = *options;
    scene->lua = lua_newstate(allocate, NULL);
    if (scene->lua) {
        *(struct gltf_scene **)lua_getextraspace(scene->lua) = scene;
        lua_pushcfunction(scene->lua, open_state);
    }
    if (scene->lua && lua_pcall(scene->lua, 0, 1, 0) == LUA_OK)
        return scene;
    gltf_scene_destroy(scene);
    return NULL;
}

void gltf_scene_destroy(struct gltf_scene *scene) {
    if (!scene)
        return;
    if (scene->lua)
        lua_close(scene->lua);
    key_map_destroy(&scene->images);
    gltf_surface_destroy(&scene->surface);
    gltf_buffer_destroy(&scene->buffer);
    mem_free(scene);
}

/* Calls a function that pushes one result. */
static bool call(struct gltf_scene *scene, lua_CFunction function, const void *argument, struct error *error) {
    lua_State *L = scene->lua;
    scene->error = error;
    lua_pushcfunction(L, function);
    lua_pushvalue(L, 1);
    lua_pushlightuserdata(L, (void *)(uintptr_t)argument);
    if (lua_pcall(L, 2, 1, 0) == LUA_OK)
        return true;
    const char *text = lua_tostring(L, -1);
    if (error->kind == ERROR_NONE && text && !strstr(text, GLTF_NO_MEMORY))
        (void)error_set(error, ERROR_SCENE, "%.400s", text);
    lua_settop(L, 1);
    return error->kind == ERROR_NONE ? error_no_memory(error, "a model") : false;
}

static int add_moment(lua_State *L) {
    const struct gltf_moment *moment = lua_touserdata(L, 2);
    const struct box box = world_finite_bounds(moment->world);
    lua_getfield(L, 1, "add");
    lua_newtable(L);
    field_flag(L, "is_frame", moment->is_frame);
    field_number(L, "time", moment->time);
    field_flag(L, "is_empty", box_is_empty(&box));
    field_numbers(L, "bounds", (const double[]){box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z}, 6);
    if (moment->camera)
        set_camera(L, moment);
    lua_call(L, 1, 0);
    return 0;
}

bool gltf_scene_add(struct gltf_scene *scene, const struct gltf_moment *moment, struct error *error) {
    scene->painter = (struct gltf_painter){.buffer = &scene->buffer,
                                           .world = moment->world,
                                           .pool = scene->options.pool,
                                           .linear = scene->options.linear,
                                           .images = &scene->images};
    scene->moment = moment;
    scene->next_primitive = scene->next_light = 0;
    scene->traversal = world_traversal(moment->world, moment->root, 0);
    bool ok = call(scene, add_moment, moment, error);
    lua_settop(scene->lua, 1);
    scene_traversal_end(&scene->traversal);
    return ok;
}

static int write_text(lua_State *L) {
    lua_getfield(L, 1, "write");
    lua_call(L, 0, 1);
    return 1;
}

bool gltf_scene_write(struct gltf_scene *scene, bool binary, gltf_warn *warn, void *context, struct list *out,
                      struct error *error) {
    static const char version[] = "\"version\":\"2.0\"}";
    struct list text = {0};
    size_t size;
    scene->is_binary = binary;
    scene->warn = warn;
    scene->context = context;
    if (!call(scene, write_text, NULL, error))
        return false;
    const char *json = lua_tolstring(scene->lua, -1, &size);
    bool ok = list_add_bytes(&text, model_glb_header, strlen(model_glb_header)) &&
              list_add_bytes(&text, version, strlen(version)) && list_add_bytes(&text, json, size);
    ok = ok ? gltf_file_write(&scene->buffer, &text, binary, out, error) : error_no_memory(error, "a model");
    lua_settop(scene->lua, 1);
    list_destroy(&text);
    return ok;
}
