/* The picture of a scene that names no camera and no light: the camera fits the scene, and the light is that of a
 * photographer's studio. Everything is a multiple of the scene's size, so that scaled scenes have the same picture. */
#include "script/studio_internal.h"

#include "math/elementary.h"
#include "scene/node_bounds.h"
#include "scene/traversal.h"

#include <math.h>

/* Right, up and back of a camera, unit. */
struct camera_axes {
    struct vec3 right, up, back;
};

/* From the front, right and above. */
static const struct vec3 default_view = {-0.4, -0.35, -1};

static struct camera_axes axes_of(struct vec3 view, struct vec3 up) {
    struct vec3 back = vec3_negate(vec3_normalize(view)), right = vec3_cross(up, back);
    if (vec3_max_abs(right) <= 1e-9 * vec3_max_abs(up))
        right = vec3_cross(fabs(back.y) < 0.9 ? vec3_make(0, 1, 0) : vec3_make(0, 0, -1), back);
    right = vec3_normalize(right);
    return (struct camera_axes){right, vec3_cross(back, right), back};
}

static struct vec3 along_axes(const struct camera_axes *axes, struct vec3 v) {
    struct vec3 across = vec3_add(vec3_scale(axes->right, v.x), vec3_scale(axes->up, v.y));
    return vec3_add(across, vec3_scale(axes->back, v.z));
}

/* The box of the scene along the axes of a camera, without endless parts. A scene of endless parts alone counts as
 * large, one of nothing as a unit. */
static struct box box_along(struct node *root, const struct camera_axes *axes) {
    struct node_child child = {root, NULL};
    struct node turned = {.name = "", .first_child = &child, .last_child = &child, .child_count = 1};
    turned.parent_from_node = transform_identity();
    const struct vec3 rows[] = {axes->right, axes->up, axes->back};
    for (int i = 0; i < 3; i++) {
        const double row[] = {rows[i].x, rows[i].y, rows[i].z};
        for (int k = 0; k < 3; k++)
            turned.parent_from_node.forward.m[i][k] = turned.parent_from_node.inverse.m[k][i] = row[k];
    }
    struct box box, whole;
    struct error ignored = {0};
    bool measured = node_finite_bounds(&turned, &box, &ignored);
    if (measured && !box_is_empty(&box) && vec3_max_abs(vec3_sub(box.max, box.min)) > 0)
        return box;
    bool endless = node_bounds(&turned, &whole, &ignored) && !box_is_empty(&whole);
    double half = endless ? 10 : 1;
    return (struct box){vec3_all(-half), vec3_all(half)};
}

struct framed studio_frame(struct node *root, const struct framing *framing) {
    const double tall = 0.7, wide = 0.8, edge = 0.95; /* parts of the picture that the scene fills, and may fill */
    bool chosen = vec3_max_abs(framing->view) > 0;
    struct vec3 up = vec3_max_abs(framing->up) > 0 ? framing->up : vec3_make(0, 1, 0);
    struct camera_axes axes = axes_of(chosen ? framing->view : default_view, up);
    struct box box = box_along(root, &axes);

    /* The middle, and how far the scene extends from it. */
    struct vec3 middle = vec3_scale(vec3_add(box.min, box.max), 0.5);
    if (framing->target)
        middle = vec3_make(vec3_dot(axes.right, *framing->target), vec3_dot(axes.up, *framing->target),
                           vec3_dot(axes.back, *framing->target));
    struct vec3 half = vec3_max(vec3_sub(box.max, middle), vec3_sub(middle, box.min));

    /* The scene is measured at its middle; its nearest side must fit, too. */
    double slope = el_tan(framing->fov * (PI / 360));
    double distance = math_max(half.y / tall, half.x / (wide * framing->aspect)) / slope;
    double near = half.z + math_max(half.y, half.x / framing->aspect) / (edge * slope);
    distance = math_max(distance, near);
    struct vec3 target = along_axes(&axes, middle);
    return (struct framed){.eye = vec3_add_scaled(target, axes.back, distance),
                           .target = target,
                           .distance = distance,
                           .view_height = 2 * math_max(half.y / tall, half.x / (wide * framing->aspect))};
}

static bool shines(const struct material *material) {
    return material &&
           (colour_max_abs(material_emission_bound(material)) > 0 || material_origin(material)->phong.unlit);
}

