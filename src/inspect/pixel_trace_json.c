/* The trace of a pixel as one JSON object on one line; docs/pixel.md describes its fields. All numbers are exact. */
#include "image/png_write.h"
#include "inspect/inspect.h"
#include "light/light_edit.h"
#include "material/texture_mapping.h"
#include "world/world_describe.h"

static void number(struct text_writer *writer, const char *name, double value) {
    text_writer_print(writer, ",\"%s\":", name);
    text_writer_json_number(writer, value);
}

static void vector(struct text_writer *writer, const char *name, struct vec3 v) {
    text_writer_print(writer, ",\"%s\":", name);
    text_writer_json_vector(writer, v);
}

static void flag(struct text_writer *writer, const char *name, bool value) {
    text_writer_print(writer, ",\"%s\":%s", name, value ? "true" : "false");
}

static void text(struct text_writer *writer, const char *name, const char *value) {
    text_writer_print(writer, ",\"%s\":", name);
    text_writer_json(writer, value);
}

static void json_link(struct text_writer *writer, const struct pixel_trace_link *link) {
    const struct surface_inputs *inputs = &link->inputs;
    text_writer_print(writer, "{\"kind\":\"%s\"", material_step_name(link->material));
    if (link->material->name && link->material->name[0])
        text(writer, "name", link->material->name);
    vector(writer, "kd", inputs->kd);
    vector(writer, "ks", inputs->ks);
    number(writer, "shininess", inputs->shininess);
    number(writer, "reflect", inputs->reflect);
    number(writer, "refract", inputs->refract);
    number(writer, "ior", inputs->ior);
    number(writer, "roughness", inputs->roughness);
    number(writer, "opacity", inputs->opacity);
    vector(writer, "emission", inputs->emission);
    vector(writer, "absorption", inputs->absorption);
    vector(writer, "normal", inputs->normal);
    flag(writer, "two_sided", inputs->two_sided);
    flag(writer, "unlit", inputs->unlit);
    flag(writer, "fresnel", inputs->fresnel);
    text_writer_print(writer, "}");
}

static void json_lobes(struct text_writer *writer, const struct bsdf *bsdf) {
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        text_writer_print(writer, "%s{\"kind\":\"%s\"", i > 0 ? "," : "", lobe_name(lobe->kind));
        vector(writer, "weight", lobe->weight);
        if (lobe_flags(lobe->kind) & BSDF_EXPONENT)
            number(writer, "exponent", lobe->exponent);
        text_writer_print(writer, "}");
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
    text_writer_print(writer, "{\"light\":%u,\"kind\":\"%s\",\"lit\":\"%s\"", light->number + 1,
                      light_kind_name(light->light->kind), lit[light->lit]);
    if (light->primitive != OBSERVER_NO_BLOCKER)
        text(writer, "emitter", trace_path(report, light->primitive));
    vector(writer, "of", light->light->colour);
    if (!light->area_light && light->lit != PIXEL_TRACE_LIGHT_NOT_OURS && light->distance > 0) {
        number(writer, "distance", light->distance);
        number(writer, "strength", light->strength);
        vector(writer, "to_light", light->to_light);
        vector(writer, "reflected", light->reflected);
    }
    text_writer_print(writer, ",\"shadow_rays\":%u,\"arrived\":%u", light->asked, light->arrived);
    if (light->has_blocker)
        text(writer, "blocked_by", trace_path(report, light->blocker));
    vector(writer, "colour", light->colour);
    text_writer_print(writer, "}");
}

