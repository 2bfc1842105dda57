/* Cameras and lights of model files. They are in the coordinates of the file: a script that moves the node moves the
 * shapes alone. Their tables are made when a script asks for them, once for each node. */
#include "script/gr_model_internal.h"

#include "math/elementary.h"
#include "script/scene_write_internal.h"
#include "script/script_internal.h"

#include <lauxlib.h>
#include <math.h>
#include <string.h>

/* A node that was made from a file. Frames of an animation release nodes, but serial numbers are never used again. */
struct script_model {
    uint32_t serial;
    bool used;    /* the script has looked at cameras or lights */
    char keys[2]; /* their addresses are the keys of both tables in the registry */
    const struct model *model;
    struct script_model *next; /* older */
};

struct transform models_turn(const struct script_context *context) {
    const struct script *script = script_of(context);
    bool is_z = context->sandbox.options->up == MODEL_UP_Z ||
                (context->sandbox.options->up == MODEL_UP_AUTO && model_is_stl(context->sandbox.files.path));
    return script->context.scene.is_model && is_z ? transform_rotate(0, -90) : transform_identity();
}

bool models_note(struct script_context *context, struct node *node, const struct model *model, struct error *error) {
    struct script *script = script_of(context);
    struct script_model *entry = arena_alloc(&context->sandbox.keep, sizeof *entry);
    if (!entry)
        return error_no_memory(error, "a model");
    if (script->context.scene.is_model) {
        struct transform turn = models_turn(context);
        node->parent_from_node = transform_compose(&turn, &node->parent_from_node);
    }
    *entry = (struct script_model){.serial = node->serial, .model = model, .next = script->models};
    script->models = entry;
    return true;
}

static struct script_model *entry_of(const struct script_context *context, const struct node *node) {
    struct script_model *entry = script_of(context)->models;
    while (entry && entry->serial != node->serial)
        entry = entry->next;
    return entry;
}

const struct model *models_find(const struct script_context *context, const struct node *node) {
    const struct script_model *entry = entry_of(context, node);
    return entry ? entry->model : NULL;
}

static void set_vector(lua_State *L, const char *field, struct vec3 v) {
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
        lua_pushnumber(L, vec3_get(v, k));
        lua_rawseti(L, -2, k + 1);
    }
    lua_setfield(L, -2, field);
}

/* The fields of gr.render for the camera. */
static void push_camera(lua_State *L, const struct model_camera *camera) {
    const struct transform turn = models_turn(context_of(L));
    const struct affine *own = &camera->model_from_camera;
    lua_newtable(L);
    lua_pushstring(L, camera->name);
    lua_setfield(L, -2, "name");
    set_vector(L, "eye", affine_point(&turn.forward, affine_point(own, vec3_all(0))));
    set_vector(L, "view", vec3_normalize(affine_vector(&turn.forward, affine_vector(own, vec3_make(0, 0, -1)))));
    set_vector(L, "up", vec3_normalize(affine_vector(&turn.forward, affine_vector(own, vec3_make(0, 1, 0)))));
    bool is_orthographic = camera->vertical_angle <= 0;
    if (is_orthographic)
        lua_pushliteral(L, "orthographic");
    else
        lua_pushliteral(L, "perspective");
    lua_setfield(L, -2, "projection");
    lua_pushnumber(L, is_orthographic ? 2 * camera->half_size[1] : camera->vertical_angle * (180 / PI));
    lua_setfield(L, -2, is_orthographic ? "view_height" : "fov");
}

/* The colour of a light of 1 lux, or of 1 candela at the distance 1: a white surface that faces a light of colour 1 has
 * the radiance 1, a watt as in scenes of Blender, whose files count 683 lumens for a watt. */
static const double colour_of_lumens = 1 / (683 * PI);

double models_light_at(const struct model *model, struct vec3 point, double near) {
    double sum = 0;
    for (size_t i = 0; i < model->lights.count; i++) {
        const struct model_light *light = &model_lights(model)[i];
        double far = vec3_length(vec3_sub(affine_point(&light->model_from_light, vec3_all(0)), point));
        double distance = light->kind == MODEL_LIGHT_DIRECTIONAL ? 1 : math_max(far, near);
        sum += colour_max_abs(light->intensity) * colour_of_lumens / (distance * distance);
    }
    return sum;
}

/* The degrees whose cosine a spot light computes as this one does from radians; they are near. */
static double degrees_of(double radians) {
    double degrees = radians * (180 / PI), low = degrees, high = degrees;
    const double wanted = el_cos(radians), degree = PI / 180;
    for (int i = 0; i < 64; i++) {
        if (el_cos(low * degree) == wanted)
            return low;
        if (el_cos(high * degree) == wanted)
            return high;
        low = nextafter(low, 0);
        high = nextafter(high, 180);
    }
    return degrees;
}

