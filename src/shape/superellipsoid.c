/* The superellipsoid (Barr, "Superquadrics and Angle-Preserving Transformations", IEEE CG&A 1981), written as N(p) < 1
 * with N = |(|(x, z)|_p, y)|_q, p = 2/e, q = 2/n, where |(a, b)|_p = (a^p + b^p)^(1/p). N is homogeneous of degree one,
 * so it is well scaled for all exponents, and it grows with |x|, |y| and |z|.
 *
 * p, q >= 1: N is a norm, hence convex along the line. Newton's steps from outside then never pass the nearest root:
 * each tangent lies below N. They reach it, or come to where N no longer falls, and then there is none. Both ends are
 * found so.
 *
 * Else the line is cut where it changes octants. Inside one, |x|, |y|, |z| are linear and N is monotonic in each, so
 * the two corners of the piece bound N, and as the slopes of |.|_p depend monotonically on the ratio of its arguments
 * they bound the slope of N too. Pieces that cannot hold a root are dropped, monotonic ones are searched by bisection,
 * the rest are halved (interval Newton's exclusion test, Moore, "Interval Analysis", 1966) down to 2^-30 of the box:
 * two crossings closer than that, within a fold of the surface, may be missed together. */
#include "shape/superellipsoid.h"

#include "math/elementary.h"

/* |(a, b)|_p for a, b >= 0, and how it grows with each. */
struct norm {
    double value, da, db;
};

static struct norm norm_of(double a, double b, double p) {
    double max = math_max(a, b), min = math_min(a, b);
    if (!(max > 0))
        return (struct norm){0, 1, 1};
    double ratio = min / max, power = ratio > 0 ? el_pow(ratio, p) : 0, sum = 1 + power;
    double factor = el_pow(sum, 1 / p), d_max = factor / sum;
    double d_min = ratio > 0 ? d_max * power / ratio : p > 1 ? 0 : p < 1 ? INFINITY : 1;
    bool a_is_max = a >= b;
    return (struct norm){max * factor, a_is_max ? d_max : d_min, a_is_max ? d_min : d_max};
}

static double value_at(const struct superellipsoid *s, struct vec3 p) {
    double section = norm_of(fabs(p.x), fabs(p.z), 2 / s->e).value;
    return norm_of(section, fabs(p.y), 2 / s->n).value;
}

static double slope_part(double gradient, double coordinate, double direction) {
    return direction == 0 ? 0 : gradient * (coordinate < 0 ? -direction : direction);
}

/* N at a point and its slope along d, and the gradient; outward. */
static double value_and_slope(const struct superellipsoid *s, struct vec3 p, struct vec3 d, double *slope) {
    struct norm section = norm_of(fabs(p.x), fabs(p.z), 2 / s->e), all = norm_of(section.value, fabs(p.y), 2 / s->n);
    *slope = slope_part(all.da * section.da, p.x, d.x) + slope_part(all.db, p.y, d.y) +
             slope_part(all.da * section.db, p.z, d.z);
    return all.value;
}

/* The line measured from its point nearest to the middle, in units of the direction's length. */
struct measured_line {
    struct vec3 o, d;
    double shift, length, lo, hi;
};

static bool line_in_box(const struct ray *ray, struct measured_line *line) {
    double length = vec3_length(ray->direction);
    if (!(length > 0) || !isfinite(length))
        return false;
    line->length = length;
    line->d = vec3_normalize(ray->direction);
    line->shift = -vec3_dot(ray->origin, line->d);
    line->o = vec3_add_scaled(ray->origin, line->d, line->shift);
    line->lo = -INFINITY;
    line->hi = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double o = vec3_get(line->o, axis), d = vec3_get(line->d, axis);
        if (d == 0) {
            if (!(fabs(o) < 1))
                return false;
            continue;
        }
        double near = (d > 0 ? -1 - o : 1 - o) / d, far = (d > 0 ? 1 - o : -1 - o) / d;
        line->lo = math_max(line->lo, near);
        line->hi = math_min(line->hi, far);
    }
    return line->lo < line->hi;
}

/* ---- convex ---- */

/* From outside at t along the sign; false when N stops falling first. */
static bool newton(const struct superellipsoid *s, const struct measured_line *line, double t, double sign,
                   double *root) {
    struct vec3 d = vec3_scale(line->d, sign);
    double end = sign > 0 ? line->hi : -line->lo;
    t *= sign;
    for (int step = 0; step < 200; step++) {
        double slope, value = value_and_slope(s, vec3_add_scaled(line->o, d, t), d, &slope) - 1;
        if (!(value > 0)) /* arrived, at most by rounding beyond it */
            break;
        if (!(slope < 0))
            return false;
        double next = t - value / slope;
        if (!(next < end))
            return false;
        if (value < 0x1p-50 || next == t)
            break;
        t = next;
    }
    *root = sign * t;
    return true;
}