bool studio_is_dark(const struct scene *scene, const struct node *root, struct arena *arena, bool *dark,
                    struct error *error) {
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true};
    enum scene_event event;
    /* A node under many parents is looked at once: there may be more paths than anything can count. */
    bool *seen = arena_alloc_array(arena, scene->node_total, sizeof *seen);
    if (!seen)
        return error_no_memory(error, "a scene");
    *dark = true;
    scene_traversal_begin(&t, root);
    while ((event = scene_traversal_next(&t)) < SCENE_END && *dark) {
        const struct node *node = scene_traversal_node(&t);
        if (event != SCENE_ENTER)
            continue;
        if (seen[node->index]) {
            scene_traversal_skip(&t);
            continue;
        }
        seen[node->index] = true;
        *dark = !shines(node->kind == NODE_GEOMETRY || node->kind == NODE_CSG ? node->material : NULL);
        for (uint32_t i = 0; node->kind == NODE_GEOMETRY && !node->material && i < node->slot_count && *dark; i++)
            *dark = !shines(node->slots[i]);
    }
    scene_traversal_end(&t);
    return event != SCENE_NO_MEMORY || error_no_memory(error, "a scene");
}

/* A square soft box: far enough away that all of the scene has the same light, to that direction. `light`: what a white
 * surface that faces it reflects. `radius`: of the scene, or of all that is to have the same light. */
static struct scene_light soft_box(const struct camera_axes *axes, struct vec3 middle, double radius,
                                   struct vec3 direction, double light) {
    const double far = 30, side = 18; /* in radii */
    struct vec3 to = vec3_normalize(along_axes(axes, direction));
    struct camera_axes own = axes_of(vec3_negate(to), axes->up);
    struct vec3 position = vec3_add_scaled(middle, to, far * radius);
    struct vec3 edge1 = vec3_scale(own.right, side * radius), edge2 = vec3_scale(own.up, side * radius);
    struct vec3 corner = vec3_sub(position, vec3_scale(vec3_add(edge1, edge2), 0.5));
    double radiance = light * PI * (far / side) * (far / side);
    return (struct scene_light){.light = {.kind = LIGHT_PARALLELOGRAM,
                                          .position = position,
                                          .corner = corner,
                                          .edge1 = edge1,
                                          .edge2 = edge2,
                                          .colour = colour_all(radiance),
                                          .falloff = {1, 0, 0},
                                          .emissive = true,
                                          .visible = true}};
}

/* Directions along the axes of the camera, and the light on a white surface that faces them: {display, linear}. */
static const struct soft_light {
    struct vec3 to;
    double light[2];
} soft_lights[STUDIO_LIGHTS] = {{{-0.6, 0.7, 1.1}, {0.52, 0.42}}, {{0.9, 0.15, 0.8}, {0.15, 0.06}}};
static const double ambient[2] = {0.44, 0.35}, even_sky = 0.3;
static const double ground_radius = 64;    /* of what a camera sees of the ground, in radii of the scene */
static const double before_even = 4.0 / 3; /* factor of the boxes: the even background is not bright */

void studio_light(struct render_request *request, bool even, struct scene_light lights[STUDIO_LIGHTS]) {
    /* {y of the direction, r, g, b}: light from the sky of a path. */
    static const double stops[][4] = {{-1, 0.28, 0.28, 0.28}, {0, 0.52, 0.52, 0.52}, {1, 0.46, 0.46, 0.46}};
    const struct camera *camera = &request->camera;
    bool linear = settings_linear(&request->settings);
    bool is_path = integrator_traits(request->settings.integrator).sky_lights;
    struct vec3 view = request->settings.view_is_target ? vec3_sub(camera->view, camera->eye) : camera->view;
    bool has_view = vec3_max_abs(view) > 0;
    struct camera_axes axes = axes_of(has_view ? view : vec3_make(0, 0, -1), camera->up);
    struct box box = box_along(request->root, &axes);
    struct vec3 middle = along_axes(&axes, vec3_scale(vec3_add(box.min, box.max), 0.5));
    double radius = (even ? ground_radius : 1) * 0.5 * vec3_length(vec3_sub(box.max, box.min));
    for (int i = 0; i < STUDIO_LIGHTS; i++)
        lights[i] =
            soft_box(&axes, middle, radius, soft_lights[i].to, (even ? before_even : 1) * soft_lights[i].light[linear]);
    request->lights = lights;
    request->light_count = STUDIO_LIGHTS;
    if (is_path) {
        request->sky = (struct sky){.kind = SKY_STOPS, .stops = stops, .stop_count = 3};
        request->sky_chosen = true;
    } else {
        request->ambient = colour_all(ambient[linear]);
    }
    if (even)
        request->sky = (struct sky){.kind = SKY_CONSTANT, .colour = colour_all(even_sky)};
}

double studio_ground(const struct settings *settings, struct vec3 view) {
    const double facing = 0.893; /* of a soft box of that size, which is near: its solid angle is smaller */
    struct camera_axes axes = axes_of(vec3_max_abs(view) > 0 ? view : default_view, vec3_make(0, 1, 0));
    bool linear = settings_linear(settings);
    double light = integrator_traits(settings->integrator).sky_lights ? even_sky : ambient[linear];
    for (int i = 0; i < STUDIO_LIGHTS; i++)
        light += facing * before_even * soft_lights[i].light[linear] *
                 math_max(vec3_normalize(along_axes(&axes, soft_lights[i].to)).y, 0);
    return even_sky / light;
}
