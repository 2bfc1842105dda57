/* Procedural scenes, and a reader of simple OBJ files; see rays_scenes.h. */
#include "bench/rays_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *grown(void *block, size_t count, size_t size) {
    void *larger = realloc(block, count * size);
    if (!larger) {
        fprintf(stderr, "rays: out of memory\n");
        exit(3);
    }
    return larger;
}

static uint32_t add_vertex(struct bench_scene *s, double x, double y, double z) {
    if (s->vertex_count == s->vertex_capacity) {
        s->vertex_capacity = 2 * s->vertex_capacity + 1024;
        s->vertices = grown(s->vertices, s->vertex_capacity, sizeof *s->vertices);
    }
    float *v = s->vertices[s->vertex_count];
    v[0] = (float)x;
    v[1] = (float)y;
    v[2] = (float)z;
    return s->vertex_count++;
}

static void add_triangle(struct bench_scene *s, uint32_t a, uint32_t b, uint32_t c) {
    if (s->triangle_count == s->triangle_capacity) {
        s->triangle_capacity = 2 * s->triangle_capacity + 1024;
        s->corners = grown(s->corners, s->triangle_capacity, sizeof *s->corners);
    }
    uint32_t *corner = s->corners[s->triangle_count++];
    corner[0] = a;
    corner[1] = b;
    corner[2] = c;
}

static void add_quad(struct bench_scene *s, const double p[4][3]) {
    uint32_t v = 0;
    for (int i = 0; i < 4; i++)
        v = add_vertex(s, p[i][0], p[i][1], p[i][2]) - (uint32_t)i;
    add_triangle(s, v, v + 1, v + 2);
    add_triangle(s, v, v + 2, v + 3);
}

static void set_view(struct bench_scene *s, const float view[10]) {
    memcpy(s->eye, view, sizeof s->eye);
    memcpy(s->target, view + 3, sizeof s->target);
    memcpy(s->light, view + 6, sizeof s->light);
    s->field = view[9];
}

static void bounds(const struct bench_scene *s, float lo[3], float hi[3]) {
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
        for (uint32_t i = 0; i < s->vertex_count; i++) {
            lo[k] = fminf(lo[k], s->vertices[i][k]);
            hi[k] = fmaxf(hi[k], s->vertices[i][k]);
        }
    }
}

void bench_scene_free(struct bench_scene *s) {
    free(s->vertices);
    free(s->corners);
    *s = (struct bench_scene){0};
}

bool bench_load_obj(struct bench_scene *s, const char *path) {
    FILE *file = fopen(path, "r");
    if (!file)
        return false;
    char line[8192];
    while (fgets(line, sizeof line, file)) {
        double p[3];
        if (line[0] == 'v' && line[1] == ' ' && sscanf(line + 2, "%lf %lf %lf", &p[0], &p[1], &p[2]) == 3)
            add_vertex(s, p[0], p[1], p[2]);
        if (line[0] != 'f' || line[1] != ' ')
            continue;
        uint32_t corner[2] = {0, 0};
        int count = 0;
        for (char *word = strtok(line + 2, " \t\r\n"); word; word = strtok(NULL, " \t\r\n"), count++) {
            long index = strtol(word, NULL, 10);
            uint32_t v = index < 0 ? s->vertex_count - (uint32_t)-index : (uint32_t)index - 1;
            if (v >= s->vertex_count)
                break;
            if (count >= 2)
                add_triangle(s, corner[0], corner[1], v);
            corner[count == 0 ? 0 : 1] = v;
        }
    }
    fclose(file);
    return s->triangle_count > 0;
}

void bench_default_view(struct bench_scene *s) {
    float lo[3], hi[3], size = 0;
    bounds(s, lo, hi);
    for (int k = 0; k < 3; k++)
        size += (hi[k] - lo[k]) * (hi[k] - lo[k]);
    size = sqrtf(size);
    const float from[3] = {0.35f, 0.3f, 1.0f}, light[3] = {-0.6f, 1.2f, 0.9f};
    for (int k = 0; k < 3; k++) {
        s->target[k] = (lo[k] + hi[k]) / 2;
        s->eye[k] = s->target[k] + size * from[k];
        s->light[k] = s->target[k] + size * light[k];
    }
    s->field = 45;
}

static void middle(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (a[k] + b[k]) / 2;
}

