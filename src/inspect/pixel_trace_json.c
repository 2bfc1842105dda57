/* The trace of a pixel as one JSON object on one line; docs/pixel.md describes its fields. All numbers are exact. */
#include "image/png_write.h"
#include "inspect/inspect.h"
#include "light/light_edit.h"
#include "world/world_describe.h"

static void json_link(struct text_writer *writer, const struct pixel_trace_link *link) {
    const struct surface_inputs *inputs = &link->inputs;
    text_writer_put(writer, "{\"kind\":\"%s\"", material_step_name(link->material));
    if (link->material->name && link->material->name[0])
        text_writer_put(writer, ",\"name\":%q", link->material->name);
    text_writer_put(writer, ",\"kd\":%r,\"ks\":%r,\"shininess\":%j,\"reflect\":%j,\"refract\":%j,\"ior\":%j",
                    inputs->kd, inputs->ks, inputs->shininess, inputs->reflect, inputs->refract, inputs->ior);
    text_writer_put(writer, ",\"roughness\":%j,\"opacity\":%j,\"emission\":%r,\"absorption\":%r,\"normal\":%a",
                    inputs->roughness, inputs->opacity, inputs->emission, inputs->absorption, inputs->normal);
    text_writer_put(writer, ",\"two_sided\":%b,\"unlit\":%b,\"fresnel\":%b}", inputs->two_sided, inputs->unlit,
                    inputs->fresnel);
}

static void json_lobes(struct text_writer *writer, const struct bsdf *bsdf) {
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        bool has_exponent = lobe_flags(lobe->kind) & BSDF_EXPONENT;
        text_writer_put(writer, "%s{\"kind\":\"%s\",\"weight\":%r", i > 0 ? "," : "", lobe_name(lobe->kind),
                        lobe->weight);
        text_writer_put(writer, has_exponent ? ",\"exponent\":%j}" : "}", lobe->exponent);
    }
}

static void json_light(const struct trace_report *report, struct text_writer *writer,
                       const struct pixel_trace_light *light) {
    static const char *const lit[] = {
        [PIXEL_TRACE_LIGHT_REACHES] = "reaches",
        [PIXEL_TRACE_LIGHT_BLOCKED] = "blocked",
        [PIXEL_TRACE_LIGHT_NOT_OURS] = "excluded",
        [PIXEL_TRACE_LIGHT_NO_EFFECT] = "no effect",
    };
    text_writer_put(writer, "{\"light\":%u,\"kind\":\"%s\",\"lit\":\"%s\"", light->number + 1,
                    light_kind_name(light->light->kind), lit[light->lit]);
    if (light->primitive != OBSERVER_NO_BLOCKER)
        text_writer_put(writer, ",\"emitter\":%q", trace_path(report, light->primitive));
    text_writer_put(writer, ",\"of\":%r", light->light->colour);
    if (!light->area_light && light->lit != PIXEL_TRACE_LIGHT_NOT_OURS && light->distance > 0)
        text_writer_put(writer, ",\"distance\":%j,\"strength\":%j,\"to_light\":%a,\"reflected\":%r", light->distance,
                        light->strength, light->to_light, light->reflected);
    text_writer_put(writer, ",\"shadow_rays\":%u,\"arrived\":%u", light->asked, light->arrived);
    if (light->has_blocker)
        text_writer_put(writer, ",\"blocked_by\":%q", trace_path(report, light->blocker));
    text_writer_put(writer, ",\"colour\":%r}", light->colour);
}

static void json_shading(const struct trace_report *report, struct text_writer *writer,
                         const struct pixel_trace_ray *ray) {
    text_writer_put(writer, ",\"lit_normal\":%a,\"dark_side\":%b,\"passes\":%b,\"index\":%j", ray->bsdf.lit,
                    ray->bsdf.dark, ray->bsdf.transmits, ray->bsdf.eta);
    text_writer_put(writer, ray->bsdf.fresnel >= 0 ? ",\"fresnel\":%j" : "", ray->bsdf.fresnel);
    text_writer_put(writer, ",\"lobes\":[");
    json_lobes(writer, &ray->bsdf);
    text_writer_put(writer, "],\"alpha\":%j,\"ambient\":%r,\"lights\":[", ray->bsdf.alpha, ray->ambient);
    for (const struct pixel_trace_light *light = ray->lights; light; light = light->next) {
        json_light(report, writer, light);
        text_writer_put(writer, light->next ? "," : "");
    }
    text_writer_put(writer, "],\"caustics\":%r,\"direct\":%r,\"emission\":%r", ray->photons, ray->direct,
                    ray->is_vertex ? ray->vertex.emission : ray->bsdf.emission);
}