static void json_hit(const struct trace_report *report, struct text_writer *writer, const struct pixel_trace_ray *ray) {
    const struct world *world = report->picture->job->world;
    const struct hit *hit = &ray->hit;
    const struct geometry *geometry = primitive_geometry(world, hit->primitive);
    text(writer, "node", trace_path(report, hit->primitive));
    text_writer_print(writer, ",\"node_number\":%u,\"placed\":%u,\"shape\":\"%s\"",
                      primitive_node(world, hit->primitive)->serial, hit->primitive, geometry_kind_name(geometry));
    if (geometry->csg)
        text_writer_print(writer, ",\"operand\":%u,\"operand_shape\":\"%s\"", hit->leaf + 1,
                          shape_kind_name(geometry_shape(geometry, hit->leaf)->kind));
    text_writer_print(writer, ",\"part\":%u", hit->part);
    number(writer, "t", hit->t);
    flag(writer, "front", hit->front);
    vector(writer, "point", hit->point);
    vector(writer, "geometric_normal", hit->normal_geometric);
    vector(writer, "normal", hit->normal);
    double u, v;
    if (world_native_uv(world, hit, &u, &v)) {
        text_writer_print(writer, ",\"uv\":[");
        text_writer_json_number(writer, u);
        text_writer_print(writer, ",");
        text_writer_json_number(writer, v);
        text_writer_print(writer, "]");
    }
    text_writer_print(writer, ",\"material\":%u,\"links\":[", world->material_numbers[hit->material] + 1);
    for (const struct pixel_trace_link *link = ray->links; link; link = link->next) {
        json_link(writer, link);
        text_writer_print(writer, link->next ? "," : "");
    }
    text_writer_print(writer, "]");
    number(writer, "opacity", ray->opacity);
    flag(writer, "shaded", ray->shaded);
    if (!ray->shaded)
        return;
    vector(writer, "lit_normal", ray->bsdf.lit);
    flag(writer, "dark_side", ray->bsdf.dark);
    flag(writer, "passes", ray->bsdf.transmits);
    number(writer, "index", ray->bsdf.eta);
    if (ray->bsdf.fresnel >= 0)
        number(writer, "fresnel", ray->bsdf.fresnel);
    text_writer_print(writer, ",\"lobes\":[");
    json_lobes(writer, &ray->bsdf);
    text_writer_print(writer, "]");
    number(writer, "alpha", ray->bsdf.alpha);
    vector(writer, "ambient", ray->ambient);
    text_writer_print(writer, ",\"lights\":[");
    for (const struct pixel_trace_light *light = ray->lights; light; light = light->next) {
        json_light(report, writer, light);
        text_writer_print(writer, light->next ? "," : "");
    }
    text_writer_print(writer, "]");
    vector(writer, "caustics", ray->photons);
    vector(writer, "direct", ray->direct);
    vector(writer, "emission", ray->is_vertex ? ray->vertex.emission : ray->bsdf.emission);
}

static void json_rays(const struct trace_report *report, struct text_writer *writer, const struct pixel_trace_ray *ray);

static void json_ray(const struct trace_report *report, struct text_writer *writer, const struct pixel_trace_ray *ray) {
    static const char *const ends[] = {
        [PATH_GOES_ON] = "goes on",         [PATH_LEAVES_SCENE] = "background", [PATH_SEES_LIGHT] = "light",
        [PATH_REACHES_MAX_DEPTH] = "depth", [PATH_IS_ABSORBED] = "absorbed",    [PATH_LOSES_ROULETTE] = "roulette",
        [PATH_IN_TOO_MANY_HOLES] = "holes",
    };
    static const char *const cut[] = {[RAY_FOLLOWED] = "no", [RAY_OVER_LIMIT] = "limit", [RAY_TOO_WEAK] = "cutoff"};
    text_writer_print(writer, "{\"ray\":%u,\"kind\":\"%s\",\"cut\":\"%s\"", ray->number, inspect_ray(ray->kind),
                      cut[ray->cut]);
    vector(writer, "weight", ray->weight);
    flag(writer, "begun", ray->begun);
    if (ray->begun) {
        vector(writer, "origin", ray->origin);
        vector(writer, "direction", ray->direction);
        number(writer, "time", ray->time);
        number(writer, "share", ray->share);
        text_writer_print(writer, ",\"media\":%u", ray->media_count);
        number(writer, "media_ior", ray->media_ior);
        number(writer, "distance", ray->distance);
        text(writer, "meets", ray->met ? "surface" : ray->area_light ? "light" : "background");
        if (ray->met)
            json_hit(report, writer, ray);
        else if (ray->is_vertex)
            vector(writer, "emission", ray->vertex.emission);
        if (ray->is_vertex)
            text(writer, "path", ends[ray->vertex.end]);
        text_writer_print(writer, ",\"rays\":[");
        json_rays(report, writer, ray->first);
        text_writer_print(writer, "]");
        vector(writer, "seen", ray->seen);
        vector(writer, "left", ray->left);
        vector(writer, "fog", ray->in_scattered);
        vector(writer, "brings", ray->brings);
    }
    text_writer_print(writer, "}");
}