static void sierpinski(struct bench_scene *s, const double p[4][3], int depth) {
    if (depth == 0) {
        uint32_t v = 0;
        for (int i = 0; i < 4; i++)
            v = add_vertex(s, p[i][0], p[i][1], p[i][2]) - (uint32_t)i;
        add_triangle(s, v, v + 1, v + 2);
        add_triangle(s, v, v + 3, v + 1);
        add_triangle(s, v + 1, v + 3, v + 2);
        add_triangle(s, v + 2, v + 3, v);
        return;
    }
    for (int i = 0; i < 4; i++) {
        double q[4][3];
        for (int j = 0; j < 4; j++)
            middle(p[i], p[j], q[j]);
        sierpinski(s, (const double(*)[3])q, depth - 1);
    }
}

void bench_sierpinski(struct bench_scene *s, int depth) {
    const double h = sqrt(3) / 2, corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, h}, {0.5, sqrt(2.0 / 3), h / 3}};
    sierpinski(s, corner, depth);
    set_view(s, (const float[10]){1.35f, 0.75f, 1.55f, 0.5f, 0.27f, 0.3f, 3, 4, 2, 32});
}

static uint64_t mixed(uint64_t x) {
    x += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

static double lattice(int64_t x, int64_t y, int64_t z) {
    uint64_t h = mixed((uint64_t)x ^ mixed((uint64_t)y ^ mixed((uint64_t)z)));
    return (double)(h >> 11) * 0x1p-52 - 1;
}

static double value_noise(double x, double y, double z) {
    double fx = x - floor(x), fy = y - floor(y), fz = z - floor(z), sum = 0;
    int64_t ix = (int64_t)floor(x), iy = (int64_t)floor(y), iz = (int64_t)floor(z);
    fx *= fx * (3 - 2 * fx);
    fy *= fy * (3 - 2 * fy);
    fz *= fz * (3 - 2 * fz);
    for (int i = 0; i < 8; i++)
        sum += lattice(ix + (i & 1), iy + (i >> 1 & 1), iz + (i >> 2)) * (i & 1 ? fx : 1 - fx) * (i & 2 ? fy : 1 - fy) *
               (i & 4 ? fz : 1 - fz);
    return sum;
}

static double fractal(double x, double y, double z, int octaves) {
    double sum = 0, weight = 1;
    for (int i = 0; i < octaves; i++) {
        sum += weight * value_noise(x, y, z);
        weight /= 2;
        x *= 2.03;
        y *= 2.03;
        z *= 2.03;
    }
    return sum;
}

void bench_terrain(struct bench_scene *s, int side) {
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            double x = 10.0 * i / (side - 1), z = 10.0 * j / (side - 1);
            add_vertex(s, x, 0.9 * fractal(0.7 * x, 3.3, 0.7 * z, 9), z);
        }
    for (int j = 0; j + 1 < side; j++)
        for (int i = 0; i + 1 < side; i++) {
            uint32_t a = (uint32_t)(j * side + i), c = a + (uint32_t)side;
            add_triangle(s, a, c, a + 1);
            add_triangle(s, a + 1, c, c + 1);
        }
    set_view(s, (const float[10]){5, 2.2f, 13, 5, -0.3f, 5, -4, 8, 2, 45});
}

void bench_subdivide(struct bench_scene *s, int levels) {
    float lo[3], hi[3];
    bounds(s, lo, hi);
    double size = sqrt(pow(hi[0] - lo[0], 2) + pow(hi[1] - lo[1], 2) + pow(hi[2] - lo[2], 2));
    for (int level = 0; level < levels; level++) {
        uint32_t count = s->triangle_count, (*old)[3] = s->corners;
        size_t slots = 1;
        while (slots < 4 * (size_t)count)
            slots *= 2;
        uint64_t *keys = calloc(slots, sizeof *keys);
        uint32_t *values = calloc(slots, sizeof *values);
        if (!keys || !values)
            exit(3);
        s->corners = NULL;
        s->triangle_count = s->triangle_capacity = 0;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t mid[3], *c = old[i];
            for (int j = 0; j < 3; j++) {
                uint32_t a = c[j], b = c[(j + 1) % 3];
                uint64_t key = ((uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a)) + 1;
                size_t at = mixed(key) & (slots - 1);
                while (keys[at] && keys[at] != key)
                    at = (at + 1) & (slots - 1);
                if (!keys[at]) {
                    const float *p = s->vertices[a], *q = s->vertices[b];
                    keys[at] = key;
                    values[at] = add_vertex(s, (p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2);
                }
                mid[j] = values[at];
            }
            add_triangle(s, c[0], mid[0], mid[2]);
            add_triangle(s, mid[0], c[1], mid[1]);
            add_triangle(s, mid[2], mid[1], c[2]);
            add_triangle(s, mid[0], mid[1], mid[2]);
        }
        free(keys);
        free(values);
        free(old);
    }
    for (uint32_t i = 0; i < s->vertex_count; i++) {
        float *p = s->vertices[i];
        double x = p[0] * 150 / size, y = p[1] * 150 / size, z = p[2] * 150 / size;
        p[0] += (float)(0.0015 * size * fractal(x, y, z, 4));
        p[1] += (float)(0.0015 * size * fractal(x + 31, y + 7, z + 5, 4));
        p[2] += (float)(0.0015 * size * fractal(x + 3, y + 71, z + 15, 4));
    }
}

