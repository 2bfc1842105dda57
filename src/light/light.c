/* Places on lights. A disc is the square mapped concentrically (Shirley and Chiu, "A Low Distortion Map Between Disk
 * and Square", JGT 1997). A lamp that is a sphere is sampled by solid angle within its cone (Shirley, Wang, Zimmerman,
 * "Monte Carlo Techniques for Direct Lighting Calculations", TOG 1996), so every sample counts the same and the
 * emitter's cosine is in it already; so is a rectangle (light_rectangle.c), and a disc seen large by way of its square.
 * Other discs and parallelograms and meshes are sampled by area with weight cos / (pi d^2) each, triangles of a mesh in
 * proportion to the light they send. */
#include "light/light.h"

#include "light/sky_light.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "math/range.h"

static const double pi = 3.14159265358979323846;
/* A disc whose square fills more than this solid angle is sampled by that of the square, though a fifth of the square
 * is not of the disc: bench/lamps.c. */
static const double disc_by_angle = 1.5;

/* Where a falloff passes through zero, or a light is touched. A colour times it is finite. */
static const double strongest = 1e200;

double light_attenuation(const struct light *light, double distance) {
    const double *c = light->falloff;
    switch (light->fading) {
    case FADING_RANGE:
        return distance < light->range ? 1 - distance / light->range : 0;
    case FADING_INVERSE_SQUARE:
        return number_clamped(light->intensity / (distance * distance), strongest);
    case FADING_COEFFICIENTS:
        break;
    }
    if (c[0] == 0 && c[1] == 0 && c[2] == 0)
        return 1;
    return number_clamped(1 / (c[0] + c[1] * distance + c[2] * distance * distance), strongest);
}

double light_cone(const struct light *light, struct vec3 from_light) {
    if (light->kind != LIGHT_SPOT)
        return 1;
    double cosine = vec3_dot(light->direction, from_light);
    if (cosine >= light->cos_inner)
        return 1;
    if (cosine <= light->cos_outer)
        return 0;
    double s = (cosine - light->cos_outer) / (light->cos_inner - light->cos_outer);
    return s * s * (3 - 2 * s);
}

static bool behind(const struct light *light, struct vec3 normal, struct vec3 from) {
    return light->emits && light->one_sided && !(vec3_dot(normal, vec3_sub(from, light->position)) > 0);
}

static void square_around(struct light_frame *out, struct vec3 centre, double half) {
    out->edge1 = vec3_scale(out->right, 2 * half);
    out->edge2 = vec3_scale(out->up, 2 * half);
    out->corner = vec3_add_scaled(vec3_add_scaled(centre, out->right, -half), out->up, -half);
}

static bool sphere_frame(const struct light *light, struct vec3 from, struct light_frame *out) {
    struct vec3 to_centre = vec3_sub(light->position, from);
    double distance = vec3_length(to_centre);
    if (!(distance > light->radius))
        return false;
    double sine = light->radius / distance;
    out->distance = distance;
    out->axis = vec3_scale(to_centre, 1 / distance);
    frame_tangents(out->axis, &out->right, &out->up);
    out->cos_cone = sqrt((1 - sine) * (1 + sine));
    if (!(out->cos_cone > 0))
        return false;
    /* 1 - cos without cancellation. The mean of weight * (n.l) is 2 (1 - cos) * mean(n.l): solid angle over pi. */
    out->weight = 2 * sine * sine / (1 + out->cos_cone);
    /* The cone's section through the centre, a little larger than the sphere; targets lie before it. */
    square_around(out, light->position, light->radius / out->cos_cone);
    return true;
}

/* A square behind all of the mesh, across the cone that its ball fills; none for a point in the ball. */
static void mesh_frame(const struct light_mesh *mesh, struct vec3 from, struct light_frame *out) {
    struct vec3 to_centre = vec3_sub(mesh->centre, from);
    double distance = vec3_length(to_centre), sine = mesh->radius / distance;
    out->bounded = sine < 0.999;
    if (!out->bounded)
        return;
    out->axis = vec3_scale(to_centre, 1 / distance);
    frame_tangents(out->axis, &out->right, &out->up);
    double behind = (distance + mesh->radius) * 1.001;
    square_around(out, vec3_add_scaled(from, out->axis, behind), behind * sine / sqrt((1 - sine) * (1 + sine)));
}

