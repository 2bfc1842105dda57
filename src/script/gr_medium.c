/* See gr_medium_internal.h. Media: what absorbs, scatters and emits light, and its density by place. */
#include "script/gr_medium_internal.h"

#include "call/context.h"
#include "formats/voxels.h"
#include "material/density.h"
#include "material/glow.h"
#include "material/medium.h"
#include "math/spectrum.h"
#include "record/record_bounds.h"
#include "script/rows_internal.h"

#include <float.h>

enum {
    MEDIUM_ABSORPTION,
    MEDIUM_SCATTERING,
    MEDIUM_ALBEDO,
    MEDIUM_DISTANCE,
    MEDIUM_EMISSION,
    MEDIUM_TEMPERATURE,
    MEDIUM_G,
    MEDIUM_PHASE,
    MEDIUM_DENSITY,
    MEDIUM_BOUND,
    MEDIUM_CORNER,
    MEDIUM_SIZE,
    MEDIUM_TOP,
    MEDIUM_CELLS,
    MEDIUM_TYPE,
};
static const struct script_parameter medium_parameters[] = {
    [MEDIUM_ABSORPTION] = {"absorption", KIND_COLOUR, OPTIONAL, ABOVE(0), NULL, "{0, 0, 0}",
                           "Light absorbed, per unit of length."},
    [MEDIUM_SCATTERING] = {"scattering", KIND_COLOUR, OPTIONAL, ABOVE(0), NULL, "{0, 0, 0}",
                           "Light scattered, per unit of length."},
    [MEDIUM_ALBEDO] = {"albedo", KIND_COLOUR, OPTIONAL, IN_RANGE(0, 1), NULL, "{1, 1, 1}",
                       "With distance, instead of absorption and scattering: the share that is scattered."},
    [MEDIUM_DISTANCE] = {"distance", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1",
                         "The mean free path: what light travels between two events, on average."},
    [MEDIUM_EMISSION] = {"emission", KIND_COLOUR, OPTIONAL, ABOVE(0), NULL, "{0, 0, 0}",
                         "Light that the medium adds, per unit of length."},
    [MEDIUM_TEMPERATURE] = {"temperature", KIND_NUMBERS, OPTIONAL | OR_FUNCTION | OR_FILE, ABOVE(0), "kelvin", NULL,
                            "The medium glows as a black body, with emission as a factor, {1, 1, 1} by default: a "
                            "number, a function or a grid, as density."},
    [MEDIUM_G] = {"g", KIND_NUMBER, OPTIONAL | LOW_OPEN | HIGH_OPEN, IN_RANGE(-1, 1), NULL, "0",
                  "Mean cosine of the deflection (Henyey and Greenstein): 0 in all directions alike, near 1 forward."},
    [MEDIUM_PHASE] = {"phase", KIND_CHOICE, OPTIONAL, 0, 0, "rayleigh", NULL, NULL,
                      "Rayleigh's phase function, of very small particles, instead of g."},
    [MEDIUM_DENSITY] = {"density", KIND_NUMBERS, OPTIONAL | OR_FUNCTION | OR_FILE, ABOVE(0), NULL, "1",
                        "The factor of absorption, scattering and emission: a number, a function f(p, s) of the point "
                        "and s.time, or a grid: numbers, or the name of an NRRD file or of a file of plain values."},
    [MEDIUM_BOUND] = {"bound", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "found by gray",
                      "A bound of a density function; where the function is larger, it counts as the bound."},
    [MEDIUM_CORNER] = {"corner", KIND_POINT, OPTIONAL, ANY, NULL, NULL,
                       "With size, the box of the medium or of its grid: the corner with the smallest coordinates."},
    [MEDIUM_SIZE] = {"size", KIND_SIZE, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, NULL,
                     "Length of the edges of that box, one number or three."},
    [MEDIUM_TOP] = {"top", KIND_NUMBER, OPTIONAL, ANY, NULL, "none", "The medium ends at this height y."},
    [MEDIUM_CELLS] = {"cells", KIND_TRIPLE, OPTIONAL, 1, VOXELS_LIMIT, NULL, NULL, NULL,
                      "Of a grid of numbers or plain values: how many there are along x, y and z; x varies fastest."},
    [MEDIUM_TYPE] = {"type", KIND_CHOICE, OPTIONAL, 0, 0, "float double uint8 int16 uint16", NULL, "'float'",
                     "Type of the values of a plain file, little-endian."},
};

