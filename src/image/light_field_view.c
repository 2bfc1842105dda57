/* A ray is looked up in the four cameras around the point where it crosses the plane of the cameras, at the point where
 * it crosses the plane in focus: the mean of 4 x 4 pixels, linear in each of four coordinates. With depths, that plane
 * is at the surface that the ray meets (S. Gortler, R. Grzeszczuk, R. Szeliski, M. Cohen, "The Lumigraph", SIGGRAPH
 * 1996), and cameras that see another surface there do not count. A lens is the mean over its points.
 *
 * Coordinates are those of the picture: x to the right, y downwards. A point at distance z from the plane is given by
 * its inverse, the disparity: the pixel of a camera that shows it is linear in it. The terms are ordered so that an eye
 * at a camera gives the whole numbers of its pixels without rounding. */
#include "image/light_field_view.h"

#include "base/mem.h"
#include "math/elementary.h"
#include "math/portable.h"

#include <math.h>
#include <string.h>

enum { X, Y, AXES, LENS_FEWEST = 32, LENS_LIMIT = 256, STEPS_LIMIT = 64, PATCH = 7 };
static const double lens_middle[AXES];

/* A weighted sum of pixels: all numbers of a pixel of a view. */
struct pixel_sum {
    double numbers[LIGHT_FIELD_NUMBERS], weight;
};

struct drawing {
    const struct light_field *field;
    struct light_field_camera camera;
    bool depth;                     /* surfaces are where the field has them, not all in the plane in focus */
    double count[AXES], size[AXES]; /* of cameras, and of the pixels of a view */
    double spacing, pixel;          /* pixel: its side at distance 1 */
    double per_spacing, per_screen, per_focus, per_pixel; /* reciprocals; of spacing 0: 0 */
    double eye[AXES];
    double ratio;                    /* of a pixel of the picture to one of a view */
    double disparity, shares[AXES];  /* of the plane in focus; half of the picture, pixels of a view */
    double points[LENS_LIMIT][AXES]; /* of the lens: as many as there are count as much as each other */
    uint32_t point_count;
    double *weights;        /* of all cameras for the whole picture; NULL: they differ by pixel */
    struct pixel_sum *sums; /* for each worker a row of it */
    double *lines;          /* for each worker a row of a view */
    float (*out)[3];
};

/* --- where rays are in the field --- */

/* A ray from a point of the lens: the point of the plane that it crosses, and two terms of its pixels (pixel_of). */
struct field_ray {
    double crossing[AXES], picture[AXES], lens[AXES];
};

static double limited(double x, double low, double high) {
    return x > low ? (x < high ? x : high) : low;
}

/* Below 2^31: a call of floor would take longer than all the rest. */
static double floor_of(double x) {
    double whole = (double)(int64_t)x;
    return whole > x ? whole - 1 : whole;
}

/* Within a millionth of a camera, it is at the camera. */
static double snapped(double u) {
    double near = floor_of(limited(u, -0x1p31, 0x1p31) + 0.5);
    return fabs(u - near) < 1e-6 ? near : u;
}

static double middle_of(double count) {
    return (count - 1) / 2;
}

/* The place of a point among the cameras: 0 is the first one. */
static double among_cameras(const struct drawing *d, int axis, double x) {
    return d->spacing > 0 ? snapped(x * d->per_spacing + middle_of(d->count[axis])) : 0;
}

static double camera_at(const struct drawing *d, int axis, double index) {
    return (index - middle_of(d->count[axis])) * d->spacing;
}

static struct field_ray ray_of(const struct drawing *d, const double offset[AXES], double x, double y) {
    const double at[AXES] = {x, y};
    struct field_ray ray;
    for (int k = 0; k < AXES; k++) {
        ray.picture[k] = at[k] * d->ratio - d->shares[k];
        ray.lens[k] = -d->eye[k] * d->per_screen - offset[k] * d->per_focus;
        double slope = ray.picture[k] * d->pixel + ray.lens[k];
        ray.crossing[k] = d->eye[k] + offset[k] - d->camera.z * slope;
    }
    return ray;
}