/* A scene that is written has the light as a call: the directions have the length that they had. */
static void write_light(lua_State *L, const struct model_light *from, const struct scene_light *light) {
    const struct transform turn = models_turn(context_of(L));
    const struct vec3 along = affine_vector(&from->model_from_light, vec3_make(0, 0, -1));
    const struct colour colour = light->light.colour;
    const char *kind = "light";
    lua_newtable(L);
    set_vector(L, "colour", vec3_make(colour.r, colour.g, colour.b));
    if (from->kind != MODEL_LIGHT_POINT)
        set_vector(L, "direction", affine_vector(&turn.forward, along));
    if (from->kind == MODEL_LIGHT_DIRECTIONAL) {
        kind = "directional_light";
    } else {
        set_vector(L, "position", light->light.position);
        lua_pushnumber(L, 1);
        lua_setfield(L, -2, "intensity");
    }
    if (from->kind == MODEL_LIGHT_SPOT) {
        kind = "spot_light";
        lua_pushnumber(L, degrees_of(from->inner));
        lua_setfield(L, -2, "inner");
        lua_pushnumber(L, degrees_of(from->outer));
        lua_setfield(L, -2, "outer");
    }
    scene_write_object(L, light, kind);
}

static void push_light(lua_State *L, const struct model_light *from) {
    struct script_context *context = context_of(L);
    const struct transform turn = models_turn(context);
    struct scene_light *light = arena_alloc(&context->scene.arena, sizeof *light);
    if (!light)
        sandbox_raise_no_memory(&context->sandbox);
    const struct affine *own = &from->model_from_light;
    *light = (struct scene_light){0};
    light->light = (struct light){
        .kind = LIGHT_POINT,
        .colour = colour_scale(from->intensity, colour_of_lumens),
        .position = affine_point(&turn.forward, affine_point(own, vec3_all(0))),
        .direction = vec3_normalize(affine_vector(&turn.forward, affine_vector(own, vec3_make(0, 0, -1)))),
        .attenuation = ATTENUATION_INVERSE_SQUARE,
        .intensity = 1};
    light->light.display = light->light.colour;
    switch (from->kind) {
    case MODEL_LIGHT_POINT:
        break;
    case MODEL_LIGHT_DIRECTIONAL:
        light->light.kind = LIGHT_DIRECTIONAL;
        break;
    case MODEL_LIGHT_SPOT:
        light->light.kind = LIGHT_SPOT;
        light->light.cos_inner = el_cos(from->inner);
        light->light.cos_outer = el_cos(from->outer);
        break;
    }
    if (context->noted)
        write_light(L, from, light);
    handle_push(L, HANDLE_LIGHT, light);
}

bool models_push_field(lua_State *L, const struct node *node, const char *name) {
    bool cameras = strcmp(name, "cameras") == 0;
    struct script_model *entry = cameras || strcmp(name, "lights") == 0 ? entry_of(context_of(L), node) : NULL;
    if (!entry)
        return false;
    entry->used = true;
    const char *key = &entry->keys[cameras];
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, key) == LUA_TTABLE)
        return true;
    lua_newtable(L);
    size_t count = cameras ? entry->model->cameras.count : entry->model->lights.count;
    for (size_t i = 0; i < count; i++) {
        const char *own = cameras ? model_cameras(entry->model)[i].name : model_lights(entry->model)[i].name;
        if (cameras)
            push_camera(L, &model_cameras(entry->model)[i]);
        else
            push_light(L, &model_lights(entry->model)[i]);
        /* Of several with one name the first has it. */
        if (own[0] && lua_getfield(L, -2, own) == LUA_TNIL) {
            lua_pushvalue(L, -2);
            lua_setfield(L, -4, own);
        }
        lua_settop(L, lua_gettop(L) - (own[0] != '\0'));
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, key);
    return true;
}

/* Whether another entry of the model was used, or is newer and so has the notice. */
static bool is_settled(const struct script *script, const struct script_model *entry) {
    bool before = true;
    for (const struct script_model *other = script->models; other; other = other->next) {
        before = before && other != entry;
        if (other->model == entry->model && (other->used || before))
            return true;
    }
    return false;
}

void models_report_unused(const struct script *script) {
    char text[PATH_SIZE + 256], cameras[48] = "", lights[48] = "";
    if (script->host->repeats || script->context.scene.is_model)
        return;
    for (const struct script_model *entry = script->models; entry; entry = entry->next) {
        size_t seen = entry->model->cameras.count, lit = entry->model->lights.count;
        if (seen + lit == 0 || is_settled(script, entry))
            continue;
        if (seen > 0)
            (void)snprintf(cameras, sizeof cameras, "%zu camera%s", seen, seen > 1 ? "s" : "");
        if (lit > 0)
            (void)snprintf(lights, sizeof lights, "%zu light%s", lit, lit > 1 ? "s" : "");
        (void)snprintf(text, sizeof text, "%s: %s has %s%s%s that nothing uses: %s%s%s of gr.model",
                       script->context.sandbox.files.path, entry->model->path, cameras, seen && lit ? " and " : "",
                       lights, seen ? "the field cameras" : "", seen && lit ? " and " : "",
                       lit ? "the field lights" : "");
        sandbox_message(&script->context.sandbox, SCRIPT_NOTICE, text);
    }
}
