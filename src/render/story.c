/* See story.h. Rays hang under the ray that sent them, in the order in which they were sent. Where memory ends, or the
 * limit is reached, rays go on untold: `mute` counts how deep we are below the last one told. */
#include "render/story.h"

#include "material/medium_stack.h"

static void *take(struct story *story, size_t size) {
    void *block = arena_alloc(&story->arena, size);
    if (!block)
        story->failed = true;
    return block;
}

/* The ray that is under way, or NULL where nothing is told. */
static struct story_ray *ray_of(const struct story *story) {
    return story->on && story->mute == 0 ? story->ray : NULL;
}

/* The same for the light under way. */
static struct story_light *light_of(const struct story *story) {
    return ray_of(story) ? story->light : NULL;
}

/* A sample of any pixel; of others than the story's only the first colour is kept. */
static void begin_sample(struct story *story, const struct pixel_sample *place) {
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
    story->kind = RAY_CAMERA;
    story->weight = vec3_all(1);
}

static void end_sample(struct story *story, const struct pixel_sample *place, struct vec3 colour) {
    int64_t dx = place->x - (int64_t)story->x, dy = place->y - (int64_t)story->y;
    if (story->on)
        story->last_sample->colour = colour;
    story->on = false;
    if (place->number == 0 && dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1) {
        story->first[1 + dy][1 + dx] = colour;
        story->known[1 + dy][1 + dx] = true;
    }
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
        .kind = story->kind, .weight = story->weight, .number = ++story->rays, .parent = parent, .part = 1};
    struct story_ray **first = parent ? &parent->first : &story->last_sample->first;
    struct story_ray **last = parent ? &parent->last : &story->last_sample->last;
    if (*last)
        (*last)->next = ray;
    else
        *first = ray;
    *last = ray;
    return ray;
}

static void split_rays(struct story *story, double part) {
    struct story_ray *ray = ray_of(story);
    if (ray)
        ray->part = part;
}

static void send_ray(struct story *story, enum ray_kind kind, struct vec3 weight, enum ray_cut cut) {
    struct story_ray *from = ray_of(story);
    story->kind = kind;
    story->weight = vec3_scale(weight, from ? from->part : 1);
    struct story_ray *ray = from && cut != RAY_FOLLOWED ? add_ray(story) : NULL;
    if (ray)
        ray->cut = cut;
}

static void begin_ray(struct story *story, const struct observed_begin *seen) {
    const struct ray *ray = seen->ray;
    if (!story->on)
        return;
    struct story_ray *told = story->mute == 0 ? add_ray(story) : NULL;
    if (!told) {
        story->untold += story->mute > 0;
        story->mute++;
        return;
    }
    told->begun = true;
    told->origin = ray->origin;
    told->direction = ray->direction;
    told->time = ray->time;
    told->share = seen->share;
    told->media_count = ray->media ? ray->media->count : 0;
    told->media_ior = ray->media ? medium_stack_ior(ray->media) : 1;
    told->lamp = seen->light;
    told->met = seen->hit && !seen->light;
    if (told->met)
        told->hit = *seen->hit;
    told->distance = seen->distance;
    told->opacity = 1;
    story->ray = told;
}

static void end_ray(struct story *story, const struct observed_end *end) {
    if (!story->on)
        return;
    if (story->mute > 0) {
        story->mute--;
        return;
    }
    struct story_ray *ray = story->ray;
    ray->cut = end->evaluated ? RAY_FOLLOWED : RAY_TOO_WEAK;
    ray->seen = end->seen;
    ray->left = end->left;
    ray->veil = end->veil;
    ray->brings = end->brings;
    story->ray = ray->parent;
}