/* The pixel of the camera at `camera` that shows the point of the ray with this disparity, from the corner of the
 * view. */
static double pixel_of(const struct drawing *d, const struct field_ray *ray, int axis, double camera,
                       double disparity) {
    double shift = (ray->crossing[axis] - camera) * disparity + (camera * d->per_screen + ray->lens[axis]);
    return d->size[axis] / 2 + ray->picture[axis] + shift * d->per_pixel;
}

/* --- pixels of a view --- */

/* Two neighbours on an axis, linear between their middles; beyond the border, the last one, which hardly counts. */
struct tap {
    uint32_t first, second;
    double part, weight; /* part: of the second one */
};

static struct tap tap_of(double at, double size) {
    double low = at - 0.5;
    low = low > 0 ? low : 0; /* NaN too */
    low = low < size - 1 ? low : size - 1;
    struct tap tap = {.first = (uint32_t)low, .weight = at >= 0 && at <= size ? 1 : 1e-9};
    tap.part = low - tap.first;
    tap.second = tap.first + (tap.part > 0);
    return tap;
}

static void add_pixels(const struct drawing *d, const float *view, const struct tap taps[AXES], double weight,
                       struct pixel_sum *sum) {
    const struct tap *x = &taps[X], *y = &taps[Y];
    size_t line = (size_t)d->size[X] * LIGHT_FIELD_NUMBERS;
    const float *left = view + (size_t)x->first * LIGHT_FIELD_NUMBERS;
    const float *right = view + (size_t)x->second * LIGHT_FIELD_NUMBERS;
    const float *upper_left = left + y->first * line, *upper_right = right + y->first * line;
    const float *lower_left = left + y->second * line, *lower_right = right + y->second * line;
    weight *= x->weight * y->weight;
    for (int c = 0; c < LIGHT_FIELD_NUMBERS; c++) {
        double upper = (1 - x->part) * (double)upper_left[c] + x->part * (double)upper_right[c];
        double lower = (1 - x->part) * (double)lower_left[c] + x->part * (double)lower_right[c];
        sum->numbers[c] += weight * ((1 - y->part) * upper + y->part * lower);
    }
    sum->weight += weight;
}

/* The disparity of the pixel there; false: it is beyond the border. */
static bool disparity_there(const struct drawing *d, const float *view, const double at[AXES], double *out) {
    if (!(at[X] >= 0 && at[X] <= d->size[X] && at[Y] >= 0 && at[Y] <= d->size[Y]))
        return false;
    size_t x = (size_t)(at[X] < d->size[X] ? at[X] : d->size[X] - 1),
           y = (size_t)(at[Y] < d->size[Y] ? at[Y] : d->size[Y] - 1);
    *out = (double)view[(y * (size_t)d->size[X] + x) * LIGHT_FIELD_NUMBERS + 3];
    return true;
}

/* --- a ray --- */

/* A camera near a ray. */
struct near_camera {
    const float *view;
    const struct light_field_entry *entry;
    double at[AXES], weight;
};

static void find_pixel(const struct drawing *d, const struct field_ray *ray, const struct near_camera *camera,
                       double disparity, double out[AXES]) {
    for (int k = 0; k < AXES; k++)
        out[k] = pixel_of(d, ray, k, camera->at[k], disparity);
}

/* At most four, with the sum of weights 1. None: the ray comes from outside of the grid, and `inside` asks for it. */
static int find_cameras(const struct drawing *d, const struct field_ray *ray, bool inside, struct near_camera out[4]) {
    double low[AXES], part[AXES];
    int count = 0;
    for (int k = 0; k < AXES; k++) {
        double whole = among_cameras(d, k, ray->crossing[k]), u = limited(whole, 0, d->count[k] - 1);
        if (inside && u != whole)
            return 0;
        low[k] = floor_of(u);
        part[k] = u - low[k];
    }
    for (int i = 0; i < 4; i++) {
        double index[AXES] = {low[X] + (i & 1), low[Y] + (i >> 1)};
        double weight = (i & 1 ? part[X] : 1 - part[X]) * (i & 2 ? part[Y] : 1 - part[Y]);
        if (!(weight > 0))
            continue;
        size_t view = (size_t)index[Y] * d->field->head.columns + (size_t)index[X];
        out[count++] = (struct near_camera){d->field->views[view],
                                            &d->field->entries[view],
                                            {camera_at(d, X, index[X]), camera_at(d, Y, index[Y])},
                                            weight};
    }
    return count;
}

