/* Fogs. */
#include "script/bindings_internal.h"
#include "script/context.h"

static bool give_fog(struct script_context *context, struct fog *fog, const struct script_value *args,
                     struct script_result *result, struct error *error) {
    struct fog *kept = arena_alloc(&context->scene.arena, sizeof *kept);
    if (!kept)
        return error_no_memory(error, "a fog");
    fog->colour = args[FOG_COLOUR].given ? args[FOG_COLOUR].vector : vec3_all(0.5);
    fog->clear_sky = args[FOG_CLEAR_SKY].boolean;
    *kept = *fog;
    result->pointer = kept;
    return true;
}

bool gr_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
            struct error *error) {
    struct fog fog = {.kind = args[FOG_IS_SQUARED].boolean ? FOG_SQUARED : FOG_EXPONENTIAL,
                      .density = args[FOG_AMOUNT].number};
    return give_fog(context, &fog, args, result, error);
}

bool gr_linear_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    struct fog fog = {.kind = FOG_LINEAR, .near = args[FOG_NEAR].number, .far = args[FOG_FAR].number};
    if (fog.near > fog.far)
        return error_set(error, ERROR_SCENE, "near must be at most far");
    return give_fog(context, &fog, args, result, error);
}

bool gr_height_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    struct fog fog = {.kind = FOG_HEIGHT,
                      .density = args[FOG_AMOUNT].number,
                      .base = args[FOG_BASE].number,
                      .scale = args[FOG_SCALE].given ? args[FOG_SCALE].number : 1};
    return give_fog(context, &fog, args, result, error);
}

bool gr_fog_profile(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    const struct script_value *table = &args[FOG_PROFILE_TABLE];
    uint32_t count = table->count;
    if (count == 0)
        return error_set(error, ERROR_SCENE, "profile must not be empty");
    double *rows = arena_alloc_array(&context->scene.arena, count, 3 * sizeof *rows);
    if (!rows)
        return error_no_memory(error, "a fog");
    double *heights = rows, *densities = rows + count, *sums = rows + 2 * (size_t)count;
    for (uint32_t i = 0; i < count; i++) {
        if (table->pairs[i][1] < 0)
            return error_set(error, ERROR_SCENE, "profile[%u][2] must be >= 0, it is a density", i + 1);
        if (i > 0 && table->pairs[i][0] < table->pairs[i - 1][0])
            return error_set(error, ERROR_SCENE, "profile[%u][1] must be at least the height before it", i + 1);
        heights[i] = table->pairs[i][0];
        densities[i] = table->pairs[i][1];
        sums[i] = i == 0 ? 0 : sums[i - 1] + (heights[i] - heights[i - 1]) * 0.5 * (densities[i] + densities[i - 1]);
    }
    struct fog fog = {.kind = FOG_PROFILE, .count = count, .heights = heights, .densities = densities, .sums = sums};
    return give_fog(context, &fog, args, result, error);
}

bool gr_fog_grid(struct script_context *context, const struct script_value *args, struct script_result *result,
                 struct error *error) {
    struct vec3 cells = args[FOG_CELLS].vector;
    struct fog fog = {.kind = FOG_GRID, .corner = args[FOG_CORNER].vector, .size = args[FOG_SIZE].vector};
    uint64_t count = 1;
    for (int axis = 0; axis < 3; axis++) {
        double n = vec3_get(cells, axis);
        if (n != (double)(uint32_t)n)
            return error_set(error, ERROR_SCENE, "cells[%d] must be a whole number", axis + 1);
        fog.cells[axis] = (uint32_t)n;
        count *= fog.cells[axis];
    }
    bool one = args[FOG_DENSITIES].single;
    if (!one && args[FOG_DENSITIES].count != count)
        return error_set(error, ERROR_SCENE, "densities must have %llu numbers, one for each cell, not %u",
                         (unsigned long long)count, args[FOG_DENSITIES].count);
    double *densities = arena_alloc_array(&context->scene.arena, (size_t)count, sizeof *densities);
    if (!densities)
        return error_no_memory(error, "a fog");
    for (uint64_t i = 0; i < count; i++)
        densities[i] = args[FOG_DENSITIES].numbers[one ? 0 : i];
    fog.densities = densities;
    return give_fog(context, &fog, args, result, error);
}
