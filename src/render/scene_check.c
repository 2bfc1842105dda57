/* See scene_check.h. It reads bounds and materials; of rays there are GRID_SIDE x GRID_SIDE, only if the eye is inside
 * a solid. What it cannot decide by bounds (a lens, two eyes, fisheyes, shapes without end) gets no notice. */
#include "render/scene_check.h"

#include "material/material.h"
#include "material/openpbr.h"
#include "render/camera.h"
#include "render/sample_internal.h"
#include "scene/node.h"
#include "world/world_describe.h"

#include <stdarg.h>
#include <stdio.h>

enum { GRID_SIDE = 5, LIGHTS_CHECKED = 64, NOTICE_SIZE = 512 };

struct check {
    const struct render_job *job;
    const struct world *world;
    struct camera_frame camera;
    struct world_scratch scratch;
    struct box bounds; /* of all shapes */
    unsigned *noticed;
    world_warning *notice;
    void *context;
};

__attribute__((format(printf, 3, 4))) static void give(const struct check *check, enum scene_fault kind,
                                                       const char *format, ...) {
    char text[NOTICE_SIZE];
    va_list arguments;
    if (*check->noticed >> kind & 1)
        return;
    *check->noticed |= 1u << kind;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    check->notice(check->context, text);
}

/* --- shapes in view --- */

/* That of the eye, and the four planes through the edges of the picture; a point is in view if every product with
 * `inwards`, from `origin`, is positive. */
struct view_planes {
    struct vec3 origin[5], inwards[5];
};

/* False: the picture has no such planes. */
static bool make_planes(const struct camera_frame *camera, struct view_planes *out) {
    const struct lens *lens = &camera->lens;
    bool is_planar = lens->projection == PROJECTION_PERSPECTIVE || lens->projection == PROJECTION_ORTHOGRAPHIC;
    struct ray corner[4];
    if (!is_planar || lens->aperture > 0 || camera_has_views(camera))
        return false;
    for (int i = 0; i < 4; i++) {
        double x = i == 1 || i == 2 ? camera->width : 0, y = i >= 2 ? camera->height : 0;
        if (!camera_ray_through(camera, x, y, (struct sample2){0.5, 0.5}, NULL, &corner[i]))
            return false;
    }
    struct vec3 middle = vec3_scale(vec3_add(ray_at(&corner[0], 1), ray_at(&corner[2], 1)), 0.5);
    for (int i = 0; i < 4; i++) {
        const struct ray *a = &corner[i], *b = &corner[(i + 1) % 4];
        struct vec3 normal = vec3_cross(a->direction, vec3_sub(ray_at(b, 1), a->origin));
        bool points_in = vec3_dot(normal, vec3_sub(middle, a->origin)) > 0;
        out->origin[i + 1] = a->origin;
        out->inwards[i + 1] = points_in ? normal : vec3_negate(normal);
    }
    out->origin[0] = camera->eye;
    out->inwards[0] = camera->forward;
    return true;
}

/* The first plane that all of the box is behind, or -1. */
static int plane_before(const struct view_planes *planes, const struct box *box) {
    for (int i = 0; i < 5; i++) {
        struct vec3 n = planes->inwards[i];
        struct vec3 farthest = {n.x > 0 ? box->max.x : box->min.x, n.y > 0 ? box->max.y : box->min.y,
                                n.z > 0 ? box->max.z : box->min.z};
        if (vec3_dot(n, vec3_sub(farthest, planes->origin[i])) <= 0)
            return i;
    }
    return -1;
}

static bool is_bounded(const struct box *box) {
    return vec3_finite(box->min) && vec3_finite(box->max);
}

/* Whether something is in view. */
static bool check_view(const struct check *check) {
    const struct world *world = check->world;
    const struct box *all = &check->bounds;
    struct view_planes planes;
    if (!is_bounded(all) || !make_planes(&check->camera, &planes))
        return true;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        if (!box_is_empty(&world->boxes[i]) && plane_before(&planes, &world->boxes[i]) < 0)
            return true;
    }
    bool behind = plane_before(&planes, all) == 0;
    give(check, FAULT_VIEW, "nothing is in view: the shapes lie between {%.4g, %.4g, %.4g} and {%.4g, %.4g, %.4g}, %s",
         all->min.x, all->min.y, all->min.z, all->max.x, all->max.y, all->max.z,
         behind ? "behind the eye (see eye and view)" : "outside of the picture (see eye, view and fov)");
    return false;
}

static void check_size(const struct check *check) {
    const struct box *all = &check->bounds;
    const struct camera_frame *camera = &check->camera;
    bool is_planar = camera->lens.projection == PROJECTION_PERSPECTIVE;
    double size = vec3_length(vec3_sub(all->max, all->min));
    double distance = vec3_length(vec3_sub(vec3_scale(vec3_add(all->min, all->max), 0.5), camera->eye));
    double pixel = vec3_length(camera->right) * (is_planar ? distance : 1);
    if (is_bounded(all) && size < pixel && size > 0)
        give(check, FAULT_SIZE, "all shapes together are smaller than a pixel: %.3g units, %.4g units from the eye",
             size, distance);
}