/* By how many pixels a camera shows points of two disparities apart. */
static double pixels_apart(const struct drawing *d, const struct field_ray *ray, const struct near_camera *camera,
                           double a, double b) {
    double off[AXES] = {fabs(ray->crossing[X] - camera->at[X]), fabs(ray->crossing[Y] - camera->at[Y])};
    return fabs(a - b) * (off[X] > off[Y] ? off[X] : off[Y]) * d->per_pixel;
}

/* Follows the ray in the picture of a camera from the nearest depth to the farthest, by about a pixel each time, to the
 * first surface. False: it finds none. */
static bool find_surface(const struct drawing *d, const struct field_ray *ray, const struct near_camera *camera,
                         double *disparity) {
    double near = camera->entry->nearest, far = camera->entry->farthest, at[AXES];
    int steps = 1 + (int)limited(pixels_apart(d, ray, camera, near, far), 0, STEPS_LIMIT);
    double step = (near - far) / steps;
    for (int i = 0; i <= steps; i++) {
        double here = near - i * step;
        find_pixel(d, ray, camera, here, at);
        if (disparity_there(d, camera->view, at, disparity) && *disparity >= here - step / 2 &&
            *disparity <= here + step)
            return true;
    }
    return false;
}

/* The surface that the nearest camera sees, else another one, else the plane in focus. */
static double disparity_of(const struct drawing *d, const struct field_ray *ray, const struct near_camera *cameras,
                           int count) {
    int first = 0;
    double disparity;
    for (int i = 1; i < count; i++)
        first = cameras[i].weight > cameras[first].weight ? i : first;
    for (int i = 0; i < count; i++)
        if (find_surface(d, ray, &cameras[(first + i) % count], &disparity))
            return disparity;
    return d->disparity;
}

/* Returns how far its surface is from the plane in focus, or may be. */
static double add_ray(const struct drawing *d, const struct field_ray *ray, bool inside, struct pixel_sum *sum) {
    struct near_camera cameras[4];
    int count = find_cameras(d, ray, inside, cameras);
    bool has_depth = d->depth && count > 0;
    double disparity = has_depth ? disparity_of(d, ray, cameras, count) : d->disparity;
    for (int i = 0; i < count; i++) {
        double at[AXES], seen, weight = cameras[i].weight;
        find_pixel(d, ray, &cameras[i], disparity, at);
        bool hidden = has_depth && disparity_there(d, cameras[i].view, at, &seen) &&
                      fabs(seen - disparity) * d->spacing * d->per_pixel > 1;
        const struct tap taps[AXES] = {tap_of(at[X], d->size[X]), tap_of(at[Y], d->size[Y])};
        add_pixels(d, cameras[i].view, taps, hidden ? weight * 1e-6 : weight, sum);
    }
    return d->depth ? fabs(disparity - d->disparity) : d->disparity;
}

/* --- the picture --- */

static void prepare(struct drawing *d, const struct light_field_head *head, const struct light_field_camera *camera) {
    *d = (struct drawing){.camera = *camera,
                          .depth = head->depth && !(camera->quick && camera->aperture > 0),
                          .count = {head->columns, head->rows},
                          .size = {head->width, head->height},
                          .spacing = head->spacing,
                          .per_screen = 1 / head->screen,
                          .per_focus = 1 / camera->focus,
                          .per_spacing = head->spacing > 0 ? 1 / head->spacing : 0,
                          .pixel = 2 * el_tan(head->fov * (PI / 360)) / head->height};
    d->per_pixel = 1 / d->pixel;
    d->ratio = math_min((double)head->width / camera->width, (double)head->height / camera->height);
    d->shares[X] = camera->width / 2.0 * d->ratio;
    d->shares[Y] = camera->height / 2.0 * d->ratio;
    d->disparity = 1 / (camera->focus + camera->z);
    const double eye[AXES] = {camera->x, -camera->y};
    for (int k = 0; k < AXES; k++) {
        double u = among_cameras(d, k, eye[k]);
        d->eye[k] = d->spacing > 0 && u == floor(u) ? camera_at(d, k, u) : eye[k];
    }
}