/* The material of solids that it fills: their surface is a hole everywhere. */
static struct material *keep_medium(struct script_context *context, const struct medium *medium, struct error *error) {
    struct arena *arena = &context->scene.arena;
    struct material *material = scene_material(&context->scene, MATERIAL_PHONG, NULL, error);
    struct medium *kept = arena_alloc(arena, sizeof *kept);
    if (!material || !kept) {
        error_no_memory(error, "a medium");
        return NULL;
    }
    *kept = *medium;
    material->medium = kept;
    material->inputs[INPUT_OPACITY] = texture_keep(arena, texture_number(0), error);
    return material->inputs[INPUT_OPACITY] ? material : NULL;
}

/* A copy of the material with the medium behind its surface. */
static const struct material *put_behind(struct script_context *context, const struct material *material,
                                         const struct medium *medium, struct error *error) {
    struct medium *kept = arena_alloc(&context->scene.arena, sizeof *kept);
    struct material *copy = scene_material(&context->scene, material->kind, material, error);
    if (!kept || !copy) {
        error_no_memory(error, "a medium");
        return NULL;
    }
    *kept = *medium;
    kept->fills = false;
    copy->base = material->base;
    copy->origin = material->origin;
    copy->depth = material->depth;
    copy->name = material->name;
    copy->medium = kept;
    return copy;
}

bool choose_material(struct script_context *context, const struct script_value *material,
                     const struct script_value *medium, const struct material **out, struct error *error) {
    *out = medium->given ? medium->material : material->material;
    if (medium->given && material->given)
        *out = put_behind(context, material->material, medium->material->medium, error);
    return *out || !(medium->given && material->given);
}

/* --- density --- */

/* The box of corner and size, and below the top. False: only one of them is given. */
static bool read_box(const struct script_value *args, struct box *box, struct error *error) {
    *box = (struct box){vec3_all(-INFINITY), vec3_all(INFINITY)};
    if (args[MEDIUM_CORNER].given != args[MEDIUM_SIZE].given)
        return error_set(error, ERROR_SCENE, "corner and size belong together; %s is missing",
                         args[MEDIUM_CORNER].given ? "size" : "corner");
    if (args[MEDIUM_CORNER].given) {
        box->min = args[MEDIUM_CORNER].vector;
        box->max = vec3_add(box->min, args[MEDIUM_SIZE].vector);
    }
    if (args[MEDIUM_TOP].given && !(args[MEDIUM_TOP].number > box->min.y))
        return error_set(error, ERROR_SCENE, "top is below the box, so nothing is left of the medium");
    box->max.y = args[MEDIUM_TOP].given ? math_min(box->max.y, args[MEDIUM_TOP].number) : box->max.y;
    return true;
}

static bool read_cells(const struct script_value *args, const char *name, struct voxels *out, struct error *error) {
    if (!args[MEDIUM_CELLS].given)
        return error_set(error, ERROR_SCENE, "cells is missing: how many values the %s has along x, y and z", name);
    for (int axis = 0; axis < 3; axis++) {
        double n = vec3_get(args[MEDIUM_CELLS].vector, axis);
        if (n != (double)(uint32_t)n)
            return error_set(error, ERROR_SCENE, "cells[%d] must be a whole number", axis + 1);
        out->count[axis] = (uint32_t)n;
    }
    return true;
}

/* What is given by place: the density or the temperature. */
struct field {
    const struct script_value *value;
    const char *name;
    double bound; /* of a function */
};

