/* See pixel_trace.h. Rays are children of the ray that spawned them, in order. Without memory, or beyond the limit,
 * rays are not recorded: `mute` counts the levels below the last recorded ray. */
#include "render/pixel_trace.h"

#include "material/medium.h"

static void *take(struct pixel_trace *pixel_trace, size_t size) {
    void *block = arena_alloc(&pixel_trace->arena, size);
    if (!block)
        pixel_trace->failed = true;
    return block;
}

/* The current ray, or NULL if nothing is recorded. */
static struct pixel_trace_ray *ray_of(const struct pixel_trace *pixel_trace) {
    return pixel_trace->on && pixel_trace->mute == 0 ? pixel_trace->ray : NULL;
}

/* The same for the current light. */
static struct pixel_trace_light *light_of(const struct pixel_trace *pixel_trace) {
    return ray_of(pixel_trace) ? pixel_trace->light : NULL;
}

/* A sample of any pixel; of others than the trace's only the first colour is kept. */
static void begin_sample(struct pixel_trace *pixel_trace, const struct pixel_sample *position) {
    pixel_trace->on = position->x == (int64_t)pixel_trace->x && position->y == (int64_t)pixel_trace->y;
    if (!pixel_trace->on)
        return;
    struct pixel_trace_sample *sample = take(pixel_trace, sizeof *sample);
    pixel_trace->on = sample != NULL;
    if (!sample)
        return;
    *sample = (struct pixel_trace_sample){
        .x = (double)position->x + position->dx, .y = (double)position->y + position->dy, .number = position->number};
    if (pixel_trace->last_sample)
        pixel_trace->last_sample->next = sample;
    else
        pixel_trace->sample = sample;
    pixel_trace->last_sample = sample;
    pixel_trace->ray = NULL;
    pixel_trace->light = NULL;
    pixel_trace->mute = 0;
    pixel_trace->kind = RAY_CAMERA;
    pixel_trace->weight = colour_all(1);
}

static void end_sample(struct pixel_trace *pixel_trace, const struct pixel_sample *position, struct colour colour) {
    int64_t dx = position->x - (int64_t)pixel_trace->x, dy = position->y - (int64_t)pixel_trace->y;
    if (pixel_trace->on)
        pixel_trace->last_sample->colour = colour;
    pixel_trace->on = false;
    if (position->number == 0 && dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1) {
        pixel_trace->first[1 + dy][1 + dx] = colour;
        pixel_trace->known[1 + dy][1 + dx] = true;
    }
}

/* A new ray below the current one, or NULL. */
static struct pixel_trace_ray *add_ray(struct pixel_trace *pixel_trace) {
    struct pixel_trace_ray *parent = pixel_trace->ray;
    if (pixel_trace->rays >= PIXEL_TRACE_RAYS) {
        pixel_trace->omitted++;
        return NULL;
    }
    struct pixel_trace_ray *ray = take(pixel_trace, sizeof *ray);
    if (!ray)
        return NULL;
    *ray = (struct pixel_trace_ray){.kind = pixel_trace->kind,
                                    .weight = pixel_trace->weight,
                                    .number = ++pixel_trace->rays,
                                    .parent = parent,
                                    .part = 1};
    struct pixel_trace_ray **first = parent ? &parent->first : &pixel_trace->last_sample->first;
    struct pixel_trace_ray **last = parent ? &parent->last : &pixel_trace->last_sample->last;
    if (*last)
        (*last)->next = ray;
    else
        *first = ray;
    *last = ray;
    return ray;
}

static void split_rays(struct pixel_trace *pixel_trace, double part) {
    struct pixel_trace_ray *ray = ray_of(pixel_trace);
    if (ray)
        ray->part = part;
}

static void send_ray(struct pixel_trace *pixel_trace, enum ray_kind kind, struct colour weight, enum ray_cut cut) {
    struct pixel_trace_ray *from = ray_of(pixel_trace);
    pixel_trace->kind = kind;
    pixel_trace->weight = colour_scale(weight, from ? from->part : 1);
    struct pixel_trace_ray *ray = from && cut != RAY_FOLLOWED ? add_ray(pixel_trace) : NULL;
    if (ray)
        ray->cut = cut;
}