/* Where its rays through the middle of the lens cross the plane, among the cameras. */
static void find_range(const struct drawing *d, double low[AXES], double high[AXES]) {
    for (int i = 0; i < 4; i++) {
        struct field_ray ray = ray_of(d, lens_middle, i & 1 ? d->camera.width : 0, i & 2 ? d->camera.height : 0);
        for (int k = 0; k < AXES; k++) {
            double u = among_cameras(d, k, ray.crossing[k]);
            low[k] = i == 0 ? u : math_min(low[k], u);
            high[k] = i == 0 ? u : math_max(high[k], u);
        }
    }
}

bool light_field_clamp(const struct light_field_head *head, struct light_field_camera *camera) {
    struct drawing d;
    double low[AXES], high[AXES];
    bool outside = false;
    prepare(&d, head, camera);
    find_range(&d, low, high);
    for (int k = 0; k < AXES; k++)
        outside = outside || !(low[k] >= 0 && high[k] <= d.count[k] - 1);
    double half_width = middle_of(d.count[X]) * d.spacing, half_height = middle_of(d.count[Y]) * d.spacing;
    if (camera->z == 0) {
        camera->x = math_min(math_max(camera->x, -half_width), half_width);
        camera->y = math_min(math_max(camera->y, -half_height), half_height);
    }
    return outside;
}

/* Points of a lens, so that any number of the first ones cover it evenly: multiples of the powers of 1 / 1.3247, the
 * root of x^3 = x + 1. It is a line in a grid of one row or column. */
static void make_lens(struct drawing *d) {
    d->point_count = d->camera.aperture * d->per_spacing > 0 ? LENS_LIMIT : 1;
    for (uint32_t i = 0; i < d->point_count && d->point_count > 1; i++) {
        double radius = d->camera.aperture * sqrt(math_fmod(0.5 + i * 0.7548776662466927, 1)), sine, cosine;
        el_sincos(2 * PI * math_fmod(i * 0.5698402909980532, 1), &sine, &cosine);
        d->points[i][X] = d->count[X] > 1 ? radius * cosine : 0;
        d->points[i][Y] = d->count[Y] > 1 ? radius * sine : 0;
    }
}

/* On the plane of the cameras, and without depths, all pixels have the same weights of cameras. */
static bool make_weights(struct drawing *d) {
    const struct light_field_head *head = &d->field->head;
    if (d->depth || d->camera.z != 0)
        return true;
    d->weights = mem_alloc_zero((size_t)head->columns * head->rows, sizeof *d->weights);
    for (uint32_t i = 0; d->weights && i < d->point_count; i++) {
        struct near_camera cameras[4];
        struct field_ray ray = ray_of(d, d->points[i], 0, 0);
        int count = find_cameras(d, &ray, true, cameras);
        for (int k = 0; k < count; k++) {
            double column = among_cameras(d, X, cameras[k].at[X]), row = among_cameras(d, Y, cameras[k].at[Y]);
            d->weights[(size_t)row * head->columns + (size_t)column] += cameras[k].weight;
        }
    }
    return d->weights != NULL;
}

/* A row of one view, added to the sums of a row of the picture: all of it is at one height. line: the row of the view
 * at that height, linear between two. */