/* Adds a copy of a mesh with the largest extent `size` that stands on the point (x, y, z). */
static void add_copy(struct bench_scene *s, const struct bench_scene *mesh, double x, double y, double z, double size) {
    float lo[3], hi[3];
    bounds(mesh, lo, hi);
    double scale = size / fmax(hi[0] - lo[0], fmax(hi[1] - lo[1], hi[2] - lo[2]));
    uint32_t first = s->vertex_count;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        const float *v = mesh->vertices[i];
        add_vertex(s, x + scale * (v[0] - (lo[0] + hi[0]) / 2), y + scale * (v[1] - lo[1]),
                   z + scale * (v[2] - (lo[2] + hi[2]) / 2));
    }
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        add_triangle(s, first + mesh->corners[i][0], first + mesh->corners[i][1], first + mesh->corners[i][2]);
}

static void ring_point(double radius, double height, int i, int count, double out[3]) {
    double a = 2 * M_PI * i / count;
    out[0] = 1.3 * radius * cos(a);
    out[1] = height;
    out[2] = radius * sin(a);
}

void bench_stadium(struct bench_scene *s, const struct bench_scene *mesh) {
    enum { TIERS = 40, SECTORS = 96 };
    add_copy(s, mesh, 0, 0, 0, 1);
    add_quad(s, (const double[4][3]){{-140, 0, -110}, {-140, 0, 110}, {140, 0, 110}, {140, 0, -110}});
    for (int t = 0; t < TIERS; t++)
        for (int i = 0; i < SECTORS; i++) {
            double p[4][3], q[4][3];
            ring_point(60 + t, 0.8 * t, i, SECTORS, p[0]);
            ring_point(60 + t, 0.8 * t, i + 1, SECTORS, p[1]);
            ring_point(60 + t, 0.8 * t + 0.8, i + 1, SECTORS, p[2]);
            ring_point(60 + t, 0.8 * t + 0.8, i, SECTORS, p[3]);
            ring_point(61 + t, 0.8 * t + 0.8, i + 1, SECTORS, q[2]);
            ring_point(61 + t, 0.8 * t + 0.8, i, SECTORS, q[3]);
            memcpy(q[0], p[3], sizeof q[0]);
            memcpy(q[1], p[2], sizeof q[1]);
            add_quad(s, (const double(*)[3])p);
            add_quad(s, (const double(*)[3])q);
        }
    set_view(s, (const float[10]){1.1f, 1, 1.9f, 0, 0.3f, 0, 20, 60, 30, 60});
}

void bench_room(struct bench_scene *s, const struct bench_scene *const *meshes, int count) {
    static const int sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (int f = 0; f < 6; f++) {
        double p[4][3];
        for (int j = 0; j < 4; j++) {
            int corner = sides[f][3 - j];
            p[j][0] = corner & 1 ? 6 : -6;
            p[j][1] = corner & 2 ? 6 : 0;
            p[j][2] = corner & 4 ? 6 : -6;
        }
        add_quad(s, (const double(*)[3])p);
    }
    for (int i = 0; i < count; i++)
        add_copy(s, meshes[i], -4 + 8.0 * (i / 2) / fmax(1, (count + 1) / 2 - 1), 0, i % 2 ? -2 : 1.2,
                 i % 2 ? 3.4 : 2.2);
    set_view(s, (const float[10]){0, 3.6f, 5.8f, 0, 1.3f, -1, 0, 5.7f, 1, 75});
}

