/* A function of Lua in place of a texture, a colour or a number: it is recorded, and the scene keeps the result. */
#include "script/recorded_internal.h"

/* Raises every error. */
static struct recording record(struct script_context *context, int index, const char *name, enum record_domain domain) {
    struct recording out;
    record_function(&context->sandbox, index, name, domain, &context->scene.arena, &out);
    context->scene.escaped = true; /* the list of recorded functions is older than the program */
    return out;
}

const struct expr_program *recorded_program(struct script_context *context, int index, const char *name,
                                            enum record_domain domain, const char **source) {
    lua_State *L = context->sandbox.lua;
    const struct handle *handle = handle_at(L, index);
    const struct script_texture *texture = handle && handle->type == HANDLE_TEXTURE ? handle->pointer : NULL;
    if (texture && texture->texture->kind == TEXTURE_FUNCTION) {
        *source = texture->texture->recorded.source;
        return texture->texture->recorded.program;
    }
    if (lua_type(L, index) != LUA_TFUNCTION)
        return NULL;
    const struct recording recording = record(context, index, name, domain);
    *source = recording.source;
    return recording.program;
}

const struct script_texture *recorded_texture(struct script_context *context, int index, const char *name) {
    const struct recording recording = record(context, index, name, RECORD_POINTS_OF_SPACE);
    struct error error = {0};
    struct script_texture out = {.texture = texture_keep(&context->scene.arena, recording.texture, &error)};
    const struct script_texture *kept = out.texture ? context_keep_texture(context, &out, &error) : NULL;
    if (!kept)
        sandbox_raise_error(&context->sandbox, &error);
    return kept;
}
