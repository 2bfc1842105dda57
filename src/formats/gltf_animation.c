/* Animations of glTF at one time: which sampler moves what, and its value. Source: Khronos Group, "glTF 2.0
 * Specification" (ISO/IEC 12113:2022), section 3.11 and appendix C. Before the first key and after the last one, their
 * values hold. */
#ifdef HAVE_JANSSON

#include "formats/gltf_animation_internal.h"

#include "formats/gltf_data_internal.h"
#include "math/elementary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The largest time of the inputs, which the format states. */
static double duration_of(const struct gltf *g, const json_t *samplers) {
    double duration = 0;
    for (size_t i = 0; i < json_array_size(samplers); i++) {
        const json_t *input = json_object_get(json_array_get(samplers, i), "input");
        json_int_t index = json_is_integer(input) ? json_integer_value(input) : -1;
        const json_t *accessor = index >= 0 ? json_array_get(gltf_array(g, "accessors"), (size_t)index) : NULL;
        duration = math_max(duration, json_number_value(json_array_get(json_object_get(accessor, "max"), 0)));
    }
    return duration;
}

bool gltf_list_animations(struct gltf *g) {
    const json_t *animations = gltf_array(g, "animations");
    for (size_t i = 0; i < json_array_size(animations); i++) {
        const json_t *source = json_array_get(animations, i);
        struct model_animation *room = list_room(&g->model->animations, 1, sizeof *room);
        if (!room)
            return error_no_memory(g->error, g->path);
        *room = (struct model_animation){gltf_name(g, source), duration_of(g, json_object_get(source, "samplers"))};
        if (!room->name)
            return false;
        g->model->animations.count++;
    }
    return true;
}

/* The number of the animation that the options name. */
static bool find_animation(struct gltf *g, size_t *out) {
    const char *wanted = g->model->options.animation;
    const struct model_animation *list = model_animations(g->model);
    size_t count = g->model->animations.count;
    *out = 0;
    if (!wanted)
        return true;
    for (size_t i = 0; i < count; i++)
        if (strcmp(list[i].name, wanted) == 0) {
            *out = i;
            return true;
        }
    char *end;
    unsigned long number = strtoul(wanted, &end, 10);
    if (wanted[0] >= '0' && wanted[0] <= '9' && !*end && number >= 1 && number <= count) {
        *out = number - 1;
        return true;
    }
    return gltf_choice_fails(g, "animation", gltf_array(g, "animations"), wanted);
}

bool gltf_choose_animation(struct gltf *g, const json_t *(**out)[GLTF_PATHS]) {
    static const char *const words[GLTF_PATHS] = {"translation", "rotation", "scale", "weights"};
    size_t nodes = json_array_size(gltf_array(g, "nodes")), chosen;
    *out = NULL;
    if (!g->model->options.animated)
        return true;
    if (!find_animation(g, &chosen))
        return false;
    if (g->model->animations.count == 0)
        gltf_lacks(g, "time", "the file has no animation");
    const json_t *animation = json_array_get(gltf_array(g, "animations"), chosen);
    const json_t *channels = json_object_get(animation, "channels"), *samplers = json_object_get(animation, "samplers");
    if (json_array_size(channels) == 0)
        return true;
    *out = mem_alloc_zero(nodes ? nodes : 1, sizeof **out);
    if (!*out)
        return error_no_memory(g->error, g->path);
    for (size_t i = 0; i < json_array_size(channels); i++) {
        char where[64];
        (void)snprintf(where, sizeof where, "animations[%zu].channels[%zu]", chosen, i);
        const json_t *channel = json_array_get(channels, i), *target = json_object_get(channel, "target");
        const char *path = json_string_value(json_object_get(target, "path"));
        uint64_t sampler;
        uint32_t node;
        int k = 0;
        if (!gltf_whole(g, channel, "sampler", UINT64_MAX, &sampler, where) ||
            !gltf_index(g, target, "node", "nodes", &node, where))
            return false;
        while (k < GLTF_PATHS && (!path || strcmp(path, words[k]) != 0))
            k++;
        if (k == GLTF_PATHS || node == MODEL_NONE || sampler >= json_array_size(samplers))
            gltf_lacks(g, where, "it moves nothing that gray reads");
        else
            (*out)[node][k] = json_array_get(samplers, (size_t)sampler);
    }
    return true;
}

/* The keys of a sampler around the time. */
struct keys {
    uint64_t before;
    bool mixed;  /* the next key counts, too */
    double step; /* seconds between them */
    double at;   /* 0 at the first one, 1 at the second one */
};