bool light_frame_make(const struct light *light, struct vec3 from, struct light_frame *out) {
    *out = (struct light_frame){.weight = 1, .bounded = true};
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM: {
        struct vec3 normal = vec3_cross(light->edge1, light->edge2);
        out->corner = light->corner;
        out->edge1 = light->edge1;
        out->edge2 = light->edge2;
        out->weight = vec3_length(normal) / pi;
        out->axis = vec3_normalize(normal);
        out->by_angle =
            light->emits && spherical_rectangle_make(light->corner, light->edge1, light->edge2, from, &out->seen);
        return !behind(light, normal, from);
    }
    case LIGHT_DISC:
        out->axis = light->direction;
        frame_tangents(out->axis, &out->right, &out->up);
        square_around(out, light->position, light->radius);
        out->weight = light->radius * light->radius;
        out->by_angle = light->emits &&
                        spherical_rectangle_make(out->corner, out->edge1, out->edge2, from, &out->seen) &&
                        out->seen.angle > disc_by_angle;
        return !behind(light, light->direction, from);
    case LIGHT_SPHERE:
        return sphere_frame(light, from, out);
    case LIGHT_MESH:
        mesh_frame(light->mesh, from, out);
        return light->mesh->count > 0;
    case LIGHT_SKY:
        out->bounded = false;
        return true;
    case LIGHT_POINT:
    case LIGHT_DIRECTIONAL:
    case LIGHT_SPOT:
        break;
    }
    return true;
}

struct vec3 light_target(const struct light *light, const struct light_frame *frame, struct vec3 from,
                         struct sample2 place) {
    if (frame->by_angle)
        return spherical_rectangle_point(&frame->seen, place);
    if (light->kind == LIGHT_PARALLELOGRAM)
        return vec3_add_scaled(vec3_add_scaled(light->corner, light->edge1, place.x), light->edge2, place.y);
    struct sample2 round = sample_disc(place);
    if (light->kind == LIGHT_DISC) {
        struct vec3 target = vec3_add_scaled(light->position, frame->right, light->radius * round.x);
        return vec3_add_scaled(target, frame->up, light->radius * round.y);
    }
    /* Uniform in the cone: 1 - cos grows with the square of the place's distance from the middle. */
    double squared = round.x * round.x + round.y * round.y;
    double drop = squared * frame->weight / 2, cosine = 1 - drop; /* weight / 2 = 1 - cos of the cone */
    double sine = sqrt(drop * (2 - drop)), radius = sqrt(squared);
    double x = radius > 0 ? sine * round.x / radius : 0, y = radius > 0 ? sine * round.y / radius : 0;
    struct vec3 direction = vec3_add_scaled(vec3_scale(frame->axis, cosine), frame->right, x);
    direction = vec3_add_scaled(direction, frame->up, y);
    /* The near crossing with the sphere. */
    double along = frame->distance * cosine, off = frame->distance * sine;
    double half = light->radius * light->radius - off * off;
    return vec3_add_scaled(from, direction, along - (half > 0 ? sqrt(half) : 0));
}

/* Uniform on the triangle that the place's x falls on, whose share is spread over the unit interval again. */
struct light_point light_mesh_point(const struct light_mesh *mesh, struct sample2 place) {
    uint32_t low = 0, high = mesh->count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (mesh->until[middle] > place.x)
            high = middle;
        else
            low = middle + 1;
    }
    double begin = low > 0 ? mesh->until[low - 1] : 0, share = mesh->until[low] - begin;
    double x = share > 0 ? (place.x - begin) / share : 0.5, root = sqrt(x < 1 ? x : 1);
    const struct light_triangle *t = &mesh->triangles[low];
    struct vec3 point = vec3_add_scaled(t->corner, t->edge1, root * (1 - place.y));
    return (struct light_point){t, vec3_add_scaled(point, t->edge2, root * place.y)};
}