static void json_hit(const struct trace_report *report, struct text_writer *writer, const struct pixel_trace_ray *ray) {
    const struct world *world = report->picture->job->world;
    const struct hit *hit = &ray->hit;
    const struct geometry *geometry = primitive_geometry(world, hit->primitive);
    double u, v;
    text_writer_put(writer, ",\"node\":%q,\"node_number\":%u,\"placed\":%u,\"shape\":\"%s\"",
                    trace_path(report, hit->primitive), primitive_node(world, hit->primitive)->serial, hit->primitive,
                    geometry_kind_name(geometry));
    if (geometry->csg)
        text_writer_put(writer, ",\"operand\":%u,\"operand_shape\":\"%s\"", hit->leaf + 1,
                        shape_kind_name(geometry_shape(geometry, hit->leaf)->kind));
    text_writer_put(writer, ",\"part\":%u,\"t\":%j,\"front\":%b,\"point\":%a,\"geometric_normal\":%a,\"normal\":%a",
                    hit->part, hit->t, hit->front, hit->point, hit->normal_geometric, hit->normal);
    if (world_native_uv(world, hit, &u, &v))
        text_writer_put(writer, ",\"uv\":[%j,%j]", u, v);
    text_writer_put(writer, ",\"material\":%u,\"links\":[", world->material_numbers[hit->material] + 1);
    for (const struct pixel_trace_link *link = ray->links; link; link = link->next) {
        json_link(writer, link);
        text_writer_put(writer, link->next ? "," : "");
    }
    text_writer_put(writer, "],\"opacity\":%j,\"shaded\":%b", ray->opacity, ray->shaded);
    if (ray->shaded)
        json_shading(report, writer, ray);
}

static void json_rays(const struct trace_report *report, struct text_writer *writer, const struct pixel_trace_ray *ray);

static void json_ray(const struct trace_report *report, struct text_writer *writer, const struct pixel_trace_ray *ray) {
    static const char *const ends[] = {
        [PATH_GOES_ON] = "goes on",         [PATH_LEAVES_SCENE] = "background", [PATH_SEES_LIGHT] = "light",
        [PATH_REACHES_MAX_DEPTH] = "depth", [PATH_IS_ABSORBED] = "absorbed",    [PATH_LOSES_ROULETTE] = "roulette",
        [PATH_IN_TOO_MANY_HOLES] = "holes",
    };
    static const char *const cut[] = {[RAY_FOLLOWED] = "no", [RAY_OVER_LIMIT] = "limit", [RAY_TOO_WEAK] = "cutoff"};
    /* The ray. */
    text_writer_put(writer, "{\"ray\":%u,\"kind\":\"%s\",\"cut\":\"%s\",\"weight\":%r,\"begun\":%b", ray->number,
                    inspect_ray(ray->kind), cut[ray->cut], ray->weight, ray->begun);
    if (ray->begun) {
        text_writer_put(writer,
                        ",\"origin\":%a,\"direction\":%a,\"time\":%j,\"share\":%j,\"media\":%u,\"media_ior\":%j",
                        ray->origin, ray->direction, ray->time, ray->share, ray->media_count, ray->media_ior);
        if (ray->wavelength > 0)
            text_writer_put(writer, ",\"wavelength\":%j", ray->wavelength);
        if (ray->kind == RAY_BELOW)
            text_writer_put(writer, ",\"scatterings\":%u", (unsigned)ray->scatterings);
        /* What it meets. */
        bool in_medium = ray->is_vertex && ray->vertex.in_medium;
        text_writer_put(writer, ",\"distance\":%j,\"meets\":\"%s\"", in_medium ? ray->vertex.distance : ray->distance,
                        in_medium         ? "medium"
                        : ray->met        ? "surface"
                        : ray->area_light ? "light"
                                          : "background");
        if (in_medium)
            text_writer_put(writer, ",\"probability\":%j", ray->vertex.chance);
        if (ray->met && !in_medium)
            json_hit(report, writer, ray);
        else if (ray->is_vertex)
            text_writer_put(writer, ",\"emission\":%r", ray->vertex.emission);
        if (ray->is_vertex)
            text_writer_put(writer, ",\"path\":\"%s\"", ends[ray->vertex.end]);
        /* The rays that follow, and the light. */
        text_writer_put(writer, ",\"rays\":[");
        json_rays(report, writer, ray->first);
        text_writer_put(writer, "],\"seen\":%r,\"left\":%r,\"fog\":%r,\"brings\":%r", ray->seen, ray->left,
                        ray->in_scattered, ray->brings);
    }
    text_writer_put(writer, "}");
}