/* --- light --- */

static bool shows_without_light(const struct check *check) {
    const struct render_job *job = check->job;
    const struct world *world = check->world;
    bool paths = integrator_traits(job->settings.integrator).sky_lights;
    bool sky = !sky_is_black(&world->sky) && (!paths || job->background_lights);
    if (job->settings.style == STYLE_INK || medium_brightest(world_outside(world)) > 0 || world_outside(world)->fog ||
        world->emission_bound > 0 || (paths && sky) || (!paths && colour_max_abs(job->ambient) > 0))
        return true;
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct surface_material *material = &world->surfaces.materials[i];
        if (material->phong.unlit || colour_max_abs(surface_emission_bound(&world->surfaces, material)) > 0 ||
            (sky && surface_specular(material) > 0))
            return true;
    }
    return false;
}

static void check_light(const struct check *check) {
    const struct world *world = check->world;
    bool paths = integrator_traits(check->job->settings.integrator).sky_lights;
    if (shows_without_light(check))
        return;
    for (uint32_t i = 0; i < world->light_count; i++) {
        if (light_brightest(&world->lights[i]) > 0)
            return;
    }
    give(check, FAULT_LIGHT, "there is no light%s%s",
         world->light_count > 0 ? ": every light is black, as a sun below the horizon is, and the shapes are too"
                                : ", and the shapes are black: no lights, no ",
         world->light_count > 0 ? ""
         : paths                ? "sky or background that shines, no emission"
                                : "ambient, no emission");
}

/* --- what has no effect --- */

/* The name of an input that does nothing in this material, and what it needs; NULL: there is none. */
static const char *lone_input(const struct surface_material *material, const char **needs) {
    const struct phong *numbers = &material->phong;
    bool mirrors = numbers->reflect > 0 || surface_has_texture(material, INPUT_REFLECT) || material->fresnel;
    bool refracts = numbers->refract > 0 || surface_has_texture(material, INPUT_REFRACT) || material->fresnel;
    if (material->has_layers)
        return NULL;
    *needs = "refract";
    if (numbers->has_ior && numbers->ior != 1 && !mirrors && !refracts)
        return "ior";
    if (colour_max_abs(numbers->absorption) > 0 && !refracts)
        return "absorption";
    *needs = "reflect or refract";
    return numbers->roughness > 0 && !mirrors && !refracts ? "roughness" : NULL;
}

static void check_materials(const struct check *check) {
    const struct world *world = check->world;
    bool focuses = false;
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct surface_material *material = &world->surfaces.materials[i];
        const char *needs, *input = lone_input(material, &needs), *name = world->authored.materials[i]->name;
        focuses = focuses || surface_specular(material) > 0;
        if (input)
            give(check, FAULT_FIELD, "%s has no effect in a material without %s%s%.100s%s", input, needs,
                 name ? " ('" : "", name ? name : "", name ? "')" : "");
    }
    if (check->job->settings.caustics.photons > 0 && !focuses)
        give(check, FAULT_CAUSTICS, "caustics have no effect: nothing in the scene mirrors or refracts light");
}

/* --- insides --- */

static bool passes_light(const struct world *world, uint32_t material) {
    return world->material_has_medium[material] || surface_has_holes(&world->surfaces.materials[material]);
}

/* The innermost opaque solid that contains the point, or WORLD_NOTHING. */
static uint32_t enclosing_solid(struct check *check, struct vec3 point) {
    const struct box region = {point, point};
    uint32_t closed[WORLD_NESTING], enclosing[WORLD_NESTING];
    uint32_t count = world_closed_in(check->world, &region, closed, WORLD_NESTING);
    if (count > WORLD_NESTING)
        return WORLD_NOTHING;
    const struct inside_query query = {point, 0, closed, count};
    count = world_containing(check->world, &query, &check->scratch, enclosing, WORLD_NESTING);
    while (count > 0 && primitive_has_material(check->world, enclosing[count - 1], passes_light))
        count--;
    return count > 0 ? enclosing[count - 1] : WORLD_NOTHING;
}

/* Whether rays all over the picture meet this solid first. */
static bool fills_picture(struct check *check, uint32_t solid) {
    const struct camera_frame *camera = &check->camera;
    int met = 0;
    for (int i = 0; i < GRID_SIDE * GRID_SIDE; i++) {
        double x = (i % GRID_SIDE + 0.5) / GRID_SIDE, y = (i / GRID_SIDE + 0.5) / GRID_SIDE;
        struct ray ray;
        struct crossing crossing;
        uint32_t primitive;
        if (!camera_ray_through(camera, x * camera->width, y * camera->height, (struct sample2){0.5, 0.5}, NULL, &ray))
            continue;
        if (!world_nearest_crossing(check->world, &ray, &check->scratch, &primitive, &crossing) || primitive != solid)
            return false;
        met++;
    }
    return met > 0;
}