static void add_view(const struct drawing *d, uint32_t view, uint32_t y, double *line, struct pixel_sum *sums) {
    const struct light_field_head *head = &d->field->head;
    const double camera[AXES] = {camera_at(d, X, view % head->columns), camera_at(d, Y, view / head->columns)};
    const size_t numbers = (size_t)head->width * LIGHT_FIELD_NUMBERS;
    struct field_ray ray = ray_of(d, lens_middle, 0, y + 0.5);
    const struct tap across = tap_of(pixel_of(d, &ray, Y, camera[Y], d->disparity), d->size[Y]);
    const float *upper = d->field->views[view] + across.first * numbers;
    const float *lower = d->field->views[view] + across.second * numbers;
    for (size_t i = 0; i < numbers; i++)
        line[i] = (1 - across.part) * (double)upper[i] + across.part * (double)lower[i];
    for (uint32_t x = 0; x < d->camera.width; x++) {
        ray.picture[X] = (x + 0.5) * d->ratio - d->shares[X];
        const struct tap tap = tap_of(pixel_of(d, &ray, X, camera[X], d->disparity), d->size[X]);
        const double *left = line + (size_t)tap.first * LIGHT_FIELD_NUMBERS;
        const double *right = line + (size_t)tap.second * LIGHT_FIELD_NUMBERS;
        const double weight = d->weights[view] * tap.weight * across.weight;
        for (int c = 0; c < LIGHT_FIELD_NUMBERS; c++)
            sums[x].numbers[c] += weight * ((1 - tap.part) * left[c] + tap.part * right[c]);
        sums[x].weight += weight;
    }
}

/* A lens over depths has a point for each pixel of the largest disc that its rays find. */
static void draw_pixel(const struct drawing *d, uint32_t x, uint32_t y, struct pixel_sum *sum) {
    double count = d->weights ? 0 : LENS_FEWEST;
    for (uint32_t i = 0; i < d->point_count && i < count; i++) {
        struct field_ray ray = ray_of(d, d->points[i], x + 0.5, y + 0.5);
        double radius = add_ray(d, &ray, true, sum) * d->camera.aperture * d->per_pixel;
        count = math_max(count, PI * radius * radius);
    }
    struct field_ray ray = ray_of(d, lens_middle, x + 0.5, y + 0.5);
    if (!(sum->weight > 0)) /* all of the lens is outside */
        (void)add_ray(d, &ray, false, sum);
}

static void draw_row(void *context, uint32_t y, int worker) {
    struct drawing *d = context;
    const struct light_field_head *head = &d->field->head;
    uint32_t width = d->camera.width;
    struct pixel_sum *sums = d->sums + (size_t)worker * width;
    memset(sums, 0, width * sizeof *sums);
    for (uint32_t view = 0; d->weights && view < head->columns * head->rows; view++)
        if (d->weights[view] > 0)
            add_view(d, view, y, d->lines + (size_t)worker * head->width * LIGHT_FIELD_NUMBERS, sums);
    for (uint32_t x = 0; x < width; x++) {
        if (!d->weights || !(sums[x].weight > 0))
            draw_pixel(d, x, y, &sums[x]);
        for (int c = 0; c < 3; c++)
            d->out[(size_t)y * width + x][c] = (float)(sums[x].numbers[c] / sums[x].weight);
    }
}

/* The views that it needs. */
static bool load_views(const struct drawing *d, struct light_field *field, struct pool *pool, struct error *error) {
    double low[AXES], high[AXES], extent = d->camera.aperture * fabs(1 + d->camera.z * d->per_focus) * d->per_spacing;
    uint32_t first[AXES], last[AXES];
    find_range(d, low, high);
    for (int k = 0; k < AXES; k++) {
        first[k] = (uint32_t)floor(limited(low[k] - extent, 0, d->count[k] - 1));
        last[k] = (uint32_t)ceil(limited(high[k] + extent, 0, d->count[k] - 1));
    }
    const struct light_field_part part = {first[X], first[Y], last[X] - first[X] + 1, last[Y] - first[Y] + 1};
    return light_field_load_part(field, &part, pool, error);
}