static int convex_crossings(const struct superellipsoid *s, const struct measured_line *line, double roots[2]) {
    if (!newton(s, line, line->lo, 1, &roots[0]) || !newton(s, line, line->hi, -1, &roots[1]))
        return 0;
    return roots[0] < roots[1] ? 2 : 0;
}

/* ---- not convex ---- */

struct range {
    double lo, hi;
};

static struct range range_of(double a, double b) {
    return (struct range){math_min(a, b), math_max(a, b)};
}

/* Products and sums in which infinity times zero is ignored. */
static struct range range_times(struct range a, struct range b) {
    double lo = a.lo * b.lo, hi = a.hi * b.hi;
    return (struct range){isnan(lo) ? 0 : lo, isnan(hi) ? INFINITY : hi};
}

static struct range range_add_scaled(struct range sum, struct range a, double scale) {
    if (scale == 0)
        return sum;
    double p = a.lo * scale, q = a.hi * scale;
    struct range out = {sum.lo + math_min(p, q), sum.hi + math_max(p, q)};
    return (struct range){isnan(out.lo) ? -INFINITY : out.lo, isnan(out.hi) ? INFINITY : out.hi};
}

struct search {
    const struct superellipsoid *s;
    const struct measured_line *line;
    double roots[SUPERELLIPSOID_MAX];
    int count;
};

static double value_on(const struct search *f, double t) {
    return value_at(f->s, vec3_add_scaled(f->line->o, f->line->d, t)) - 1;
}

static void bisect(struct search *f, double lo, double hi, bool rising) {
    if (f->count == SUPERELLIPSOID_MAX)
        return;
    double below = lo, above = hi;
    for (int step = 0; step < 80; step++) {
        double middle = below / 2 + above / 2;
        if (!(middle > below && middle < above))
            break;
        if ((value_on(f, middle) < 0) == rising)
            below = middle;
        else
            above = middle;
    }
    f->roots[f->count++] = rising ? below : above; /* the end that is inside */
}

/* The roots between two points in one octant whose signs are known. */
static void search_piece(struct search *f, double lo, double hi, bool lo_in, bool hi_in, int depth) {
    struct vec3 p = vec3_add_scaled(f->line->o, f->line->d, lo), q = vec3_add_scaled(f->line->o, f->line->d, hi);
    struct range x = range_of(fabs(p.x), fabs(q.x)), y = range_of(fabs(p.y), fabs(q.y)),
                 z = range_of(fabs(p.z), fabs(q.z));
    double e = 2 / f->s->e, n = 2 / f->s->n;
    struct norm section_lo = norm_of(x.lo, z.lo, e), section_hi = norm_of(x.hi, z.hi, e);
    if (norm_of(section_lo.value, y.lo, n).value > 1 + 0x1p-40 ||
        norm_of(section_hi.value, y.hi, n).value < 1 - 0x1p-40)
        return;
    /* The slopes of |(a, b)| at both ends of what the ratio a / b can be. */
    struct norm section_a = norm_of(x.lo, z.hi, e), section_b = norm_of(x.hi, z.lo, e);
    struct norm all_a = norm_of(section_lo.value, y.hi, n), all_b = norm_of(section_hi.value, y.lo, n);
    struct range full_norm = range_of(all_a.da, all_b.da), all_y = range_of(all_a.db, all_b.db), slope = {0, 0};
    slope =
        range_add_scaled(slope, range_times(full_norm, range_of(section_a.da, section_b.da)), fabs(q.x) - fabs(p.x));
    slope = range_add_scaled(slope, all_y, fabs(q.y) - fabs(p.y));
    slope =
        range_add_scaled(slope, range_times(full_norm, range_of(section_a.db, section_b.db)), fabs(q.z) - fabs(p.z));
    bool monotonic = slope.lo >= 0 || slope.hi <= 0;
    if (monotonic || depth == 0) {
        if (lo_in != hi_in)
            bisect(f, lo, hi, lo_in);
        return;
    }
    double middle = lo / 2 + hi / 2;
    bool middle_in = value_on(f, middle) < 0;
    search_piece(f, lo, middle, lo_in, middle_in, depth - 1);
    search_piece(f, middle, hi, middle_in, hi_in, depth - 1);
}

