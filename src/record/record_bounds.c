/* Compares recorded functions with Lua at points where they are used: within the bounds of the shapes whose materials
 * use them, and of implicit solids, fogs and displaced meshes. Bounds are in object space, as p is. Infinite bounds are
 * replaced by +-100. A function is compared before a picture is rendered, and again only if its bounds have grown. */
#include "record/record_bounds.h"

#include "record/record_internal.h"
#include "scene/traversal.h"

#include <lauxlib.h>
#include <string.h>

#define FAR 100.0

void record_remember(struct sandbox *sandbox, int index, const struct expr_program *program,
                     enum record_domain domain) {
    lua_State *L = sandbox->lua;
    struct recorded_function *function = arena_alloc(&sandbox->keep, sizeof *function);
    if (!function)
        sandbox_raise_no_memory(sandbox);
    lua_pushvalue(L, index);
    *function = (struct recorded_function){.program = program,
                                           .reference = luaL_ref(L, LUA_REGISTRYINDEX),
                                           .domain = domain,
                                           .bounds = box_empty(),
                                           .is_compared = true,
                                           .next = sandbox->recorder->functions};
    sandbox->recorder->functions = function;
}

static bool contains(const struct box *outer, const struct box *inner) {
    return outer->min.x <= inner->min.x && outer->min.y <= inner->min.y && outer->min.z <= inner->min.z &&
           outer->max.x >= inner->max.x && outer->max.y >= inner->max.y && outer->max.z >= inner->max.z;
}

/* The finite part of an interval. */
static void cut_axis(double *low, double *high) {
    if (!(*low > -1e30 && *high < 1e30)) {
        *low = *low > -FAR && *low < FAR ? *low : -FAR;
        *high = *high<FAR && * high> - FAR ? *high : FAR;
    }
}

void record_use(struct sandbox *sandbox, const struct expr_program *program, const struct box *bounds) {
    struct recorded_function *function = sandbox->recorder->functions;
    struct box box = *bounds;
    while (function && function->program != program)
        function = function->next;
    if (!function || function->domain == RECORD_DIRECTIONS || !(box.min.x <= box.max.x))
        return;
    cut_axis(&box.min.x, &box.max.x);
    cut_axis(&box.min.y, &box.max.y);
    cut_axis(&box.min.z, &box.max.z);
    if (contains(&function->bounds, &box))
        return;
    function->bounds = box_join(function->bounds, box);
    function->is_compared = false;
}

/* --- materials --- */

static void use_texture(struct sandbox *sandbox, const struct texture *texture, const struct box *bounds) {
    if (!texture || !texture->has_function)
        return;
    if (texture->operation.kind == TEXTURE_FUNCTION)
        record_use(sandbox, texture->operation.recorded.program, bounds);
    for (int k = TEXTURE_PARTS; k-- > 0;)
        use_texture(sandbox, texture->parts[k], bounds);
}

static void use_material(struct sandbox *sandbox, const struct material *material, const struct box *bounds) {
    for (int k = 0; material && k < INPUT_COUNT; k++)
        use_texture(sandbox, material->inputs[k], bounds);
    for (const struct bump *bump = material ? material->bump : NULL; bump; bump = bump->below)
        use_texture(sandbox, bump->texture, bounds);
}

/* An operand without a material has the material of a solid above it. */
static const struct material *inherited_material(const struct scene_traversal *t) {
    for (uint32_t k = t->depth; k-- > 0;) {
        const struct node *node = t->steps[k].node;
        if (node->material && (k + 1 == t->depth || node->kind == NODE_CSG))
            return node->material;
    }
    return NULL;
}

static void use_node(struct sandbox *sandbox, const struct scene_traversal *t) {
    const struct node *node = scene_traversal_node(t);
    if (!node_has_surface(node))
        return;
    const struct box bounds = shape_bounds(&node->shape);
    use_material(sandbox, inherited_material(t), &bounds);
    for (uint32_t k = 0; k < node->slot_count; k++)
        use_material(sandbox, node->slots[k], &bounds);
    if (node->bump)
        use_texture(sandbox, node->bump->texture, &bounds);
}

/* Visits every node once, because instances may be on millions of paths. */
static bool use_nodes(struct sandbox *sandbox, const struct scene *scene, const struct node *root,
                      struct error *error) {
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true};
    uint8_t *seen = mem_alloc_zero((size_t)scene->node_total + 1, sizeof *seen);
    enum scene_event event = SCENE_NO_MEMORY;
    scene_traversal_begin(&t, root);
    while (seen && (event = scene_traversal_next(&t)) != SCENE_END && event != SCENE_NO_MEMORY) {
        const struct node *node = scene_traversal_node(&t);
        if (event != SCENE_ENTER)
            continue;
        if (seen[node->index])
            scene_traversal_skip(&t);
        else if (node->kind == NODE_GEOMETRY)
            use_node(sandbox, &t);
        seen[node->index] = 1;
    }
    scene_traversal_end(&t);
    mem_free(seen);
    return event == SCENE_END || error_no_memory(error, "the bounds of functions");
}

/* --- comparison --- */

/* Argument: the struct recorded_function. */
static int compare_protected(lua_State *L) {
    const struct recorded_function *function = lua_touserdata(L, 1);
    lua_rawgeti(L, LUA_REGISTRYINDEX, function->reference);
    record_compare_in_bounds(L, function);
    return 0;
}

static bool compare(struct sandbox *sandbox, struct recorded_function *function, struct error *error) {
    lua_State *L = sandbox->lua;
    sandbox->recorder->busy = true;
    lua_pushcfunction(L, compare_protected);
    lua_pushlightuserdata(L, function);
    int status = lua_pcall(L, 1, 0, 0);
    sandbox->recorder->busy = false;
    sandbox->lua = L;
    function->is_compared = true;
    if (status == LUA_OK)
        return true;
    if (lua_type(L, -1) == LUA_TSTRING && sandbox->fatal.kind == ERROR_NONE && !sandbox->limits.memory_out)
        (void)error_set(error, ERROR_SCENE, "%.900s", lua_tostring(L, -1));
    else
        *error = sandbox->fatal;
    lua_pop(L, 1);
    return false;
}

bool record_check(struct sandbox *sandbox, const struct scene *scene, const struct node *root, struct error *error) {
    struct recorded_function *function = sandbox->recorder->functions;
    if (!function)
        return true;
    if (!use_nodes(sandbox, scene, root, error))
        return false;
    for (; function; function = function->next)
        if (!function->is_compared && !compare(sandbox, function, error))
            return false;
    return true;
}