bool light_field_draw(struct light_field *field, const struct light_field_camera *camera, struct pool *pool,
                      float (*out)[3], struct error *error) {
    struct drawing d;
    prepare(&d, &field->head, camera);
    double wide = middle_of(d.count[X]), high = middle_of(d.count[Y]);
    d.camera.aperture = math_min(camera->aperture, 2 * d.spacing * sqrt(wide * wide + high * high));
    d.field = field;
    d.out = out;
    make_lens(&d);
    d.sums = mem_alloc_zero((size_t)pool_workers(pool) * camera->width, sizeof *d.sums);
    d.lines = mem_alloc_zero((size_t)pool_workers(pool) * d.field->head.width, LIGHT_FIELD_NUMBERS * sizeof *d.lines);
    bool ok = load_views(&d, field, pool, error) &&
              ((d.sums && d.lines && make_weights(&d)) || error_no_memory(error, field->path));
    ok = ok && (pool_run(pool, camera->height, draw_row, &d) || error_set(error, ERROR_CANCELLED, "interrupted"));
    mem_free(d.sums);
    mem_free(d.lines);
    mem_free(d.weights);
    return ok;
}

/* --- distances --- */

/* How much the cameras of a part of the grid differ from the first one where they show a patch around a pixel at a
 * disparity, with bright light compressed. */
static double difference_at(const struct drawing *d, const struct light_field_part *part, const double pixel[AXES],
                            double disparity) {
    double sum = 0;
    for (int i = 0; i < PATCH * PATCH; i++) {
        const double off[AXES] = {(i % PATCH - PATCH / 2) / d->ratio, (int)(i / PATCH - PATCH / 2) / d->ratio};
        struct field_ray ray = ray_of(d, lens_middle, pixel[X] + off[X], pixel[Y] + off[Y]);
        double first[3] = {0, 0, 0};
        for (uint32_t k = 0; k < part->columns * part->rows; k++) {
            const uint32_t column = part->column + k % part->columns, row = part->row + k / part->columns;
            struct pixel_sum seen = {.weight = 0};
            const struct tap taps[AXES] = {tap_of(pixel_of(d, &ray, X, camera_at(d, X, column), disparity), d->size[X]),
                                           tap_of(pixel_of(d, &ray, Y, camera_at(d, Y, row), disparity), d->size[Y])};
            add_pixels(d, d->field->views[row * d->field->head.columns + column], taps, 1, &seen);
            for (int c = 0; c < 3; c++) {
                double light = math_max(0, seen.numbers[c] / seen.weight), value = light / (1 + light);
                first[c] = k == 0 ? value : first[c];
                sum += (value - first[c]) * (value - first[c]);
            }
        }
    }
    return sum;
}

/* The disparity where they agree best, from far away to a third of the distance of the screen. */
static double find_agreement(const struct drawing *d, const struct light_field_part *part, const double pixel[AXES]) {
    const double step = 3 * d->per_screen / (3 * STEPS_LIMIT);
    double best = 0, smallest = INFINITY;
    for (int i = 1; i <= 3 * STEPS_LIMIT; i++) {
        double difference = difference_at(d, part, pixel, i * step);
        best = difference < smallest ? i * step : best;
        smallest = math_min(difference, smallest);
    }
    return best;
}

bool light_field_distance(struct light_field *field, const struct light_field_camera *camera, const double pixel[2],
                          struct pool *pool, double *out, struct error *error) {
    struct drawing d;
    struct near_camera cameras[4];
    struct light_field_part part;
    uint32_t first[AXES], count[AXES];
    prepare(&d, &field->head, camera);
    d.field = field;
    struct field_ray ray = ray_of(&d, lens_middle, pixel[X], pixel[Y]);
    for (int k = 0; k < AXES; k++) {
        double u = limited(among_cameras(&d, k, ray.crossing[k]), 0, d.count[k] - 1);
        first[k] = (uint32_t)math_max(0, floor_of(u) - 1);
        count[k] = (uint32_t)math_min(4, d.count[k] - first[k]);
    }
    part = (struct light_field_part){first[X], first[Y], count[X], count[Y]};
    error->text[0] = '\0';
    if (!light_field_load_part(field, &part, pool, error))
        return false;
    d.disparity = 0;
    double disparity = d.depth ? disparity_of(&d, &ray, cameras, find_cameras(&d, &ray, false, cameras))
                               : find_agreement(&d, &part, pixel);
    *out = 1 / disparity - camera->z;
    return disparity > 0 && *out > 0;
}