static int folded_crossings(const struct superellipsoid *s, const struct measured_line *line, double *roots) {
    struct search f = {.s = s, .line = line};
    double cuts[5] = {line->lo};
    int count = 1;
    for (int axis = 0; axis < 3; axis++) {
        double t = -vec3_get(line->o, axis) / vec3_get(line->d, axis);
        if (!(t > line->lo && t < line->hi))
            continue;
        int at = count++;
        for (; at > 1 && cuts[at - 1] > t; at--)
            cuts[at] = cuts[at - 1];
        cuts[at] = t;
    }
    cuts[count++] = line->hi;
    bool in = false; /* the box ends outside or on the surface */
    for (int i = 0; i + 1 < count; i++) {
        bool next_in = i + 2 < count && value_on(&f, cuts[i + 1]) < 0;
        search_piece(&f, cuts[i], cuts[i + 1], in, next_in, 30);
        in = next_in;
    }
    for (int i = 0; i < f.count; i++)
        roots[i] = f.roots[i];
    return f.count & ~1;
}

/* ---- the shape ---- */

int superellipsoid_crossings(const struct superellipsoid *s, const struct ray *ray,
                             struct crossing out[SUPERELLIPSOID_MAX]) {
    struct measured_line line;
    if (!line_in_box(ray, &line))
        return 0;
    double roots[SUPERELLIPSOID_MAX];
    bool convex = s->e <= 2 && s->n <= 2;
    int count = convex ? convex_crossings(s, &line, roots) : folded_crossings(s, &line, roots);
    for (int i = 0; i < count; i++)
        out[i] = (struct crossing){.t = (line.shift + roots[i]) / line.length, .enter = i % 2 == 0};
    return count;
}

bool superellipsoid_contains(const struct superellipsoid *s, struct vec3 point) {
    return value_at(s, point) < 1;
}

/* The gradient without infinities: at a crease only its largest components count. */
static struct vec3 outward(const struct superellipsoid *s, struct vec3 p) {
    struct norm section = norm_of(fabs(p.x), fabs(p.z), 2 / s->e), all = norm_of(section.value, fabs(p.y), 2 / s->n);
    double min = 0x1p-200, max = 0x1p200;
    double gx = math_min(math_max(all.da, min), max) * math_min(math_max(section.da, min), max),
           gy = math_min(all.db, max * max);
    double gz = math_min(math_max(all.da, min), max) * math_min(math_max(section.db, min), max);
    return vec3_normalize(vec3_make(copysign(gx, p.x), copysign(gy, p.y), copysign(gz, p.z)));
}

void superellipsoid_describe(const struct superellipsoid *s, const struct ray *ray, const struct crossing *crossing,
                             struct surface *out) {
    struct vec3 p = ray_at(ray, crossing->t);
    double value = value_at(s, p);
    if (value > 0.5 && value < 2) /* else the origin of the ray is too far away for accurate numbers */
        p = vec3_scale(p, 1 / value);
    struct vec3 n = outward(s, p);
    /* Along the radius the point is right to some last places of its powers; the distance is less. */
    *out = (struct surface){.point = p,
                            .normal = n,
                            .shading_normal = n,
                            .pattern_point = p,
                            .pattern_normal = n,
                            .has_uv = true,
                            .error = 0x1p-46};

    /* By direction, as on the sphere. With r = 1 / N(direction) the point is r direction. */
    double radius = vec3_length(p), ring = sqrt(p.x * p.x + p.z * p.z);
    double y = radius > 0 ? math_min(math_max(p.y / radius, -1), 1) : 1, across = radius > 0 ? ring / radius : 0;
    double cosine = ring > 0 ? p.x / ring : 1, sine = ring > 0 ? p.z / ring : 0;
    out->u = 0.5 - el_atan2(p.z, p.x) / TURN;
    out->v = 0.5 + el_asin(y) / (TURN / 2);
    struct vec3 du = vec3_scale(vec3_make(sine, 0, -cosine), TURN * across * radius);
    struct vec3 dv = vec3_scale(vec3_make(-y * cosine, across, -y * sine), TURN / 2 * radius);
    double facing = vec3_dot(n, p);
    if (facing > 0) { /* along the surface: what leaves it is taken back by going along the radius */
        du = vec3_add_scaled(du, p, -vec3_dot(n, du) / facing);
        dv = vec3_add_scaled(dv, p, -vec3_dot(n, dv) / facing);
    }
    out->dpdu = du;
    out->dpdv = dv;
}

/* The reach of a norm's unit ball is the dual norm, with 1/p + 1/p' = 1; of a star it is that of its hull, p = 1. */
static double dual(double a, double b, double p) {
    return p > 1 ? norm_of(a, b, p / (p - 1)).value : math_max(a, b);
}

void superellipsoid_extent(const struct superellipsoid *s, struct vec3 g, double *lo, double *hi) {
    *hi = dual(dual(fabs(g.x), fabs(g.z), 2 / s->e), fabs(g.y), 2 / s->n);
    *lo = -*hi;
}
