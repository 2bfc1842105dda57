/* The story of a pixel as one JSON object on one line; docs/pixel.md tells its fields. All numbers are exact. */
#include "image/png_write.h"
#include "inspect/inspect.h"
#include "material/texture_mapping.h"

static void number(struct sheet *sheet, const char *name, double value) {
    sheet_print(sheet, ",\"%s\":", name);
    sheet_json_number(sheet, value);
}

static void vector(struct sheet *sheet, const char *name, struct vec3 v) {
    sheet_print(sheet, ",\"%s\":", name);
    sheet_json_vector(sheet, v);
}

static void flag(struct sheet *sheet, const char *name, bool value) {
    sheet_print(sheet, ",\"%s\":%s", name, value ? "true" : "false");
}

static void text(struct sheet *sheet, const char *name, const char *value) {
    sheet_print(sheet, ",\"%s\":", name);
    sheet_json(sheet, value);
}

static void json_link(struct sheet *sheet, const struct story_link *link) {
    const struct surface_look *look = &link->look;
    sheet_print(sheet, "{\"kind\":\"%s\"", inspect_material(link->material));
    if (link->material->name && link->material->name[0])
        text(sheet, "name", link->material->name);
    vector(sheet, "kd", look->kd);
    vector(sheet, "ks", look->ks);
    number(sheet, "shininess", look->shininess);
    number(sheet, "reflect", look->reflect);
    number(sheet, "refract", look->refract);
    number(sheet, "ior", look->ior);
    number(sheet, "roughness", look->roughness);
    number(sheet, "opacity", look->opacity);
    vector(sheet, "emission", look->emission);
    vector(sheet, "absorption", look->absorption);
    vector(sheet, "normal", look->normal);
    flag(sheet, "two_sided", look->two_sided);
    flag(sheet, "unlit", look->unlit);
    flag(sheet, "fresnel", look->fresnel);
    sheet_print(sheet, "}");
}

static void json_lobes(struct sheet *sheet, const struct bsdf *bsdf) {
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        sheet_print(sheet, "%s{\"kind\":\"%s\"", i > 0 ? "," : "", lobe_name(lobe->kind));
        vector(sheet, "weight", lobe->weight);
        if (lobe_flags(lobe->kind) & BSDF_EXPONENT)
            number(sheet, "exponent", lobe->exponent);
        sheet_print(sheet, "}");
    }
}

static void json_light(const struct told_story *told, struct sheet *sheet, const struct story_light *light) {
    static const char *const lit[] = {
        [STORY_LIGHT_REACHES] = "reaches",
        [STORY_LIGHT_BLOCKED] = "blocked",
        [STORY_LIGHT_NOT_OURS] = "excluded",
        [STORY_LIGHT_NO_EFFECT] = "no effect",
    };
    sheet_print(sheet, "{\"light\":%u,\"kind\":\"%s\",\"lit\":\"%s\"", light->number + 1,
                light_kind_name(light->light->kind), lit[light->lit]);
    vector(sheet, "of", light->light->colour);
    if (!light->lamp && light->lit != STORY_LIGHT_NOT_OURS) {
        number(sheet, "distance", light->distance);
        number(sheet, "strength", light->strength);
        vector(sheet, "to_light", light->to_light);
        vector(sheet, "reflected", light->reflected);
    }
    sheet_print(sheet, ",\"shadow_rays\":%u,\"arrived\":%u", light->asked, light->arrived);
    if (light->has_blocker)
        text(sheet, "blocked_by", story_path(told, light->blocker));
    vector(sheet, "colour", light->colour);
    sheet_print(sheet, "}");
}

static void json_hit(const struct told_story *told, struct sheet *sheet, const struct story_ray *ray) {
    const struct world *world = told->picture->job->world;
    const struct hit *hit = &ray->hit;
    const struct shape *shape = placed_shape(world, hit->placed);
    text(sheet, "node", story_path(told, hit->placed));
    sheet_print(sheet, ",\"node_number\":%u,\"placed\":%u,\"shape\":\"%s\"", placed_node(world, hit->placed)->serial,
                hit->placed, shape_kind_name(shape->kind));
    if (shape->kind == SHAPE_CSG)
        sheet_print(sheet, ",\"operand\":%u,\"operand_shape\":\"%s\"", hit->leaf + 1,
                    shape_kind_name(shape->csg->leaves[hit->leaf].shape.kind));
    sheet_print(sheet, ",\"part\":%u", hit->part);
    number(sheet, "t", hit->t);
    flag(sheet, "front", hit->front);
    vector(sheet, "point", hit->point);
    vector(sheet, "geometric_normal", hit->normal_geometric);
    vector(sheet, "normal", hit->normal);
    double u, v;
    if (world_native_uv(world, hit, &u, &v)) {
        sheet_print(sheet, ",\"uv\":[");
        sheet_json_number(sheet, u);
        sheet_print(sheet, ",");
        sheet_json_number(sheet, v);
        sheet_print(sheet, "]");
    }
    sheet_print(sheet, ",\"material\":%u,\"links\":[", world->material_numbers[hit->material] + 1);
    for (const struct story_link *link = ray->links; link; link = link->next) {
        json_link(sheet, link);
        sheet_print(sheet, link->next ? "," : "");
    }
    sheet_print(sheet, "]");
    number(sheet, "opacity", ray->opacity);
    flag(sheet, "shaded", ray->shaded);
    if (!ray->shaded)
        return;
    vector(sheet, "lit_normal", ray->bsdf.lit);
    flag(sheet, "dark_side", ray->bsdf.dark);
    flag(sheet, "passes", ray->bsdf.passes);
    number(sheet, "index", ray->bsdf.eta);
    if (ray->bsdf.fresnel >= 0)
        number(sheet, "fresnel", ray->bsdf.fresnel);
    sheet_print(sheet, ",\"lobes\":[");
    json_lobes(sheet, &ray->bsdf);
    sheet_print(sheet, "]");
    number(sheet, "alpha", ray->bsdf.alpha);
    vector(sheet, "ambient", ray->ambient);
    sheet_print(sheet, ",\"lights\":[");
    for (const struct story_light *light = ray->lights; light; light = light->next) {
        json_light(told, sheet, light);
        sheet_print(sheet, light->next ? "," : "");
    }
    sheet_print(sheet, "]");
    vector(sheet, "caustics", ray->photons);
    vector(sheet, "direct", ray->direct);
    vector(sheet, "emission", ray->bsdf.emission);
}