static void add_link(struct story *story, const struct material *material, const struct surface_look *look) {
    struct story_ray *ray = ray_of(story);
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

static void tell_surface(struct story *story, const struct bsdf *surface) {
    struct story_ray *ray = ray_of(story);
    if (!ray)
        return;
    ray->shaded = true;
    ray->bsdf = *surface;
}

static void begin_light(struct story *story, uint32_t number, const struct light *light) {
    struct story_ray *ray = ray_of(story);
    struct story_light *told = ray ? take(story, sizeof *told) : NULL;
    story->light = told;
    if (!told)
        return;
    *told = (struct story_light){.number = number, .light = light, .lamp = !light_is_delta(light), .lit = STORY_LIGHT_NO_EFFECT};
    if (ray->last_light)
        ray->last_light->next = told;
    else
        ray->lights = told;
    ray->last_light = told;
}

static void place_light(struct story *story, const struct observed_place *place) {
    struct story_light *light = light_of(story);
    if (!light)
        return;
    light->distance = place->distance;
    light->strength = place->strength;
    light->to_light = place->to_light;
    light->reflected = place->reflected;
}

static void count_shadow_rays(struct story *story, const struct observed_shadow *shadow) {
    struct story_light *light = light_of(story);
    if (!light)
        return;
    light->asked += shadow->asked;
    light->arrived += shadow->arrived;
    light->has_blocker = light->asked == 1 && shadow->blocker != OBSERVER_NO_BLOCKER;
    light->blocker = shadow->blocker;
}

static void end_light(struct story *story, struct vec3 colour) {
    struct story_light *light = light_of(story);
    if (light) {
        light->colour = colour;
        if (light->asked > 0)
            light->lit = light->arrived > 0 ? STORY_LIGHT_REACHES : STORY_LIGHT_BLOCKED;
    }
    story->light = NULL;
}

static void skip_light(struct story *story, uint32_t number, const struct light *light) {
    begin_light(story, number, light);
    struct story_light *told = light_of(story);
    if (told)
        told->lit = STORY_LIGHT_NOT_OURS;
    story->light = NULL;
}

static void tell_direct(struct story *story, const struct observed_direct *direct) {
    struct story_ray *ray = ray_of(story);
    if (!ray)
        return;
    ray->ambient_light = direct->ambient_light;
    ray->ambient = direct->ambient;
    ray->has_photons = direct->has_photons;
    ray->photons = direct->photons;
    ray->direct = direct->direct;
}

static void tell_mark(struct story *story, const struct observed_mark *mark) {
    story->mark_x = mark->x;
    story->mark_y = mark->y;
    story->mark_distance = mark->distance;
    story->mark_tolerance = mark->tolerance;
}

static void tell_pixel(struct story *story, const struct observed_pixel *pixel) {
    story->full = pixel->full;
    story->marked = pixel->samples > 0;
    story->samples = pixel->samples;
    for (struct story_sample *sample = story->sample; sample; sample = sample->next)
        sample->counts = sample->number > 0 || pixel->first_counts;
    story->rgb[0] = (float)pixel->colour.x;
    story->rgb[1] = (float)pixel->colour.y;
    story->rgb[2] = (float)pixel->colour.z;
}

static void notice(void *context, const struct observation *what) {
    struct story *story = context;
    switch (what->kind) {
    case OBSERVED_SAMPLE_BEGIN:
        begin_sample(story, what->sample.place);
        break;
    case OBSERVED_SAMPLE_END:
        end_sample(story, what->sample.place, what->sample.colour);
        break;
    case OBSERVED_SPLIT:
        split_rays(story, what->part);
        break;
    case OBSERVED_RAY_SENT:
        send_ray(story, what->sent.kind, what->sent.weight, what->sent.cut);
        break;
    case OBSERVED_RAY_BEGIN:
        begin_ray(story, &what->begin);
        break;
    case OBSERVED_MATERIAL:
        add_link(story, what->material.link, what->material.look);
        break;
    case OBSERVED_SURFACE:
        tell_surface(story, what->surface);
        break;
    case OBSERVED_LIGHT_BEGIN:
        begin_light(story, what->light.number, what->light.light);
        break;
    case OBSERVED_LIGHT_PLACE:
        place_light(story, &what->place);
        break;
    case OBSERVED_SHADOW_RAYS:
        count_shadow_rays(story, &what->shadow);
        break;
    case OBSERVED_LIGHT_END:
        end_light(story, what->light.colour);
        break;
    case OBSERVED_LIGHT_SKIPPED:
        skip_light(story, what->light.number, what->light.light);
        break;
    case OBSERVED_DIRECT:
        tell_direct(story, &what->direct);
        break;
    case OBSERVED_RAY_END:
        end_ray(story, &what->end);
        break;
    case OBSERVED_PIXEL:
        tell_pixel(story, &what->pixel);
        break;
    case OBSERVED_MARK:
        tell_mark(story, &what->mark);
        break;
    }
}

void story_init(struct story *story, uint32_t x, uint32_t y) {
    *story = (struct story){.x = x, .y = y, .observer = {notice, story}};
}

void story_destroy(struct story *story) {
    arena_destroy(&story->arena);
}
