/* See story.h. Rays hang under the ray that sent them, in the order in which they were sent. Where memory ends, or the
 * limit is reached, rays go on untold: `mute` counts how deep we are below the last one told. */
#include "render/story.h"

#include "material/medium_stack.h"

void story_init(struct story *story, uint32_t x, uint32_t y) {
    *story = (struct story){.x = x, .y = y, .part = 1};
}

void story_destroy(struct story *story) {
    arena_destroy(&story->arena);
}

static void *take(struct story *story, size_t size) {
    void *block = arena_alloc(&story->arena, size);
    if (!block)
        story->failed = true;
    return block;
}

void story_sample_begin(struct story *story, const struct story_place *place) {
    story->on = place->x == (int64_t)story->x && place->y == (int64_t)story->y;
    if (!story->on)
        return;
    struct story_sample *sample = take(story, sizeof *sample);
    story->on = sample != NULL;
    if (!sample)
        return;
    *sample = (struct story_sample){
        .x = (double)place->x + place->dx, .y = (double)place->y + place->dy, .number = place->number};
    if (story->last_sample)
        story->last_sample->next = sample;
    else
        story->sample = sample;
    story->last_sample = sample;
    story->ray = NULL;
    story->light = NULL;
    story->mute = 0;
    story->kind = STORY_CAMERA;
    story->weight = vec3_all(1);
    story->part = 1;
}

void story_sample_end(struct story *story, const struct story_place *place, struct vec3 colour) {
    int64_t dx = place->x - (int64_t)story->x, dy = place->y - (int64_t)story->y;
    if (story->on)
        story->last_sample->colour = colour;
    story->on = false;
    if (place->number == 0 && dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1) {
        story->first[1 + dy][1 + dx] = colour;
        story->known[1 + dy][1 + dx] = true;
    }
}

void story_next_ray(struct story *story, enum story_kind kind, struct vec3 weight) {
    story->kind = kind;
    story->weight = vec3_scale(weight, story->part);
}

/* A new ray below the one under way, or NULL. */
static struct story_ray *add_ray(struct story *story) {
    struct story_ray *parent = story->ray;
    if (story->rays >= STORY_RAYS) {
        story->untold++;
        return NULL;
    }
    struct story_ray *ray = take(story, sizeof *ray);
    if (!ray)
        return NULL;
    *ray = (struct story_ray){
        .kind = story->kind, .weight = story->weight, .number = ++story->rays, .parent = parent, .fresnel = -1};
    struct story_ray **first = parent ? &parent->first : &story->last_sample->first;
    struct story_ray **last = parent ? &parent->last : &story->last_sample->last;
    if (*last)
        (*last)->next = ray;
    else
        *first = ray;
    *last = ray;
    return ray;
}

void story_not_followed(struct story *story, enum story_kind kind, struct vec3 weight, enum story_cut cut) {
    story_next_ray(story, kind, weight);
    story->part = 1;
    struct story_ray *ray = story_ray_of(story) ? add_ray(story) : NULL;
    if (ray)
        ray->cut = cut;
}

void story_ray_begin(struct story *story, const struct ray *ray, const struct hit *hit, const struct light *lamp,
                     double distance, double share) {
    if (!story->on)
        return;
    struct story_ray *told = story->mute == 0 ? add_ray(story) : NULL;
    story->part = 1;
    if (!told) {
        story->untold += story->mute > 0;
        story->mute++;
        return;
    }
    told->begun = true;
    told->origin = ray->origin;
    told->direction = ray->direction;
    told->time = ray->time;
    told->share = share;
    told->media_count = ray->media ? ray->media->count : 0;
    told->media_ior = ray->media ? medium_stack_ior(ray->media) : 1;
    told->lamp = lamp;
    told->met = hit && !lamp;
    if (told->met)
        told->hit = *hit;
    told->distance = distance;
    told->opacity = 1;
    story->ray = told;
}

void story_ray_end(struct story *story, bool looked, struct vec3 seen, struct vec3 left, struct vec3 veil,
                   struct vec3 brings) {
    if (!story->on)
        return;
    if (story->mute > 0) {
        story->mute--;
        return;
    }
    struct story_ray *ray = story->ray;
    ray->cut = looked ? STORY_FOLLOWED : STORY_TOO_LITTLE;
    ray->seen = seen;
    ray->left = left;
    ray->veil = veil;
    ray->brings = brings;
    story->ray = ray->parent;
}

void story_tell_link(void *context, const struct material *material, const struct surface_look *look) {
    struct story *story = context;
    struct story_ray *ray = story_ray_of(story);
    struct story_link *link = ray ? take(story, sizeof *link) : NULL;
    if (!link)
        return;
    *link = (struct story_link){.material = material, .look = *look};
    struct story_link **end = &ray->links;
    while (*end)
        end = &(*end)->next;
    *end = link;
    ray->opacity = look->opacity;
}

void story_surface(struct story *story, const struct surface_look *look, const struct interface *interface,
                   const struct shading *shading, struct vec3 normal, bool dark_side) {
    struct story_ray *ray = story_ray_of(story);
    if (!ray)
        return;
    ray->shaded = true;
    ray->dark_side = dark_side;
    ray->normal = normal;
    ray->passes = interface->passes;
    ray->eta = look->fresnel || look->refract != 0 ? interface->eta : 1;
    ray->fresnel = look->fresnel ? look->reflect : -1;
    ray->shading = *shading;
}

void story_light_begin(struct story *story, uint32_t number, const struct light *light) {
    struct story_ray *ray = story_ray_of(story);
    struct story_light *told = ray ? take(story, sizeof *told) : NULL;
    story->light = told;
    if (!told)
        return;
    *told = (struct story_light){.number = number, .light = light, .lamp = light->emits, .lit = STORY_LIGHT_NO_EFFECT};
    if (ray->last_light)
        ray->last_light->next = told;
    else
        ray->lights = told;
    ray->last_light = told;
}

void story_light_end(struct story *story, struct vec3 colour) {
    struct story_light *light = story_light_of(story);
    if (light) {
        light->colour = colour;
        if (light->asked > 0)
            light->lit = light->arrived > 0 ? STORY_LIGHT_REACHES : STORY_LIGHT_BLOCKED;
    }
    story->light = NULL;
}

void story_light_excluded(struct story *story, uint32_t number, const struct light *light) {
    story_light_begin(story, number, light);
    struct story_light *told = story_light_of(story);
    if (told)
        told->lit = STORY_LIGHT_NOT_OURS;
    story->light = NULL;
}

void story_direct(struct story *story, struct vec3 ambient_light, struct vec3 ambient, bool has_photons,
                  struct vec3 photons, struct vec3 direct) {
    struct story_ray *ray = story_ray_of(story);
    if (!ray)
        return;
    ray->ambient_light = ambient_light;
    ray->ambient = ambient;
    ray->has_photons = has_photons;
    ray->photons = photons;
    ray->direct = direct;
}