static void json_rays(const struct told_story *told, struct sheet *sheet, const struct story_ray *ray);

static void json_ray(const struct told_story *told, struct sheet *sheet, const struct story_ray *ray) {
    static const char *const cut[] = {[RAY_FOLLOWED] = "no", [RAY_OVER_LIMIT] = "limit", [RAY_TOO_WEAK] = "cutoff"};
    sheet_print(sheet, "{\"ray\":%u,\"kind\":\"%s\",\"cut\":\"%s\"", ray->number, inspect_ray(ray->kind),
                cut[ray->cut]);
    vector(sheet, "weight", ray->weight);
    flag(sheet, "begun", ray->begun);
    if (ray->begun) {
        vector(sheet, "origin", ray->origin);
        vector(sheet, "direction", ray->direction);
        number(sheet, "time", ray->time);
        number(sheet, "share", ray->share);
        sheet_print(sheet, ",\"media\":%u", ray->media_count);
        number(sheet, "media_ior", ray->media_ior);
        number(sheet, "distance", ray->distance);
        text(sheet, "meets", ray->met ? "surface" : ray->lamp ? "light" : "background");
        if (ray->met)
            json_hit(told, sheet, ray);
        sheet_print(sheet, ",\"rays\":[");
        json_rays(told, sheet, ray->first);
        sheet_print(sheet, "]");
        vector(sheet, "seen", ray->seen);
        vector(sheet, "left", ray->left);
        vector(sheet, "fog", ray->veil);
        vector(sheet, "brings", ray->brings);
    }
    sheet_print(sheet, "}");
}

static void json_rays(const struct told_story *told, struct sheet *sheet, const struct story_ray *ray) {
    for (; ray; ray = ray->next) {
        json_ray(told, sheet, ray);
        sheet_print(sheet, ray->next ? "," : "");
    }
}

static void json_sum(const struct told_story *told, struct sheet *sheet) {
    const struct settings *settings = &told->picture->job->settings;
    const struct story *story = told->story;
    double toned[3];
    for (int c = 0; c < 3; c++)
        toned[c] = tone_apply(&settings->tone, (double)story->rgb[c]);
    vector(sheet, "film", vec3_make((double)story->rgb[0], (double)story->rgb[1], (double)story->rgb[2]));
    number(sheet, "exposure", settings->tone.exposure);
    sheet_print(sheet, ",\"tone\":%d", (int)settings->tone.curve);
    flag(sheet, "srgb", settings->tone.srgb);
    vector(sheet, "toned", vec3_make(toned[0], toned[1], toned[2]));
    sheet_print(sheet, ",\"bytes\":[%u,%u,%u]", png_write_byte(toned[0]), png_write_byte(toned[1]),
                png_write_byte(toned[2]));
    if (settings->deep)
        sheet_print(sheet, ",\"words\":[%u,%u,%u]", tone_word(toned[0]), tone_word(toned[1]), tone_word(toned[2]));
}

void story_tell_json(const struct told_story *told, struct sheet *sheet) {
    const struct story *story = told->story;
    const struct render_job *job = told->picture->job;
    sheet_print(sheet, "{\"picture\":");
    sheet_json(sheet, told->picture->file);
    sheet_print(sheet, ",\"width\":%u,\"height\":%u,\"x\":%u,\"y\":%u,\"marked\":%s,\"full\":%s", job->width,
                job->height, story->x, story->y, story->marked ? "true" : "false", story->full ? "true" : "false");
    if (story->marked && !story->full)
        sheet_print(sheet, ",\"differs_from\":[%d,%d],\"by\":%.17g,\"tolerance\":%.17g", story->mark_x, story->mark_y,
                    story->mark_distance, story->mark_tolerance);
    sheet_print(sheet, ",\"samples\":[");
    for (const struct story_sample *sample = story->sample; sample; sample = sample->next) {
        sheet_print(sheet, "{\"sample\":%u,\"x\":%.17g,\"y\":%.17g", (unsigned)sample->number, sample->x, sample->y);
        flag(sheet, "counts", sample->counts);
        sheet_print(sheet, ",\"rays\":[");
        json_rays(told, sheet, sample->first);
        sheet_print(sheet, "]");
        vector(sheet, "colour", sample->colour);
        sheet_print(sheet, sample->next ? "}," : "}");
    }
    sheet_print(sheet, "],\"untold\":%u", story->untold);
    json_sum(told, sheet);
    sheet_print(sheet, "}\n");
}