static void begin_ray(struct pixel_trace *pixel_trace, const struct observed_begin *seen) {
    const struct ray *ray = seen->ray;
    if (!pixel_trace->on)
        return;
    struct pixel_trace_ray *recorded = pixel_trace->mute == 0 ? add_ray(pixel_trace) : NULL;
    /* Without room, or below a ray without room, rays are only counted. */
    if (!recorded) {
        pixel_trace->omitted += pixel_trace->mute > 0;
        pixel_trace->mute++;
        return;
    }
    recorded->begun = true;
    recorded->origin = ray->origin;
    recorded->direction = ray->direction;
    recorded->time = ray->time;
    recorded->share = seen->share;
    recorded->scatterings = seen->scatterings;
    recorded->media_count = ray->media ? ray->media->count : 0;
    recorded->media_ior = ray->media ? medium_stack_ior(ray->media) : 1;
    recorded->wavelength = ray->media ? (double)ray->media->wavelength : 0;
    recorded->area_light = seen->light;
    recorded->met = seen->hit && !seen->light;
    if (recorded->met)
        recorded->hit = *seen->hit;
    recorded->distance = seen->distance;
    recorded->opacity = 1;
    pixel_trace->ray = recorded;
}

static void end_ray(struct pixel_trace *pixel_trace, const struct observed_end *end) {
    if (!pixel_trace->on)
        return;
    if (pixel_trace->mute > 0) {
        pixel_trace->mute--;
        return;
    }
    struct pixel_trace_ray *ray = pixel_trace->ray;
    ray->cut = end->evaluated ? RAY_FOLLOWED : RAY_TOO_WEAK;
    ray->seen = end->seen;
    ray->left = end->left;
    ray->in_scattered = end->in_scattered;
    ray->brings = end->brings;
    pixel_trace->ray = ray->parent;
}

static void add_link(struct pixel_trace *pixel_trace, const struct material *material,
                     const struct surface_inputs *inputs) {
    struct pixel_trace_ray *ray = ray_of(pixel_trace);
    struct pixel_trace_link *link = ray ? take(pixel_trace, sizeof *link) : NULL;
    if (!link)
        return;
    *link = (struct pixel_trace_link){.material = material, .inputs = *inputs};
    struct pixel_trace_link **end = &ray->links;
    while (*end)
        end = &(*end)->next;
    *end = link;
    ray->opacity = inputs->opacity;
}

static void record_surface(struct pixel_trace *pixel_trace, const struct bsdf *surface) {
    struct pixel_trace_ray *ray = ray_of(pixel_trace);
    if (!ray)
        return;
    ray->shaded = true;
    ray->bsdf = *surface;
}

static void begin_light(struct pixel_trace *pixel_trace, uint32_t number, const struct light *light,
                        uint32_t primitive) {
    struct pixel_trace_ray *ray = ray_of(pixel_trace);
    struct pixel_trace_light *recorded = ray ? take(pixel_trace, sizeof *recorded) : NULL;
    pixel_trace->light = recorded;
    if (!recorded)
        return;
    *recorded = (struct pixel_trace_light){.number = number,
                                           .light = light,
                                           .primitive = primitive,
                                           .area_light = !light_is_delta(light),
                                           .lit = PIXEL_TRACE_LIGHT_NO_EFFECT};
    if (ray->last_light)
        ray->last_light->next = recorded;
    else
        ray->lights = recorded;
    ray->last_light = recorded;
}

static void record_light_position(struct pixel_trace *pixel_trace, const struct observed_light_sample *position) {
    struct pixel_trace_light *light = light_of(pixel_trace);
    if (!light)
        return;
    light->distance = position->distance;
    light->strength = position->strength;
    light->to_light = position->to_light;
    light->reflected = position->reflected;
}

static void count_shadow_rays(struct pixel_trace *pixel_trace, const struct observed_shadow *shadow) {
    struct pixel_trace_light *light = light_of(pixel_trace);
    if (!light)
        return;
    light->asked += shadow->asked;
    light->arrived += shadow->arrived;
    light->has_blocker = light->asked == 1 && shadow->blocker != OBSERVER_NO_BLOCKER;
    light->blocker = shadow->blocker;
}

static void end_light(struct pixel_trace *pixel_trace, struct colour colour) {
    struct pixel_trace_light *light = light_of(pixel_trace);
    if (light) {
        light->colour = colour;
        if (light->asked > 0)
            light->lit = light->arrived > 0 ? PIXEL_TRACE_LIGHT_REACHES : PIXEL_TRACE_LIGHT_BLOCKED;
    }
    pixel_trace->light = NULL;
}