static bool find_keys(struct gltf *g, uint32_t accessor, const struct gltf_accessor *times, struct keys *out) {
    uint64_t low = 0, high = times->count - 1;
    double time = g->model->options.time, from, to;
    *out = (struct keys){0};
    /* The last key that is not later, or the first one. */
    while (low < high) {
        uint64_t middle = low + (high - low + 1) / 2;
        if (!gltf_accessor_read(g, accessor, times, middle, 1, &from))
            return false;
        if (from <= time)
            low = middle;
        else
            high = middle - 1;
    }
    out->before = low;
    if (low + 1 == times->count)
        return true;
    if (!gltf_accessor_read(g, accessor, times, low, 1, &from) ||
        !gltf_accessor_read(g, accessor, times, low + 1, 1, &to))
        return false;
    out->step = to - from;
    out->mixed = time > from && time < to;
    out->at = out->mixed ? (time - from) / out->step : 0;
    return true;
}

/* Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985: along the shorter arc. */
static void slerp(double *from, const double *to, double at) {
    double cosine = from[0] * to[0] + from[1] * to[1] + from[2] * to[2] + from[3] * to[3];
    double sign = cosine < 0 ? -1 : 1, angle = el_acos(math_min(fabs(cosine), 1)), sine = el_sin(angle);
    double a = 1 - at, b = at;
    if (sine > 1e-6) {
        a = el_sin(a * angle) / sine;
        b = el_sin(b * angle) / sine;
    }
    for (int i = 0; i < 4; i++)
        from[i] = a * from[i] + sign * b * to[i];
}

/* The value at a key of a cubic spline has a tangent before it and one after it. */
static void cubic(double *from, const double *out_tangent, const double *to, const double *in_tangent,
                  const struct keys *keys, size_t width) {
    double t = keys->at, t2 = t * t, t3 = t2 * t;
    for (size_t i = 0; i < width; i++)
        from[i] = (2 * t3 - 3 * t2 + 1) * from[i] + keys->step * (t3 - 2 * t2 + t) * out_tangent[i] +
                  (3 * t2 - 2 * t3) * to[i] + keys->step * (t3 - t2) * in_tangent[i];
}

bool gltf_sample(struct gltf *g, const json_t *sampler, enum gltf_path path, double *out, size_t width) {
    static const char where[] = "animations";
    const char *kind = json_string_value(json_object_get(sampler, "interpolation"));
    bool is_cubic = kind && strcmp(kind, "CUBICSPLINE") == 0, is_step = kind && strcmp(kind, "STEP") == 0;
    uint32_t input, output;
    struct gltf_accessor times, values;
    if (!gltf_index(g, sampler, "input", "accessors", &input, where) ||
        !gltf_index(g, sampler, "output", "accessors", &output, where))
        return false;
    if (input == MODEL_NONE || output == MODEL_NONE)
        return gltf_fail(g, where, "a sampler has no input or no output");
    if (!gltf_accessor(g, input, &times) || !gltf_accessor(g, output, &values))
        return false;
    /* Elements for each key: one, or one for each weight; three times as many with tangents. */
    uint64_t elements = path == GLTF_WEIGHTS ? width : 1, parts = is_cubic ? 3 : 1, stride = elements * parts;
    if (times.components != 1 || times.count == 0 || values.components != (int)(path == GLTF_WEIGHTS ? 1 : width) ||
        stride == 0 || values.count / stride < times.count)
        return gltf_fail(g, where, "accessors[%u] does not have the values for the times of accessors[%u]", output,
                         input);
    struct keys keys;
    if (!gltf_produce(g, 64 * times.sparse_count + 4 * (values.sparse_count + width), where) ||
        !find_keys(g, input, &times, &keys) ||
        !gltf_accessor_read(g, output, &values, keys.before * stride + (is_cubic ? elements : 0), elements, out))
        return false;
    if (!keys.mixed || is_step)
        return true;
    double *next = mem_alloc(3 * width * sizeof *next);
    if (!next)
        return error_no_memory(g->error, g->path);
    /* With tangents: the one after the first key, then the one before the second key and its value. */
    uint64_t from = (keys.before + 1) * stride - (is_cubic ? elements : 0);
    bool ok = gltf_accessor_read(g, output, &values, from, is_cubic ? 3 * elements : elements, next);
    if (ok && is_cubic)
        cubic(out, next, next + 2 * width, next + width, &keys, width);
    else if (ok && path == GLTF_ROTATION)
        slerp(out, next, keys.at);
    else
        for (size_t i = 0; ok && i < width; i++)
            out[i] += keys.at * (next[i] - out[i]);
    mem_free(next);
    return ok;
}

#else
/* This file is empty without jansson. */
typedef int gltf_animation_is_empty;
#endif
