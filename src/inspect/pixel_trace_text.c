/* The trace of a pixel in words. A ray is a paragraph, indented below the surface that it starts from; the last line of
 * each is its light. Numbers have six digits, for reading; --json prints all digits. */
#include "image/png_write.h"
#include "inspect/inspect.h"
#include "light/light_edit.h"
#include "world/world_describe.h"

#include <math.h>

struct text_state {
    const struct trace_report *report;
    struct text_writer *writer;
    int depth;
    bool changed; /* for the link that is printed */
};

/* The blanks before a line about a ray. */
static int deep(const struct text_state *t) {
    int width = 2 * (t->depth + 1);
    return width < 200 ? width : 200;
}

static bool same(struct vec3 a, struct vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_colour(struct colour a, struct colour b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

static void changed_triple(struct text_state *t, const char *name, struct vec3 now, struct vec3 before) {
    if (same(now, before))
        return;
    t->changed = true;
    text_writer_put(t->writer, " %s %v", name, now);
}

static void changed_colour(struct text_state *t, const char *name, struct colour now, struct colour before) {
    if (same_colour(now, before))
        return;
    t->changed = true;
    text_writer_put(t->writer, " %s %c", name, now);
}

static void changed_number(struct text_state *t, const char *name, double now, double before) {
    if (now == before)
        return;
    t->changed = true;
    text_writer_print(t->writer, " %s %.6g", name, now);
}

static void changed_flag(struct text_state *t, const char *name, bool now, bool before) {
    if (now == before)
        return;
    t->changed = true;
    text_writer_print(t->writer, now ? " %s" : " not %s", name);
}

/* One link: its effect. */
static void print_link(struct text_state *t, const struct pixel_trace_link *link, const struct surface_inputs *before) {
    const struct surface_inputs *inputs = &link->inputs;
    const char *name = link->material->name ? link->material->name : "";
    text_writer_put(t->writer, name[0] ? "%i%s '%n':" : "%i%s:", deep(t), material_step_name(link->material), name);
    t->changed = false;
    changed_colour(t, "kd", inputs->kd, before->kd);
    changed_colour(t, "ks", inputs->ks, before->ks);
    changed_number(t, "shininess", inputs->shininess, before->shininess);
    changed_number(t, "reflect", inputs->reflect, before->reflect);
    changed_number(t, "refract", inputs->refract, before->refract);
    changed_number(t, "ior", inputs->ior, before->ior);
    changed_number(t, "roughness", inputs->roughness, before->roughness);
    changed_number(t, "opacity", inputs->opacity, before->opacity);
    changed_colour(t, "emission", inputs->emission, before->emission);
    changed_colour(t, "absorption", inputs->absorption, before->absorption);
    changed_triple(t, "normal", inputs->normal, before->normal);
    changed_flag(t, "two-sided", inputs->two_sided, before->two_sided);
    changed_flag(t, "unlit", inputs->unlit, before->unlit);
    changed_flag(t, "fresnel", inputs->fresnel, before->fresnel);
    text_writer_print(t->writer, !t->changed ? " changes nothing here\n" : "\n");
}

static void print_shading(const struct text_state *t, const struct pixel_trace_ray *ray) {
    text_writer_put(t->writer, "%ishading:", deep(t));
    for (int i = 0; i < ray->bsdf.count; i++) {
        const struct lobe *lobe = &ray->bsdf.lobes[i];
        text_writer_put(t->writer, "%s %s %c", i > 0 ? "," : "", lobe_name(lobe->kind), lobe->weight);
        if (lobe_flags(lobe->kind) & BSDF_EXPONENT)
            text_writer_put(t->writer, "^%g", lobe->exponent);
    }
    text_writer_put(t->writer, ray->bsdf.count == 0 ? " none" : "");
    text_writer_put(t->writer, ray->bsdf.alpha > 0 ? ", rough (alpha %g)" : "", ray->bsdf.alpha);
    text_writer_put(t->writer, "; normal %v%s\n", ray->bsdf.lit,
                    ray->bsdf.dark ? "; seen from behind, where no light counts" : "");
    if (ray->bsdf.fresnel >= 0)
        text_writer_put(t->writer, "%ifresnel: %g is reflected, %g refracted, index before / behind %g%s\n", deep(t),
                        ray->bsdf.fresnel, 1 - ray->bsdf.fresnel, ray->bsdf.eta,
                        ray->bsdf.transmits ? "" : ": total reflection");
    else if (!ray->bsdf.transmits && ray->bsdf.eta != 1)
        text_writer_put(t->writer, "%itotal internal reflection: nothing is refracted\n", deep(t));
}

/* Lights of a path may also be emissive surfaces, and the background. */
static void print_light_name(const struct text_state *t, const struct pixel_trace_light *light) {
    text_writer_put(t->writer, "%i", deep(t));
    if (light->primitive != OBSERVER_NO_BLOCKER) {
        text_writer_put(t->writer, "light of %n", trace_path(t->report, light->primitive));
        return;
    }
    if (light->number >= t->report->picture->job->world->light_count) {
        text_writer_put(t->writer, "light of the background");
        return;
    }
    text_writer_put(t->writer, "light %u, %s", light->number + 1, light_kind_name(light->light->kind));
    unsigned has = light_properties(light->light);
    if (has & LIGHT_HAS_POSITION)
        text_writer_put(t->writer, " at %v", light->light->position);
    else if (has & LIGHT_HAS_DIRECTION)
        text_writer_put(t->writer, " along %v", light->light->direction);
    text_writer_put(t->writer, " of %c", light->light->colour);
}

static void print_light(const struct text_state *t, const struct pixel_trace_light *light) {
    print_light_name(t, light);
    switch (light->lit) {
    case PIXEL_TRACE_LIGHT_NOT_OURS:
        text_writer_put(t->writer, ": does not light this\n");
        return;
    case PIXEL_TRACE_LIGHT_NO_EFFECT:
        text_writer_put(t->writer, ": the surface reflects none of it to the viewer\n");
        return;
    case PIXEL_TRACE_LIGHT_REACHES:
    case PIXEL_TRACE_LIGHT_BLOCKED:
        break;
    }
    bool is_shaded_once = !light->area_light && light->distance > 0;
    if (is_shaded_once && light->distance < INFINITY)
        text_writer_put(t->writer, ": distance %g, falloff %g", light->distance, light->strength);
    if (is_shaded_once)
        text_writer_put(t->writer, ", reflected by %c", light->reflected);
    if (light->has_blocker)
        text_writer_put(t->writer, ", blocked by %n", trace_path(t->report, light->blocker));
    else if (light->asked == 1)
        text_writer_put(t->writer, light->arrived ? ", seen" : ", blocked");
    else
        text_writer_put(t->writer, ", %u of %u shadow rays arrive", light->arrived, light->asked);
    text_writer_put(t->writer, ": %c\n", light->colour);
}

static void print_hit(const struct text_state *t, const struct pixel_trace_ray *ray) {
    const struct world *world = t->report->picture->job->world;
    const struct hit *hit = &ray->hit;
    const struct geometry *geometry = primitive_geometry(world, hit->primitive);
    double u, v;
    text_writer_put(t->writer, "%imeets %n, %s", deep(t), trace_path(t->report, hit->primitive),
                    geometry_kind_name(geometry));
    if (geometry->csg)
        text_writer_put(t->writer, ", operand %u of %u, %s", hit->leaf + 1, geometry->csg->leaf_count,
                        shape_kind_name(geometry_shape(geometry, hit->leaf)->kind));
    text_writer_put(t->writer, ", part %u, from %s, at distance %g\n", hit->part, hit->front ? "outside" : "inside",
                    ray->distance);
    text_writer_put(t->writer, "%ipoint %v, normal %v", deep(t), hit->point, hit->normal_geometric);
    if (!same(hit->normal, hit->normal_geometric))
        text_writer_put(t->writer, ", interpolated %v", hit->normal);
    if (world_native_uv(world, hit, &u, &v))
        text_writer_put(t->writer, ", uv (%g, %g)", u, v);
    text_writer_put(t->writer, ", material %u of %u\n", world->material_numbers[hit->material] + 1,
                    world->material_number_count);
}

static void print_ray(struct text_state *t, const struct pixel_trace_ray *ray);

static void print_terms(struct text_state *t, const struct pixel_trace_ray *ray) {
    struct colour emission = ray->is_vertex ? ray->vertex.emission : ray->bsdf.emission;
    if (!ray->is_vertex)
        text_writer_put(t->writer, "%iambient %c times %c: %c\n", deep(t), ray->ambient_light, ray->bsdf.ambient,
                        ray->ambient);
    for (const struct pixel_trace_light *light = ray->lights; light; light = light->next)
        print_light(t, light);
    if (ray->has_photons)
        text_writer_put(t->writer, "%icaustics: %c\n", deep(t), ray->photons);
    if (!same_colour(ray->bsdf.emission, colour_all(0)))
        text_writer_put(t->writer,
                        same_colour(ray->bsdf.emission, emission) ? "%iown light: %c\n"
                                                                  : "%iown light: %c, a part of %c\n",
                        deep(t), emission, ray->bsdf.emission);
}

static const char *const path_ends[] = {
    [PATH_GOES_ON] = NULL,
    [PATH_LEAVES_SCENE] = NULL,
    [PATH_SEES_LIGHT] = NULL,
    [PATH_REACHES_MAX_DEPTH] = "it has --max-depth scattering events",
    [PATH_IS_ABSORBED] = "the surface absorbs it",
    [PATH_LOSES_ROULETTE] = "Russian roulette",
    [PATH_IN_TOO_MANY_HOLES] = "it has passed too many holes",
};

static void print_end(const struct text_state *t, const struct pixel_trace_ray *ray) {
    const char *reason = ray->is_vertex ? path_ends[ray->vertex.end] : NULL;
    if (reason)
        text_writer_put(t->writer, "%ithe path ends here: %s\n", deep(t), reason);
}

/* The rays that follow. */
static void print_onward(struct text_state *t, const struct pixel_trace_ray *ray) {
    t->depth++;
    for (const struct pixel_trace_ray *child = ray->first; child; child = child->next)
        print_ray(t, child);
    t->depth--;
    print_end(t, ray);
}

static void print_scattering(struct text_state *t, const struct pixel_trace_ray *ray) {
    text_writer_put(t->writer,
                    "%ithe medium scatters it at distance %g, with probability %g before the end of the ray\n", deep(t),
                    ray->vertex.distance, ray->vertex.chance);
    for (const struct pixel_trace_light *light = ray->lights; light; light = light->next)
        print_light(t, light);
    print_onward(t, ray);
}

/* The terms of the surface's colour, in the order in which they are added. */
static void print_surface(struct text_state *t, const struct pixel_trace_ray *ray) {
    struct surface_inputs nothing = {.opacity = 1, .normal = ray->hit.normal};
    const struct surface_inputs *before = &nothing;
    print_hit(t, ray);
    for (const struct pixel_trace_link *link = ray->links; link; link = link->next) {
        print_link(t, link, before);
        before = &link->inputs;
    }
    if (ray->shaded) {
        print_shading(t, ray);
        print_terms(t, ray);
    }
    print_onward(t, ray);
    if (ray->opacity < 1)
        text_writer_put(t->writer,
                        ray->is_vertex ? "%iopacity %g: the probability of the surface, else the path passes the hole\n"
                                       : "%iopacity %g: the weight of the surface; the rest comes through the hole\n",
                        deep(t), ray->opacity);
}

static void print_met(struct text_state *t, const struct pixel_trace_ray *ray) {
    if (ray->cut == RAY_TOO_WEAK)
        text_writer_put(t->writer, "%ithe hit at distance %g cannot change the pixel (--cutoff)\n", deep(t),
                        ray->distance);
    else if (ray->is_vertex && ray->vertex.in_medium)
        print_scattering(t, ray);
    else if (ray->is_vertex && ray->vertex.end == PATH_SEES_LIGHT)
        text_writer_put(t->writer, "%ihits a visible light at distance %g\n", deep(t), ray->vertex.distance);
    else if (ray->area_light)
        text_writer_put(t->writer, "%ihits a visible %s at distance %g\n", deep(t),
                        light_kind_name(ray->area_light->kind), ray->distance);
    else if (ray->met)
        print_surface(t, ray);
    else
        text_writer_put(t->writer, "%ihits nothing: background, %s\n", deep(t),
                        sky_kind_name(t->report->picture->job->world->sky.kind));
    bool leaves = ray->cut != RAY_TOO_WEAK && !ray->met && !ray->area_light;
    if (leaves && !ray->vertex.in_medium && ray->is_vertex && ray->vertex.end != PATH_SEES_LIGHT && ray->parent)
        text_writer_put(t->writer, "%iits light: %c\n", deep(t), ray->vertex.emission);
}

static void print_ray(struct text_state *t, const struct pixel_trace_ray *ray) {
    struct text_writer *writer = t->writer;
    text_writer_put(writer, "%iray %u, %s", deep(t) - 2, ray->number,
                    ray->kind == RAY_HOLE    ? "through the hole"
                    : ray->kind == RAY_BELOW ? "out from under the surface"
                                             : inspect_ray(ray->kind));
    if (ray->scatterings > 0)
        text_writer_put(writer, " after %u scatterings", (unsigned)ray->scatterings);
    if (ray->parent)
        text_writer_put(writer, ", weight %c", ray->weight);
    if (!ray->begun) {
        text_writer_put(writer, ": not traced, %s\n",
                        ray->cut == RAY_OVER_LIMIT ? "the limit is reached (-reflect-limit, -refract-limit)"
                                                   : "it cannot change the pixel (--cutoff)");
        return;
    }
    text_writer_put(writer, ": from %v along %v", ray->origin, ray->direction);
    text_writer_put(writer, ray->time != 0 ? ", time %g" : "", ray->time);
    if (ray->media_count > 0)
        text_writer_put(writer, ", inside of %u, index %g", ray->media_count, ray->media_ior);
    if (ray->wavelength > 0)
        text_writer_put(writer, ", wavelength %g nm", 1000 * ray->wavelength);
    text_writer_put(writer, "\n");
    print_met(t, ray);
    /* What the way to the hit adds and leaves. */
    bool clear = same_colour(ray->left, colour_all(1)), lit = !same_colour(ray->in_scattered, colour_all(0));
    if (clear && lit && ray->is_vertex)
        text_writer_put(writer, "%ilights on the way add %c\n", deep(t), ray->in_scattered);
    else if (!clear)
        text_writer_put(writer, lit ? "%iof %c the way leaves %c and fog adds %c\n" : "%iof %c the way leaves %c\n",
                        deep(t), ray->seen, ray->left, ray->in_scattered);
    text_writer_put(writer, "%ibrings %c\n", deep(t), ray->brings);
}

static const char *direction(int x, int y) {
    static const char *const names[3][3] = {
        {"upper left", "upper", "upper right"}, {"left", "", "right"}, {"lower left", "lower", "lower right"}};
    return names[1 + y][1 + x];
}

static void print_sample(struct text_state *t, const struct pixel_trace_sample *sample) {
    text_writer_print(t->writer, "\nsample %u at %.6f, %.6f%s\n", (unsigned)sample->number, sample->x, sample->y,
                      sample->counts ? "" : " (only to decide whether the pixel is sampled again)");
    t->depth = 1;
    for (const struct pixel_trace_ray *ray = sample->first; ray; ray = ray->next)
        print_ray(t, ray);
    text_writer_put(t->writer, "  colour %c\n", sample->colour);
}

/* Of two samples the one with more light, or the first one. */
static bool is_before(const struct pixel_trace_sample *a, const struct pixel_trace_sample *b) {
    double of_a = a->colour.r + a->colour.g + a->colour.b, of_b = b->colour.r + b->colour.g + b->colour.b;
    return of_a > of_b || (of_a == of_b && a->number < b->number);
}

/* Of a path-traced pixel: the standard error of its mean, as if the samples were independent, and the brightest paths
 * with their vertices. */
static void print_paths(struct text_state *t) {
    enum { BRIGHTEST = 8 };
    const struct pixel_trace *pixel_trace = t->report->pixel_trace;
    struct colour sum = {0, 0, 0}, squares = {0, 0, 0}, error = {0, 0, 0};
    double count = 0;
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next, count++) {
        sum = colour_add(sum, sample->colour);
        squares = colour_add(squares, colour_mul(sample->colour, sample->colour));
    }
    if (count > 1) {
        struct colour mean = colour_scale(sum, 1 / count);
        struct colour variance =
            colour_max(colour_sub(colour_scale(squares, 1 / count), colour_mul(mean, mean)), colour_all(0));
        error = colour_scale(variance, 1 / (count - 1));
        error = colour_make(sqrt(error.r), sqrt(error.g), sqrt(error.b));
    }
    const struct settings *settings = &t->report->picture->job->settings;
    text_writer_put(t->writer, "mean %c, standard error %c, of %u samples%s; the brightest paths:\n",
                    colour_make((double)pixel_trace->rgb[0], (double)pixel_trace->rgb[1], (double)pixel_trace->rgb[2]),
                    error, (unsigned)count,
                    settings->noise > 0        ? " (--spp; --noise may need fewer)"
                    : settings->time_limit > 0 ? " (--spp, without --time-limit)"
                                               : "");
    /* The next one after the last that was printed: no list is sorted. */
    const struct pixel_trace_sample *last = NULL;
    for (int i = 0; i < BRIGHTEST; i++) {
        const struct pixel_trace_sample *next = NULL;
        for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next)
            if ((!last || is_before(last, sample)) && (!next || is_before(sample, next)))
                next = sample;
        if (!next)
            break;
        print_sample(t, next);
        last = next;
    }
}