/* Solids that are made to be seen from inside: they shine, or have two sides. */
static bool is_room(const struct world *world, uint32_t solid) {
    const struct prototype *prototype = primitive_prototype(world, solid);
    if (prototype->geometry.csg)
        return false;
    const struct surface_material *material = &world->surfaces.materials[prototype->material];
    return material->phong.two_sided || material->phong.unlit ||
           colour_max_abs(surface_emission_bound(&world->surfaces, material)) > 0;
}

static void check_insides(struct check *check) {
    const struct world *world = check->world;
    /* A solid around the scene is a room; one around the eye alone is a mistake. */
    uint32_t room = enclosing_solid(check, check->camera.eye);
    if (room != WORLD_NOTHING && !is_room(world, room) && fills_picture(check, room))
        give(check, FAULT_EYE, "the eye is inside '%.100s', an opaque solid, and sees nothing else",
             primitive_node(world, room)->name);
    for (uint32_t i = 0; i < world->light_count && i < LIGHTS_CHECKED; i++) {
        const struct light *light = &world->lights[i];
        struct light_target middle;
        /* Lights with a list of nodes are placed on purpose. */
        if (light->lit || !light_middle(light, &middle) || middle.distant)
            continue;
        uint32_t solid = enclosing_solid(check, middle.at);
        if (solid != WORLD_NOTHING && solid != room)
            give(check, FAULT_LIGHT_INSIDE,
                 "the light at {%.4g, %.4g, %.4g} is inside '%.100s', an opaque solid, and lights nothing outside",
                 middle.at.x, middle.at.y, middle.at.z, primitive_node(world, solid)->name);
    }
}

static void origin_of(const struct node *node, char *text, size_t size) {
    if (node->line > 0)
        (void)snprintf(text, size, " (made at %.200s:%u)", node->file, (unsigned)node->line);
}

/* Names each such node, in one picture of a run. */
static void check_thin_walls(const struct check *check) {
    const struct settings *settings = &check->job->settings;
    const struct world *world = check->world;
    if ((!integrator_traits(settings->integrator).follows_paths && settings->caustics.photons == 0) ||
        (*check->noticed >> FAULT_THIN_WALL & 1))
        return;
    for (uint32_t i = 0; i < world->prototype_count; i++) {
        const struct node *node = world->authored.nodes[i];
        char position[256] = "";
        if (!world->prototypes[i].by_shape)
            continue;
        *check->noticed &= ~(1u << FAULT_THIN_WALL);
        origin_of(node, position, sizeof position);
        give(check, FAULT_THIN_WALL,
             "'%.100s' is transparent and open, so it is a thin wall, which does not refract (thin_walled = true says "
             "so, thin_walled = false refracts)%s",
             node->name, position);
    }
}

static void check_subsurface(const struct check *check) {
    const struct world *world = check->world;
    bool follows = integrator_traits(check->job->settings.integrator).follows_paths;
    for (uint32_t i = 0; i < world->material_count && !follows; i++)
        if (surface_walks(&world->surfaces.materials[i]))
            give(check, FAULT_SUBSURFACE,
                 "light that is scattered under a surface is shown as diffuse light of subsurface_color; "
                 "--integrator path follows it");
}

/* Photons are of single wavelengths under every integrator. */
static void check_dispersion(const struct check *check) {
    if (!integrator_traits(check->job->settings.integrator).follows_paths && world_disperses(check->world))
        give(check, FAULT_DISPERSION,
             "glass with dispersion is shown with one index of refraction; --integrator path divides the colours");
}

static void notice_empty(const struct check *check, const struct node *solid) {
    char position[256] = "";
    origin_of(solid, position, sizeof position);
    give(check, FAULT_SOLID, "'%.100s' is empty: nothing is left of its operands%s", solid->name, position);
}

void scene_check(const struct render_job *job, unsigned *noticed, world_warning *notice, void *context) {
    const struct world *world = job->world;
    struct check check = {job, world, .bounds = box_empty(), .noticed = noticed, .notice = notice, .context = context};
    char ignored[256];
    struct error error;
    /* A camera that moves, and a picture of the sky or the fog alone, may be what was meant. */
    bool has_fog = world_outside(world)->affects != 0, moves = job->settings.motion.moves || has_fog;
    if (!renderer_prepare_at(job, 0, &check.camera, ignored, &error))
        return;
    if (world->primitive_count == 0) {
        if (!has_fog && (world->sky.kind == SKY_CONSTANT || !job->background_lights))
            give(&check, FAULT_EMPTY,
                 "nothing is in view: the node has no shapes, neither itself nor below it (see node:add_child)");
        return;
    }
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        check.bounds = box_join(check.bounds, world->boxes[i]);
        if (box_is_empty(&world->boxes[i]) && primitive_geometry(world, i)->csg)
            notice_empty(&check, primitive_node(world, i));
    }
    check_materials(&check);
    check_thin_walls(&check);
    check_subsurface(&check);
    check_dispersion(&check);
    if (moves || check_view(&check)) {
        check_size(&check);
        check_light(&check);
        if (world_scratch_init(&check.scratch, world)) {
            check_insides(&check);
            world_scratch_destroy(&check.scratch);
        }
    }
}