static bool is_grid(const struct script_value *value) {
    return value->text || (value->given && !value->program && !value->single);
}

/* The numbers of a table. */
static bool read_numbers(struct script_context *context, const struct script_value *args, const struct field *field,
                         struct voxels *out, struct error *error) {
    const struct script_value *numbers = field->value;
    if (!read_cells(args, field->name, out, error))
        return false;
    uint64_t count = (uint64_t)out->count[0] * out->count[1] * out->count[2];
    if (numbers->count != count)
        return error_set(error, ERROR_SCENE, "%s must have %llu numbers, one for each of the cells, not %u",
                         field->name, (unsigned long long)count, numbers->count);
    float *values = arena_alloc_array(&context->scene.arena, count, sizeof *values);
    if (!values)
        return error_no_memory(error, "a medium");
    for (uint64_t i = 0; i < count; i++) {
        if (!(numbers->numbers[i] <= (double)FLT_MAX))
            return error_set(error, ERROR_SCENE, "%s[%llu] is too large", field->name, (unsigned long long)i + 1);
        values[i] = (float)numbers->numbers[i];
    }
    out->values = values;
    return true;
}

static bool read_file(struct script_context *context, const struct script_value *args, const struct field *field,
                      struct voxels *out, struct error *error) {
    struct arena *arena = &context->scene.arena;
    char path[PATH_SIZE];
    if (!files_require(&context->sandbox, field->value->text, path, error))
        return false;
    if (!args[MEDIUM_CELLS].given && !args[MEDIUM_TYPE].given)
        return voxels_read_nrrd(path, arena, out, error);
    return read_cells(args, field->name, out, error) &&
           voxels_read_raw(path, (enum voxel_type)args[MEDIUM_TYPE].choice, arena, out, error);
}

static const struct density *field_by_function(struct script_context *context, const struct field *field,
                                               const struct box *box, struct error *error) {
    const struct fog_field_input in = {.density = field->value->program,
                                       .source = field->value->source,
                                       .name = field->name,
                                       .corner = box->min,
                                       .size = vec3_sub(box->max, box->min)};
    record_use(&context->sandbox, in.density, box);
    return density_of_function(&context->scene.arena, &(struct density_function){&in, field->bound, 1}, error);
}

/* *out: NULL where it is the same everywhere in the box. */
static bool read_field(struct script_context *context, const struct script_value *args, const struct field *field,
                       const struct box *box, const struct density **out, struct error *error) {
    bool fits = !args[MEDIUM_CORNER].given;
    struct voxels voxels;
    *out = NULL;
    if (field->value->program && fits)
        return error_set(error, ERROR_SCENE, "corner and size are missing: the box in which the %s is a function",
                         field->name);
    if (field->value->program)
        return (*out = field_by_function(context, field, box, error)) != NULL;
    if (!is_grid(field->value))
        return true;
    if (args[MEDIUM_TOP].given)
        return error_set(error, ERROR_SCENE, "a grid ends at its box; top is for other densities");
    if (!(field->value->text ? read_file(context, args, field, &voxels, error)
                             : read_numbers(context, args, field, &voxels, error)))
        return false;
    const struct density_grid grid = {fits ? (struct box){{0, 0, 0}, {1, 1, 1}} : *box,
                                      {voxels.count[0], voxels.count[1], voxels.count[2]},
                                      voxels.values,
                                      1,
                                      fits};
    return (*out = density_of_grid(&context->scene.arena, &grid, error)) != NULL;
}

/* Temperatures above this count as this. */
static const double hottest = 1e5;