static struct light_sample mesh_sample(const struct light_mesh *mesh, struct vec3 from, struct sample2 place) {
    struct light_point at = light_mesh_point(mesh, place);
    const struct light_triangle *t = at.triangle;
    struct vec3 point = at.place;
    struct vec3 away = vec3_sub(from, point);
    double squared = vec3_length_squared(away), across = vec3_dot(t->normal, away);
    double weight = squared > 0 && (across > 0 || !mesh->one_sided) ? fabs(across) / (squared * sqrt(squared)) : 0;
    return (struct light_sample){vec3_add_scaled(point, t->normal, across > 0 ? t->offset : -t->offset),
                                 vec3_scale(t->light, weight)};
}

struct light_sample light_sample_lamp(const struct light *light, const struct light_frame *frame, struct vec3 from,
                                      struct sample2 place) {
    if (light->kind == LIGHT_MESH)
        return mesh_sample(light->mesh, from, place);
    struct light_sample sample;
    if (light->kind == LIGHT_SKY) {
        sample.light = vec3_mul(sky_table_sample(light->sky, light->table, place, &sample.target), light->colour);
        return sample;
    }
    sample.target = light_target(light, frame, from, place);
    double weight = frame->weight;
    if (frame->by_angle) {
        struct vec3 off = vec3_sub(sample.target, light->position);
        bool beside = light->kind == LIGHT_DISC && vec3_length_squared(off) > light->radius * light->radius;
        weight = beside ? 0 : frame->seen.angle / pi;
    } else if (light->kind != LIGHT_SPHERE) {
        struct vec3 away = vec3_sub(from, sample.target);
        double squared = vec3_length_squared(away), cosine = fabs(vec3_dot(frame->axis, away));
        weight = squared > 0 ? weight * cosine / (squared * sqrt(squared)) : 0;
    }
    sample.light = vec3_scale(light->colour, weight);
    return sample;
}

bool light_meets_ray(const struct light *light, const struct ray *ray, double *t) {
    struct vec3 d = ray->direction;
    if (light->kind == LIGHT_MESH || light->kind == LIGHT_SKY)
        return false; /* a mesh is seen where the scene shows it, a sky is the background */
    if (light->kind == LIGHT_SPHERE) {
        struct vec3 o = vec3_sub(ray->origin, light->position);
        double a = vec3_dot(d, d), b = vec3_dot(o, d);
        /* The squared distance of the line from the centre, without cancellation. */
        struct vec3 nearest = vec3_add_scaled(o, d, -b / a);
        double half = light->radius * light->radius - vec3_dot(nearest, nearest);
        if (!(half > 0))
            return false;
        double root = sqrt(half / a);
        *t = -b / a - root;
        if (*t > ray->t_min && *t < ray->t_max)
            return true;
        *t = -b / a + root;
        return *t > ray->t_min && *t < ray->t_max;
    }
    struct vec3 normal = light->kind == LIGHT_DISC ? light->direction : vec3_cross(light->edge1, light->edge2);
    double across = vec3_dot(normal, d);
    if (across == 0 || (light->one_sided && across > 0))
        return false;
    struct vec3 on_plane = light->kind == LIGHT_DISC ? light->position : light->corner;
    *t = vec3_dot(normal, vec3_sub(on_plane, ray->origin)) / across;
    if (!(*t > ray->t_min && *t < ray->t_max))
        return false;
    struct vec3 p = vec3_sub(ray_at(ray, *t), on_plane);
    if (light->kind == LIGHT_DISC)
        return vec3_dot(p, p) < light->radius * light->radius;
    double n2 = vec3_dot(normal, normal);
    double u = vec3_dot(vec3_cross(p, light->edge2), normal) / n2;
    double v = vec3_dot(vec3_cross(light->edge1, p), normal) / n2;
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}