/* Why the pixel has N x N samples. */
static void print_mark(struct text_writer *writer, const struct pixel_trace *pixel_trace) {
    const char *neighbour = direction(pixel_trace->mark.x, pixel_trace->mark.y);
    double distance = pixel_trace->mark.distance, tolerance = pixel_trace->mark.tolerance;
    text_writer_print(writer, "%d x %d samples: ", pixel_trace->samples, pixel_trace->samples);
    switch (pixel_trace->mark.reason) {
    case MARK_COLOUR:
        text_writer_print(writer, "the first one differs from the %s neighbour's by %.6g > %g\n", neighbour, distance,
                          tolerance);
        break;
    case MARK_SURFACE:
        text_writer_print(writer, "the first one differs from the %s neighbour's, on another surface, by %.6g > %g\n",
                          neighbour, distance, tolerance);
        break;
    case MARK_DETAIL:
        text_writer_print(writer,
                          "the first one differs from the mean of the %s and the opposite neighbour's by %.6g > %g\n",
                          neighbour, distance, tolerance);
        break;
    case MARK_THIN:
        text_writer_print(writer, "a primitive that is narrower than a pixel may be in it\n");
        break;
    }
}

static void print_samples(struct text_state *t) {
    const struct pixel_trace *pixel_trace = t->report->pixel_trace;
    text_writer_print(t->writer, "%s",
                      pixel_trace->marked ? "" : "one sample: no neighbour differs by more than the tolerances\n");
    if (pixel_trace->marked && pixel_trace->full)
        text_writer_print(t->writer, "%d x %d samples, as all pixels have (-full, a lens or motion)\n",
                          pixel_trace->samples, pixel_trace->samples);
    else if (pixel_trace->marked)
        print_mark(t->writer, pixel_trace);
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next)
        print_sample(t, sample);
    if (pixel_trace->omitted > 0)
        text_writer_print(t->writer, "\n%u more rays are not shown\n", pixel_trace->omitted);
}