static void json_rays(const struct trace_report *report, struct text_writer *writer,
                      const struct pixel_trace_ray *ray) {
    for (; ray; ray = ray->next) {
        json_ray(report, writer, ray);
        text_writer_put(writer, ray->next ? "," : "");
    }
}

static void json_sum(const struct trace_report *report, struct text_writer *writer) {
    const struct settings *settings = &report->picture->job->settings;
    const float *rgb = report->pixel_trace->rgb;
    double toned[3];
    for (int c = 0; c < 3; c++)
        toned[c] = tone_apply(&settings->tone, (double)rgb[c]);
    text_writer_put(writer, ",\"film\":%r,\"exposure\":%j,\"tone\":%d,\"srgb\":%b,\"toned\":%r",
                    colour_make((double)rgb[0], (double)rgb[1], (double)rgb[2]), settings->tone.exposure,
                    (int)settings->tone.curve, settings->tone.srgb, colour_make(toned[0], toned[1], toned[2]));
    text_writer_put(writer, ",\"bytes\":[%u,%u,%u]", png_write_byte(toned[0]), png_write_byte(toned[1]),
                    png_write_byte(toned[2]));
    if (settings->deep)
        text_writer_put(writer, ",\"words\":[%u,%u,%u]", tone_word(toned[0]), tone_word(toned[1]), tone_word(toned[2]));
}

void pixel_trace_print_json(const struct trace_report *report, struct text_writer *writer) {
    const struct pixel_trace *pixel_trace = report->pixel_trace;
    const struct render_job *job = report->picture->job;
    text_writer_put(writer, "{\"picture\":%q,\"width\":%u,\"height\":%u,\"x\":%u,\"y\":%u,\"marked\":%b,\"full\":%b",
                    report->picture->file, job->width, job->height, pixel_trace->x, pixel_trace->y, pixel_trace->marked,
                    pixel_trace->full);
    if (pixel_trace->marked && !pixel_trace->full && pixel_trace->mark.reason == MARK_THIN)
        text_writer_put(writer, ",\"thin\":true");
    else if (pixel_trace->marked && !pixel_trace->full)
        text_writer_put(writer, ",\"differs_from\":[%d,%d],\"by\":%j,\"tolerance\":%j", pixel_trace->mark.x,
                        pixel_trace->mark.y, pixel_trace->mark.distance, pixel_trace->mark.tolerance);
    text_writer_put(writer, ",\"samples\":[");
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next) {
        text_writer_put(writer, "{\"sample\":%u,\"x\":%j,\"y\":%j,\"counts\":%b,\"rays\":[", (unsigned)sample->number,
                        sample->x, sample->y, sample->counts);
        json_rays(report, writer, sample->first);
        text_writer_put(writer, "],\"colour\":%r}%s", sample->colour, sample->next ? "," : "");
    }
    text_writer_put(writer, "],\"untold\":%u", pixel_trace->omitted);
    json_sum(report, writer);
    text_writer_put(writer, "}\n");
}
