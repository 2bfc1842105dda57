/* Image coordinates as functions of space, which a surface inherits: u and v have gradients, and on the surface the
 * point moves with u so that v stays and with v so that u stays. Both ways lie in the tangent plane, which gives them
 * as the dual basis of the two gradients there (any book on tensors): with the normal n, dp/du = grad v x n / d, dp/dv
 * = n x grad u / d,   d = n . (grad u x grad v). Where the surface holds the direction of sight, d is 0 and the picture
 * is drawn out without end; d is kept off 0, so that all numbers stay finite. surface_mapping_axes: Duff et al.,
 * "Building an Orthonormal Basis, Revisited", JCGT 2017. */
#include "geometry/surface_mapping.h"

#include "math/elementary.h"

#define TURN 6.28318530717958647692
#define STEEPEST 0x1p-20

void surface_mapping_axes(struct vec3 n, struct vec3 *x, struct vec3 *z) {
    double sign = n.y < 0 ? -1 : 1, s = -1 / (sign + n.y), c = n.x * n.z * s;
    *x = vec3_make(1 + sign * n.x * n.x * s, -sign * n.x, sign * c);
    *z = vec3_make(c, -n.z, sign + n.z * n.z * s);
}

/* along_u, along_v: unit vectors at right angles, the ways in which u and v grow; a step of one unit of u or v is
 * size_u or size_v > 0 long where the surface faces the eye. */
static void take(double u, double v, struct vec3 along_u, struct vec3 along_v, double size_u, double size_v,
                 struct surface *out) {
    struct vec3 n = vec3_normalize(out->normal);
    double facing = vec3_dot(n, vec3_cross(along_u, along_v));
    bool away = facing >= 0;
    if (!away) {
        along_u = vec3_negate(along_u);
        facing = -facing;
    }
    facing = fmax(facing, STEEPEST);
    out->has_uv = true;
    out->u = away ? u : 1 - u;
    out->v = v;
    out->dpdu = vec3_scale(vec3_cross(along_v, n), size_u / facing);
    out->dpdv = vec3_scale(vec3_cross(n, along_u), size_v / facing);
}

void surface_mapping_sphere(struct vec3 centre, struct surface *out) {
    struct vec3 arm = vec3_sub(out->point, centre);
    double far = vec3_length(arm);
    if (!(far > 0)) { /* at the centre every direction is as good */
        arm = vec3_normalize(out->normal);
        far = vec3_length(arm);
    }
    struct vec3 n = vec3_scale(arm, 1 / far);
    double ring = sqrt(n.x * n.x + n.z * n.z), y = n.y < -1 ? -1 : n.y > 1 ? 1 : n.y;
    double cosine = ring > 0 ? n.x / ring : 1, sine = ring > 0 ? n.z / ring : 0;
    struct vec3 along_u = vec3_make(sine, 0, -cosine), along_v = vec3_make(-y * cosine, ring, -y * sine);
    take(0.5 - el_atan2(n.z, n.x) / TURN, 0.5 + el_asin(y) / (TURN / 2), along_u, along_v, TURN * ring * far,
         TURN / 2 * far, out);
}

void surface_mapping_label(struct vec3 base, struct vec3 axis, double length, struct surface *out) {
    struct vec3 arm = vec3_sub(out->point, base), x, z;
    surface_mapping_axes(axis, &x, &z);
    double height = vec3_dot(arm, axis), p = vec3_dot(arm, x), q = vec3_dot(arm, z), radius = sqrt(p * p + q * q);
    double cosine = radius > 0 ? p / radius : 1, sine = radius > 0 ? q / radius : 0;
    struct vec3 along_u = vec3_sub(vec3_scale(x, sine), vec3_scale(z, cosine));
    take(0.5 - el_atan2(q, p) / TURN, height / length, along_u, axis, TURN * radius, length, out);
}