static void json_rays(const struct trace_report *report, struct text_writer *writer,
                      const struct pixel_trace_ray *ray) {
    for (; ray; ray = ray->next) {
        json_ray(report, writer, ray);
        text_writer_print(writer, ray->next ? "," : "");
    }
}

static void json_sum(const struct trace_report *report, struct text_writer *writer) {
    const struct settings *settings = &report->picture->job->settings;
    const struct pixel_trace *pixel_trace = report->pixel_trace;
    double toned[3];
    for (int c = 0; c < 3; c++)
        toned[c] = tone_apply(&settings->tone, (double)pixel_trace->rgb[c]);
    vector(writer, "film",
           vec3_make((double)pixel_trace->rgb[0], (double)pixel_trace->rgb[1], (double)pixel_trace->rgb[2]));
    number(writer, "exposure", settings->tone.exposure);
    text_writer_print(writer, ",\"tone\":%d", (int)settings->tone.curve);
    flag(writer, "srgb", settings->tone.srgb);
    vector(writer, "toned", vec3_make(toned[0], toned[1], toned[2]));
    text_writer_print(writer, ",\"bytes\":[%u,%u,%u]", png_write_byte(toned[0]), png_write_byte(toned[1]),
                      png_write_byte(toned[2]));
    if (settings->deep)
        text_writer_print(writer, ",\"words\":[%u,%u,%u]", tone_word(toned[0]), tone_word(toned[1]),
                          tone_word(toned[2]));
}

void pixel_trace_print_json(const struct trace_report *report, struct text_writer *writer) {
    const struct pixel_trace *pixel_trace = report->pixel_trace;
    const struct render_job *job = report->picture->job;
    text_writer_print(writer, "{\"picture\":");
    text_writer_json(writer, report->picture->file);
    text_writer_print(writer, ",\"width\":%u,\"height\":%u,\"x\":%u,\"y\":%u,\"marked\":%s,\"full\":%s", job->width,
                      job->height, pixel_trace->x, pixel_trace->y, pixel_trace->marked ? "true" : "false",
                      pixel_trace->full ? "true" : "false");
    if (pixel_trace->marked && !pixel_trace->full && pixel_trace->mark_reason == MARK_THIN)
        text_writer_print(writer, ",\"thin\":true");
    else if (pixel_trace->marked && !pixel_trace->full)
        text_writer_print(writer, ",\"differs_from\":[%d,%d],\"by\":%.17g,\"tolerance\":%.17g", pixel_trace->mark_x,
                          pixel_trace->mark_y, pixel_trace->mark_distance, pixel_trace->mark_tolerance);
    text_writer_print(writer, ",\"samples\":[");
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next) {
        text_writer_print(writer, "{\"sample\":%u,\"x\":%.17g,\"y\":%.17g", (unsigned)sample->number, sample->x,
                          sample->y);
        flag(writer, "counts", sample->counts);
        text_writer_print(writer, ",\"rays\":[");
        json_rays(report, writer, sample->first);
        text_writer_print(writer, "]");
        vector(writer, "colour", sample->colour);
        text_writer_print(writer, sample->next ? "}," : "}");
    }
    text_writer_print(writer, "],\"untold\":%u", pixel_trace->omitted);
    json_sum(report, writer);
    text_writer_print(writer, "}\n");
}