struct dice {
    uint64_t state;
};

static double roll(struct dice *dice, double lo, double hi) {
    dice->state++;
    return lo + (hi - lo) * (double)(mixed(dice->state) >> 11) * 0x1p-53;
}

static void blob(struct bench_scene *s, struct dice *dice, const double at[3], double size, int steps) {
    uint32_t first = s->vertex_count;
    double bumps = roll(dice, 0, 0.5), shift = roll(dice, -100, 100);
    for (int i = 0; i <= steps; i++)
        for (int j = 0; j < 2 * steps; j++) {
            double a = M_PI * i / steps, b = M_PI * j / steps;
            double x = sin(a) * cos(b), y = cos(a), z = sin(a) * sin(b);
            double r = size * (1 + bumps * fractal(2 * x + shift, 2 * y, 2 * z, 4));
            add_vertex(s, at[0] + r * x, at[1] + r * y, at[2] + r * z);
        }
    for (int i = 0; i < steps; i++)
        for (int j = 0; j < 2 * steps; j++) {
            uint32_t w = (uint32_t)(2 * steps), k = (uint32_t)(j + 1) % w;
            uint32_t a = first + (uint32_t)i * w + (uint32_t)j, b = first + (uint32_t)i * w + k;
            if (i > 0)
                add_triangle(s, a, b, b + w);
            if (i + 1 < steps)
                add_triangle(s, a, b + w, a + w);
        }
}

void bench_world(struct bench_scene *s, uint64_t seed) {
    struct dice dice = {mixed(seed)};
    double size = pow(10, roll(&dice, -1, 3));
    add_quad(s, (const double[4][3]){{-size, 0, -size}, {-size, 0, size}, {size, 0, size}, {size, 0, -size}});
    int clusters = (int)roll(&dice, 2, 9);
    for (int c = 0; c < clusters; c++) {
        double centre[3] = {roll(&dice, -0.6, 0.6) * size, 0, roll(&dice, -0.6, 0.6) * size};
        double spread = size * pow(10, roll(&dice, -2.5, -0.4));
        int kind = (int)roll(&dice, 0, 4);
        int count = kind == 0 ? (int)roll(&dice, 2, 60) : (int)pow(10, roll(&dice, 2, 4.6));
        for (int i = 0; i < count; i++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = centre[k] + spread * roll(&dice, k == 1 ? 0 : -1, 1);
            double each = spread * pow(10, roll(&dice, -2, -0.7));
            if (kind == 0) {
                blob(s, &dice, p, each, (int)roll(&dice, 6, 60));
            } else if (kind == 1) { /* grass */
                double lean = roll(&dice, -0.3, 0.3) * each;
                uint32_t v = add_vertex(s, p[0], centre[1], p[2]);
                add_vertex(s, p[0] + 0.03 * each, centre[1], p[2] + 0.02 * each);
                add_vertex(s, p[0] + lean, centre[1] + each, p[2] - lean);
                add_triangle(s, v, v + 1, v + 2);
            } else if (kind == 2) { /* leaves in any orientation */
                uint32_t v = 0;
                for (int j = 0; j < 3; j++)
                    v = add_vertex(s, p[0] + each * roll(&dice, -0.3, 0.3), p[1] + each * roll(&dice, -0.3, 0.3),
                                   p[2] + each * roll(&dice, -0.3, 0.3)) -
                        (uint32_t)j;
                add_triangle(s, v, v + 1, v + 2);
            } else { /* boxes */
                static const int sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
                double e[3] = {each * roll(&dice, 0.1, 1), each * roll(&dice, 0.1, 4), each * roll(&dice, 0.1, 1)};
                for (int f = 0; f < 6; f++) {
                    double q[4][3];
                    for (int j = 0; j < 4; j++) {
                        q[j][0] = p[0] + (sides[f][j] & 1 ? e[0] : 0);
                        q[j][1] = centre[1] + (sides[f][j] & 2 ? e[1] : 0);
                        q[j][2] = p[2] + (sides[f][j] & 4 ? e[2] : 0);
                    }
                    add_quad(s, (const double(*)[3])q);
                }
            }
        }
    }
    float view[10] = {(float)(0.9 * size),  (float)(0.35 * size), (float)(0.9 * size), 0, 0, 0,
                      (float)(-0.3 * size), (float)(1.5 * size),  (float)(0.5 * size), 45};
    set_view(s, view);
}