static bool read_fields(struct script_context *context, const struct script_value *args, struct medium_input *in,
                        struct error *error) {
    struct arena *arena = &context->scene.arena;
    const struct script_value *density = &args[MEDIUM_DENSITY], *temperature = &args[MEDIUM_TEMPERATURE];
    const double bound = args[MEDIUM_BOUND].given ? args[MEDIUM_BOUND].number : INFINITY;
    const struct density *kelvin;
    struct box box;
    if (args[MEDIUM_BOUND].given && !density->program)
        return error_set(error, ERROR_SCENE, "bound is for a density that is a function");
    if (args[MEDIUM_CELLS].given && !is_grid(density) && !is_grid(temperature))
        return error_set(error, ERROR_SCENE, "cells is for a density or a temperature that is a grid");
    if (!read_box(args, &box, error) ||
        !read_field(context, args, &(struct field){density, "density", bound}, &box, &in->density, error) ||
        !read_field(context, args, &(struct field){temperature, "temperature", hottest}, &box, &kelvin, error))
        return false;
    if (kelvin && !(in->heat = heat_make(arena, kelvin, error)))
        return false;
    if (in->density || (!kelvin && !args[MEDIUM_CORNER].given && !args[MEDIUM_TOP].given))
        return true;
    return (in->density = density_of_box(arena, &box, error)) != NULL;
}

/* --- the medium --- */

static bool read_coefficients(const struct script_value *args, struct medium_input *in, struct error *error) {
    bool by_distance = args[MEDIUM_ALBEDO].given || args[MEDIUM_DISTANCE].given;
    if (by_distance && (args[MEDIUM_ABSORPTION].given || args[MEDIUM_SCATTERING].given))
        return error_set(error, ERROR_SCENE, "give absorption and scattering, or albedo and distance, not both");
    in->absorption = args[MEDIUM_ABSORPTION].colour;
    in->scattering = args[MEDIUM_SCATTERING].colour;
    in->emission = args[MEDIUM_EMISSION].colour;
    if (by_distance) {
        double events = args[MEDIUM_DISTANCE].given ? 1 / args[MEDIUM_DISTANCE].number : 1;
        in->scattering = colour_scale(args[MEDIUM_ALBEDO].given ? args[MEDIUM_ALBEDO].colour : colour_all(1), events);
        in->absorption = colour_sub(colour_all(events), in->scattering);
    }
    const struct script_value *temperature = &args[MEDIUM_TEMPERATURE];
    if (temperature->single && !(temperature->numbers[0] > 0))
        return error_set(error, ERROR_SCENE, "temperature must be > 0");
    if (temperature->given)
        in->emission = colour_mul(args[MEDIUM_EMISSION].given ? in->emission : colour_all(1), in->absorption);
    if (temperature->single)
        in->emission = colour_mul(in->emission, spectrum_black_body(temperature->numbers[0]));
    if (args[MEDIUM_DENSITY].single) {
        double factor = args[MEDIUM_DENSITY].numbers[0];
        in->absorption = colour_scale(in->absorption, factor);
        in->scattering = colour_scale(in->scattering, factor);
        in->emission = colour_scale(in->emission, factor);
    }
    return true;
}

static bool gr_medium(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    struct medium_input in = {.phase = {PHASE_HENYEY_GREENSTEIN, args[MEDIUM_G].number}};
    if (!read_coefficients(args, &in, error))
        return false;
    if (args[MEDIUM_PHASE].given && args[MEDIUM_G].given)
        return error_set(error, ERROR_SCENE, "phase = 'rayleigh' has no g; give one of them");
    if (args[MEDIUM_PHASE].given)
        in.phase = (struct phase){PHASE_RAYLEIGH, 0};
    if (!read_fields(context, args, &in, error))
        return false;
    struct medium medium = medium_filling(&in);
    if (!colour_finite(medium.extinction) || !colour_finite(medium.emission))
        return error_set(error, ERROR_SCENE, "absorption, scattering, emission and density are too large together");
    result->pointer = keep_medium(context, &medium, error);
    return result->pointer;
}

static const struct script_function medium_rows[] = {
    GR("medium", medium_parameters, RESULT_MEDIUM, gr_medium, "A medium that absorbs, scatters and emits light.",
       "scattering absorption?"),
};
const struct function_rows medium_functions = {medium_rows, COUNT(medium_rows)};