/* The sum that gives the colour, and its value in the file. */
static void print_sum(struct text_state *t) {
    const struct pixel_trace *pixel_trace = t->report->pixel_trace;
    const struct settings *settings = &t->report->picture->job->settings;
    const struct tone *tone = &settings->tone;
    static const char *const curves[] = {TONE_CURVES(LIST_WORD)[TONE_FUNCTION] = "function"};
    unsigned count = 0;
    double toned[3];
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next)
        count += sample->counts;
    text_writer_print(t->writer, "\nthe mean of %u sample%s, in single precision: (%.9g, %.9g, %.9g)\n", count,
                      count == 1 ? "" : "s", (double)pixel_trace->rgb[0], (double)pixel_trace->rgb[1],
                      (double)pixel_trace->rgb[2]);
    for (int c = 0; c < 3; c++)
        toned[c] = tone_apply(tone, (double)pixel_trace->rgb[c]);
    if (!tone_is_plain(tone))
        text_writer_print(t->writer, "exposure %g, tone %s%s: (%.9g, %.9g, %.9g)\n", tone->exposure,
                          curves[tone->curve], tone->srgb ? ", sRGB" : "", toned[0], toned[1], toned[2]);
    if (settings->deep)
        text_writer_print(t->writer, "times 65535, rounded: %u %u %u\n", tone_word(toned[0]), tone_word(toned[1]),
                          tone_word(toned[2]));
    else
        text_writer_print(t->writer, "times 255, rounded: %u %u %u\n", png_write_byte(toned[0]),
                          png_write_byte(toned[1]), png_write_byte(toned[2]));
}

void pixel_trace_print(const struct trace_report *report, struct text_writer *writer) {
    struct text_state t = {.report = report, .writer = writer};
    const struct render_job *job = report->picture->job;
    text_writer_put(writer, "%n, pixel %u,%u of %u x %u: ", report->picture->file, report->pixel_trace->x,
                    report->pixel_trace->y, job->width, job->height);
    if (integrator_traits(job->settings.integrator).progressive)
        print_paths(&t);
    else
        print_samples(&t);
    print_sum(&t);
}