static void skip_light(struct pixel_trace *pixel_trace, uint32_t number, const struct light *light) {
    begin_light(pixel_trace, number, light, OBSERVER_NO_BLOCKER);
    struct pixel_trace_light *recorded = light_of(pixel_trace);
    if (recorded)
        recorded->lit = PIXEL_TRACE_LIGHT_NOT_OURS;
    pixel_trace->light = NULL;
}

static void record_direct(struct pixel_trace *pixel_trace, const struct observed_direct *direct) {
    struct pixel_trace_ray *ray = ray_of(pixel_trace);
    if (!ray)
        return;
    ray->ambient_light = direct->ambient_light;
    ray->ambient = direct->ambient;
    ray->has_photons = direct->has_photons;
    ray->photons = direct->photons;
    ray->direct = direct->direct;
}

static void record_vertex(struct pixel_trace *pixel_trace, const struct observed_vertex *vertex) {
    struct pixel_trace_ray *ray = ray_of(pixel_trace);
    if (!ray)
        return;
    ray->is_vertex = true;
    ray->vertex = *vertex;
    ray->has_photons = vertex->has_photons;
    ray->photons = vertex->photons;
    ray->direct = vertex->direct;
}

static void record_pixel(struct pixel_trace *pixel_trace, const struct observed_pixel *pixel) {
    pixel_trace->full = pixel->full;
    pixel_trace->marked = pixel->samples > 0;
    pixel_trace->samples = pixel->samples;
    for (struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next)
        sample->counts = sample->number > 0 || pixel->first_counts;
    pixel_trace->rgb[0] = (float)pixel->colour.r;
    pixel_trace->rgb[1] = (float)pixel->colour.g;
    pixel_trace->rgb[2] = (float)pixel->colour.b;
}

static void notice(void *context, const struct observation *what) {
    struct pixel_trace *pixel_trace = context;
    switch (what->kind) {
    case OBSERVED_SAMPLE_BEGIN:
        begin_sample(pixel_trace, what->sample.position);
        break;
    case OBSERVED_SAMPLE_END:
        end_sample(pixel_trace, what->sample.position, what->sample.colour);
        break;
    case OBSERVED_SPLIT:
        split_rays(pixel_trace, what->part);
        break;
    case OBSERVED_RAY_SENT:
        send_ray(pixel_trace, what->sent.kind, what->sent.weight, what->sent.cut);
        break;
    case OBSERVED_RAY_BEGIN:
        begin_ray(pixel_trace, &what->begin);
        break;
    case OBSERVED_MATERIAL:
        add_link(pixel_trace, what->material.link, what->material.inputs);
        break;
    case OBSERVED_SURFACE:
        record_surface(pixel_trace, what->surface);
        break;
    case OBSERVED_LIGHT_BEGIN:
        begin_light(pixel_trace, what->light.number, what->light.light, what->light.primitive);
        break;
    case OBSERVED_LIGHT_SAMPLE:
        record_light_position(pixel_trace, &what->position);
        break;
    case OBSERVED_SHADOW_RAYS:
        count_shadow_rays(pixel_trace, &what->shadow);
        break;
    case OBSERVED_LIGHT_END:
        end_light(pixel_trace, what->light.colour);
        break;
    case OBSERVED_LIGHT_SKIPPED:
        skip_light(pixel_trace, what->light.number, what->light.light);
        break;
    case OBSERVED_DIRECT:
        record_direct(pixel_trace, &what->direct);
        break;
    case OBSERVED_VERTEX:
        record_vertex(pixel_trace, &what->vertex);
        break;
    case OBSERVED_RAY_END:
        end_ray(pixel_trace, &what->end);
        break;
    case OBSERVED_PIXEL:
        record_pixel(pixel_trace, &what->pixel);
        break;
    case OBSERVED_MARK:
        pixel_trace->mark = what->mark;
        break;
    }
}

void pixel_trace_init(struct pixel_trace *pixel_trace, uint32_t x, uint32_t y) {
    *pixel_trace = (struct pixel_trace){.x = x, .y = y, .observer = {notice, pixel_trace}};
}

void pixel_trace_destroy(struct pixel_trace *pixel_trace) {
    arena_destroy(&pixel_trace->arena);
}
