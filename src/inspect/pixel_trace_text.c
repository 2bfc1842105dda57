/* The story of a pixel in words. A ray is a paragraph, indented below the surface that sent it; the last line of each
 * is what it brings. Numbers have six digits: enough to read; --json has them all. */
#include "image/png_write.h"
#include "inspect/inspect.h"
#include "material/texture_mapping.h"

struct teller {
    const struct told_story *told;
    struct sheet *sheet;
    int depth;
    bool changed; /* by the link that is told */
};

static void indent(const struct teller *t, int deeper) {
    int width = 2 * (t->depth + deeper);
    sheet_print(t->sheet, "%*s", width < 200 ? width : 200, "");
}

static void triple(const struct teller *t, const char *before, struct vec3 v) {
    sheet_print(t->sheet, "%s(%.6g, %.6g, %.6g)", before, v.x, v.y, v.z);
}

static bool same(struct vec3 a, struct vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static void changed_triple(struct teller *t, const char *name, struct vec3 now, struct vec3 before) {
    if (same(now, before))
        return;
    t->changed = true;
    sheet_print(t->sheet, " %s", name);
    triple(t, " ", now);
}

static void changed_number(struct teller *t, const char *name, double now, double before) {
    if (now == before)
        return;
    t->changed = true;
    sheet_print(t->sheet, " %s %.6g", name, now);
}

static void changed_flag(struct teller *t, const char *name, bool now, bool before) {
    if (now == before)
        return;
    t->changed = true;
    sheet_print(t->sheet, now ? " %s" : " not %s", name);
}

/* One link: what it has changed. */
static void tell_link(struct teller *t, const struct story_link *link, const struct surface_look *before) {
    const struct surface_look *look = &link->look;
    indent(t, 1);
    sheet_print(t->sheet, "%s", inspect_material(link->material));
    if (link->material->name && link->material->name[0]) {
        sheet_print(t->sheet, " '");
        sheet_name(t->sheet, link->material->name);
        sheet_print(t->sheet, "'");
    }
    sheet_print(t->sheet, ":");
    t->changed = false;
    changed_triple(t, "kd", look->kd, before->kd);
    changed_triple(t, "ks", look->ks, before->ks);
    changed_number(t, "shininess", look->shininess, before->shininess);
    changed_number(t, "reflect", look->reflect, before->reflect);
    changed_number(t, "refract", look->refract, before->refract);
    changed_number(t, "ior", look->ior, before->ior);
    changed_number(t, "roughness", look->roughness, before->roughness);
    changed_number(t, "opacity", look->opacity, before->opacity);
    changed_triple(t, "emission", look->emission, before->emission);
    changed_triple(t, "absorption", look->absorption, before->absorption);
    changed_triple(t, "normal", look->normal, before->normal);
    changed_flag(t, "two-sided", look->two_sided, before->two_sided);
    changed_flag(t, "unlit", look->unlit, before->unlit);
    changed_flag(t, "fresnel", look->fresnel, before->fresnel);
    sheet_print(t->sheet, !t->changed ? " changes nothing here\n" : "\n");
}

static void tell_shading(const struct teller *t, const struct story_ray *ray) {
    indent(t, 1);
    sheet_print(t->sheet, "shading:");
    for (int i = 0; i < ray->bsdf.count; i++) {
        const struct lobe *lobe = &ray->bsdf.lobes[i];
        sheet_print(t->sheet, "%s %s", i > 0 ? "," : "", lobe_name(lobe->kind));
        triple(t, " ", lobe->weight);
        if (lobe_flags(lobe->kind) & BSDF_EXPONENT)
            sheet_print(t->sheet, "^%.6g", lobe->exponent);
    }
    if (ray->bsdf.count == 0)
        sheet_print(t->sheet, " none");
    if (ray->bsdf.alpha > 0)
        sheet_print(t->sheet, ", rough (alpha %.6g)", ray->bsdf.alpha);
    triple(t, "; normal ", ray->bsdf.lit);
    sheet_print(t->sheet, "%s\n", ray->bsdf.dark ? "; seen from behind, where no light counts" : "");
    if (ray->bsdf.fresnel >= 0) {
        indent(t, 1);
        sheet_print(t->sheet, "fresnel: %.6g is reflected, %.6g refracted, index before / behind %.6g%s\n",
                    ray->bsdf.fresnel, 1 - ray->bsdf.fresnel, ray->bsdf.eta,
                    ray->bsdf.passes ? "" : ": total reflection");
    } else if (!ray->bsdf.passes && ray->bsdf.eta != 1) {
        indent(t, 1);
        sheet_print(t->sheet, "total internal reflection: nothing is refracted\n");
    }
}

static void tell_light(const struct teller *t, const struct story_light *light) {
    indent(t, 1);
    sheet_print(t->sheet, "light %u, %s", light->number + 1, light_kind_name(light->light->kind));
    unsigned has = light_properties(light->light);
    if (has & LIGHT_HAS_POSITION)
        triple(t, " at ", light->light->position);
    else if (has & LIGHT_HAS_DIRECTION)
        triple(t, " along ", light->light->direction);
    triple(t, " of ", light->light->colour);
    switch (light->lit) {
    case STORY_LIGHT_NOT_OURS:
        sheet_print(t->sheet, ": does not light this\n");
        return;
    case STORY_LIGHT_NO_EFFECT:
        sheet_print(t->sheet, ": nothing of it is reflected this way\n");
        return;
    case STORY_LIGHT_REACHES:
    case STORY_LIGHT_BLOCKED:
        break;
    }
    if (!light->lamp && light->distance < INFINITY)
        sheet_print(t->sheet, ": distance %.6g, fading %.6g", light->distance, light->strength);
    if (!light->lamp)
        triple(t, ", reflected by ", light->reflected);
    if (light->has_blocker) {
        sheet_print(t->sheet, ", blocked by ");
        sheet_name(t->sheet, story_path(t->told, light->blocker));
    } else if (light->asked == 1) {
        sheet_print(t->sheet, light->arrived ? ", seen" : ", blocked");
    } else {
        sheet_print(t->sheet, ", %u of %u shadow rays arrive", light->arrived, light->asked);
    }
    triple(t, ": ", light->colour);
    sheet_print(t->sheet, "\n");
}

static void tell_hit(const struct teller *t, const struct story_ray *ray) {
    const struct world *world = t->told->picture->job->world;
    const struct hit *hit = &ray->hit;
    const struct shape *shape = placed_shape(world, hit->placed);
    indent(t, 1);
    sheet_print(t->sheet, "meets ");
    sheet_name(t->sheet, story_path(t->told, hit->placed));
    sheet_print(t->sheet, ", %s", shape_kind_name(shape->kind));
    if (shape->kind == SHAPE_CSG)
        sheet_print(t->sheet, ", operand %u of %u, %s", hit->leaf + 1, shape->csg->leaf_count,
                    shape_kind_name(shape->csg->leaves[hit->leaf].shape.kind));
    sheet_print(t->sheet, ", part %u, from %s, at distance %.6g\n", hit->part, hit->front ? "outside" : "inside",
                ray->distance);
    indent(t, 1);
    triple(t, "point ", hit->point);
    triple(t, ", normal ", hit->normal_geometric);
    if (!same(hit->normal, hit->normal_geometric))
        triple(t, ", interpolated ", hit->normal);
    double u, v;
    if (world_native_uv(world, hit, &u, &v))
        sheet_print(t->sheet, ", uv (%.6g, %.6g)", u, v);
    sheet_print(t->sheet, ", material %u of %u\n", world->material_numbers[hit->material] + 1,
                world->material_number_count);
}

static void tell_ray(struct teller *t, const struct story_ray *ray);

/* The parts of what the surface shows, in the order in which they are added. */
static void tell_surface(struct teller *t, const struct story_ray *ray) {
    struct surface_look nothing = {.opacity = 1, .normal = ray->hit.normal};
    const struct surface_look *before = &nothing;
    tell_hit(t, ray);
    for (const struct story_link *link = ray->links; link; link = link->next) {
        tell_link(t, link, before);
        before = &link->look;
    }
    if (ray->shaded) {
        tell_shading(t, ray);
        indent(t, 1);
        triple(t, "ambient ", ray->ambient_light);
        triple(t, " times ", ray->bsdf.ambient);
        triple(t, ": ", ray->ambient);
        sheet_print(t->sheet, "\n");
        for (const struct story_light *light = ray->lights; light; light = light->next)
            tell_light(t, light);
        if (ray->has_photons) {
            indent(t, 1);
            triple(t, "caustics: ", ray->photons);
            sheet_print(t->sheet, "\n");
        }
        if (!same(ray->bsdf.emission, vec3_all(0))) {
            indent(t, 1);
            triple(t, "own light: ", ray->bsdf.emission);
            sheet_print(t->sheet, "\n");
        }
    }
    t->depth++;
    for (const struct story_ray *child = ray->first; child; child = child->next)
        tell_ray(t, child);
    t->depth--;
    if (ray->opacity < 1) {
        indent(t, 1);
        sheet_print(t->sheet, "opacity %.6g: the rays through the hole and this share of all the rest\n", ray->opacity);
    }
}

static void tell_met(struct teller *t, const struct story_ray *ray) {
    if (ray->cut == RAY_TOO_WEAK) {
        indent(t, 1);
        sheet_print(t->sheet, "what it meets at distance %.6g could not change the pixel any more (--cutoff)\n",
                    ray->distance);
    } else if (ray->lamp) {
        indent(t, 1);
        sheet_print(t->sheet, "meets a %s that shows itself, at distance %.6g\n", light_kind_name(ray->lamp->kind),
                    ray->distance);
    } else if (ray->met) {
        tell_surface(t, ray);
    } else {
        indent(t, 1);
        sheet_print(t->sheet, "meets nothing: background, %s\n", inspect_sky(t->told->picture->job->world->sky.kind));
    }
}

static void tell_ray(struct teller *t, const struct story_ray *ray) {
    indent(t, 0);
    sheet_print(t->sheet, "ray %u, %s", ray->number,
                ray->kind == RAY_HOLE ? "through the hole" : inspect_ray(ray->kind));
    if (ray->parent)
        triple(t, ", weight ", ray->weight);
    if (!ray->begun) {
        sheet_print(t->sheet, ": not followed, %s\n",
                    ray->cut == RAY_OVER_LIMIT ? "the limit is reached (-reflect-limit, -refract-limit)"
                                               : "it could not change the pixel any more (--cutoff)");
        return;
    }
    triple(t, ": from ", ray->origin);
    triple(t, " along ", ray->direction);
    if (ray->time != 0)
        sheet_print(t->sheet, ", time %.6g", ray->time);
    if (ray->media_count > 0)
        sheet_print(t->sheet, ", inside of %u, index %.6g", ray->media_count, ray->media_ior);
    sheet_print(t->sheet, "\n");
    tell_met(t, ray);
    indent(t, 1);
    if (!same(ray->left, vec3_all(1))) {
        triple(t, "of ", ray->seen);
        triple(t, " the way leaves ", ray->left);
        if (!same(ray->veil, vec3_all(0)))
            triple(t, " and fog adds ", ray->veil);
        sheet_print(t->sheet, "\n");
        indent(t, 1);
    }
    triple(t, "brings ", ray->brings);
    sheet_print(t->sheet, "\n");
}

static const char *direction(int x, int y) {
    static const char *const names[3][3] = {
        {"upper left", "upper", "upper right"}, {"left", "", "right"}, {"lower left", "lower", "lower right"}};
    return names[1 + y][1 + x];
}

static void tell_samples(struct teller *t) {
    const struct story *story = t->told->story;
    sheet_print(t->sheet, "%s", story->marked ? "" : "one sample: no neighbour differs by more than the tolerances\n");
    if (story->marked && story->full)
        sheet_print(t->sheet, "%d x %d samples, as all pixels have (-full, a lens or motion)\n", story->samples,
                    story->samples);
    else if (story->marked)
        sheet_print(t->sheet, "%d x %d samples: the first one differs from the %s neighbour's by %.6g > %g\n",
                    story->samples, story->samples, direction(story->mark_x, story->mark_y), story->mark_distance,
                    story->mark_tolerance);
    for (const struct story_sample *sample = story->sample; sample; sample = sample->next) {
        sheet_print(t->sheet, "\nsample %u at %.6f, %.6f%s\n", (unsigned)sample->number, sample->x, sample->y,
                    sample->counts ? "" : " (only to find out whether the pixel is sampled again)");
        t->depth = 1;
        for (const struct story_ray *ray = sample->first; ray; ray = ray->next)
            tell_ray(t, ray);
        triple(t, "  colour ", sample->colour);
        sheet_print(t->sheet, "\n");
    }
    if (story->untold > 0)
        sheet_print(t->sheet, "\n%u more rays are not told\n", story->untold);
}

/* How the colour is the sum, and what becomes of it in the file. */
static void tell_sum(struct teller *t) {
    const struct story *story = t->told->story;
    const struct settings *settings = &t->told->picture->job->settings;
    const struct tone *tone = &settings->tone;
    static const char *const curves[] = {TONE_CURVES(LIST_WORD)};
    unsigned count = 0;
    double toned[3];
    for (const struct story_sample *sample = story->sample; sample; sample = sample->next)
        count += sample->counts;
    sheet_print(t->sheet, "\nthe mean of %u sample%s, in single precision: (%.9g, %.9g, %.9g)\n", count,
                count == 1 ? "" : "s", (double)story->rgb[0], (double)story->rgb[1], (double)story->rgb[2]);
    for (int c = 0; c < 3; c++)
        toned[c] = tone_apply(tone, (double)story->rgb[c]);
    if (!tone_is_plain(tone))
        sheet_print(t->sheet, "exposure %g, tone %s%s: (%.9g, %.9g, %.9g)\n", tone->exposure, curves[tone->curve],
                    tone->srgb ? ", sRGB" : "", toned[0], toned[1], toned[2]);
    if (settings->deep)
        sheet_print(t->sheet, "times 65535, rounded: %u %u %u\n", tone_word(toned[0]), tone_word(toned[1]),
                    tone_word(toned[2]));
    else
        sheet_print(t->sheet, "times 255, rounded: %u %u %u\n", png_write_byte(toned[0]), png_write_byte(toned[1]),
                    png_write_byte(toned[2]));
}

void story_tell(const struct told_story *told, struct sheet *sheet) {
    struct teller t = {.told = told, .sheet = sheet};
    const struct render_job *job = told->picture->job;
    sheet_name(sheet, told->picture->file);
    sheet_print(sheet, ", pixel %u,%u of %u x %u: ", told->story->x, told->story->y, job->width, job->height);
    tell_samples(&t);
    tell_sum(&t);
}
