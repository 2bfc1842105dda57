/* Meshes made in the tests: solids, soups, slivers. Everything is from malloc; maker_free frees it. */
#ifndef GRAY_TESTS_MESH_MAKERS_H
#define GRAY_TESTS_MESH_MAKERS_H

#include "accel/triangle.h"
#include "mesh/mesh.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct maker {
    double (*vertices)[3];
    uint32_t *corners, *starts;
    uint32_t vertex_count, corner_count, face_count, vertex_capacity, corner_capacity, face_capacity;
};

static inline uint32_t maker_vertex(struct maker *m, double x, double y, double z) {
    if (m->vertex_count == m->vertex_capacity) {
        m->vertex_capacity = 2 * m->vertex_capacity + 64;
        m->vertices = realloc(m->vertices, m->vertex_capacity * sizeof *m->vertices);
    }
    m->vertices[m->vertex_count][0] = x;
    m->vertices[m->vertex_count][1] = y;
    m->vertices[m->vertex_count][2] = z;
    return m->vertex_count++;
}

static inline void maker_face(struct maker *m, const uint32_t *corners, uint32_t count) {
    if (m->face_count + 2 > m->face_capacity) {
        m->face_capacity = 2 * m->face_capacity + 64;
        m->starts = realloc(m->starts, m->face_capacity * sizeof *m->starts);
    }
    if (m->corner_count + count > m->corner_capacity) {
        m->corner_capacity = 2 * (m->corner_capacity + count) + 64;
        m->corners = realloc(m->corners, m->corner_capacity * sizeof *m->corners);
    }
    m->starts[m->face_count++] = m->corner_count;
    memcpy(m->corners + m->corner_count, corners, count * sizeof *corners);
    m->corner_count += count;
    m->starts[m->face_count] = m->corner_count;
}

static inline void maker_triangle(struct maker *m, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t corners[3] = {a, b, c};
    maker_face(m, corners, 3);
}

static inline void maker_free(struct maker *m) {
    free(m->vertices);
    free(m->corners);
    free(m->starts);
    *m = (struct maker){0};
}

static inline struct mesh_input maker_input(const struct maker *m) {
    static const uint32_t none[1] = {0};
    return (struct mesh_input){.name = "test",
                               .vertex_count = m->vertex_count,
                               .face_count = m->face_count,
                               .vertices = (const double(*)[3])m->vertices,
                               .face_start = m->starts ? m->starts : none,
                               .vertex_index = m->corners};
}

/* The triangles of a maker whose faces are all triangles; valid as long as the maker is. */
static inline struct triangle_set set_of(const struct maker *m) {
    struct box box = box_empty();
    for (uint32_t i = 0; i < m->vertex_count; i++)
        box = box_add_point(box, vec3_make(m->vertices[i][0], m->vertices[i][1], m->vertices[i][2]));
    return (struct triangle_set){(const double(*)[3])m->vertices, (const uint32_t(*)[3])m->corners, m->face_count, box};
}

static inline struct mesh *maker_mesh(const struct maker *m) {
    struct mesh_input input = maker_input(m);
    struct error error = {0};
    struct mesh *mesh = mesh_create(&input, &error);
    if (!mesh || !mesh_build_accel(mesh, ACCEL_AUTO, NULL, &error)) {
        test_fail(__FILE__, __LINE__, "no mesh: %s", error.text);
        exit(1);
    }
    return mesh;
}

static inline void maker_scale(struct maker *m, double scale, double dx, double dy, double dz) {
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        m->vertices[i][0] = m->vertices[i][0] * scale + dx;
        m->vertices[i][1] = m->vertices[i][1] * scale + dy;
        m->vertices[i][2] = m->vertices[i][2] * scale + dz;
    }
}

/* An octahedron, each face divided into size * size triangles, projected onto the unit sphere. Coincident corners get
 * the same coordinates bit for bit. */
static inline void maker_sphere(struct maker *m, int size) {
    for (int side = 0; side < 8; side++) {
        double sx = side & 1 ? -1 : 1, sy = side & 2 ? -1 : 1, sz = side & 4 ? -1 : 1;
        bool turned = sx * sy * sz < 0;
        uint32_t base = m->vertex_count;
        for (int i = 0; i <= size; i++)
            for (int j = 0; j <= size - i; j++) {
                double x = i, y = j, z = size - i - j, length = sqrt(x * x + y * y + z * z);
                maker_vertex(m, sx * (x / length), sy * (y / length), sz * (z / length));
            }
        uint32_t row = base;
        for (int i = 0; i < size; i++) {
            uint32_t next = row + (uint32_t)(size - i + 1);
            for (int j = 0; j < size - i; j++) {
                uint32_t a = row + (uint32_t)j, b = next + (uint32_t)j;
                turned ? maker_triangle(m, a, a + 1, b) : maker_triangle(m, a, b, a + 1);
                if (j + 1 < size - i)
                    turned ? maker_triangle(m, a + 1, b + 1, b) : maker_triangle(m, a + 1, b, b + 1);
            }
            row = next;
        }
    }
}

/* A dense ball of radius `shrink` beside the middle of a triangle some units wide; the ball's vertices come first. */
#define TINY_BALL_MIDDLE vec3_make(0.61803, -0.41421, 0.73205)
static inline void maker_tiny_ball(struct maker *m, double shrink) {
    maker_sphere(m, 6);
    for (uint32_t i = 0; i < m->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            m->vertices[i][k] = m->vertices[i][k] * shrink + vec3_get(TINY_BALL_MIDDLE, k);
    uint32_t a = maker_vertex(m, -1.1, -0.4142, -1.3), b = maker_vertex(m, 1.7, -0.4142, -1.3);
    maker_triangle(m, a, b, maker_vertex(m, 1.7, -0.4142, 1.9));
}

/* A torus with a square section that turns by `twist` quarter turns along the ring, in `segments` steps. */
static inline void maker_twisted_torus(struct maker *m, int segments, int section, int twist) {
    uint32_t base = m->vertex_count;
    for (int i = 0; i < segments; i++)
        for (int j = 0; j < section; j++) {
            double a = 2 * M_PI * i / segments, b = 2 * M_PI * j / section + 2 * M_PI * twist * i / segments;
            double r = 2 + 0.7 * cos(b) * (1 + 0.2 * cos(2 * b));
            maker_vertex(m, r * cos(a), 0.7 * sin(b), r * sin(a));
        }
    for (int i = 0; i < segments; i++)
        for (int j = 0; j < section; j++) {
            int k = (i + 1) % segments, l = (j + 1) % section;
            uint32_t p = base + (uint32_t)(i * section + j), q = base + (uint32_t)(i * section + l);
            uint32_t r = base + (uint32_t)(k * section + j), s = base + (uint32_t)(k * section + l);
            maker_triangle(m, p, q, r);
            maker_triangle(m, q, s, r);
        }
}

enum soup {
    SOUP_EVEN,
    SOUP_SLIVERS,
    SOUP_PLANAR,
    SOUP_MIXED_SIZES,
    SOUP_TINY_IN_HUGE,
    SOUP_LATTICE,
    SOUP_LINE,
    SOUP_KINDS
};

static inline void maker_soup(struct maker *m, enum soup kind, uint32_t triangles, struct test_random *random) {
    for (uint32_t i = 0; i < triangles; i++) {
        double size = 0.1, c[3];
        for (int k = 0; k < 3; k++)
            c[k] = test_uniform(random, -1, 1);
        if (kind == SOUP_MIXED_SIZES)
            size = pow(10, test_uniform(random, -4, 0));
        if (kind == SOUP_TINY_IN_HUGE) {
            bool huge = i < 8;
            size = huge ? 1000 : 0.001;
            for (int k = 0; k < 3; k++)
                c[k] = huge ? c[k] * 1000 : 3 + 0.01 * c[k];
        }
        if (kind == SOUP_LINE)
            c[1] = c[2] = 0;
        uint32_t corner[3];
        for (int j = 0; j < 3; j++) {
            double p[3];
            for (int k = 0; k < 3; k++) {
                p[k] = c[k] + size * test_uniform(random, -1, 1);
                if (kind == SOUP_SLIVERS)
                    p[k] = c[k] + j * 0.2 * test_uniform(random, 0.999, 1) * (k + 1);
                if (kind == SOUP_LATTICE)
                    p[k] = floor(4 * p[k]) / 4 + 0.25 * floor(test_uniform(random, 0, 2));
            }
            if (kind == SOUP_PLANAR)
                p[1] = 0.25;
            corner[j] = maker_vertex(m, p[0], p[1], p[2]);
        }
        maker_triangle(m, corner[0], corner[1], corner[2]);
    }
}

static inline struct ray test_ray(struct vec3 origin, struct vec3 direction) {
    return (struct ray){.origin = origin, .direction = direction, .t_min = 0, .t_max = INFINITY};
}

static inline struct vec3 test_point(struct test_random *random, double size) {
    double x = test_uniform(random, -size, size), y = test_uniform(random, -size, size);
    return vec3_make(x, y, test_uniform(random, -size, size));
}

/* A ray of one of many kinds at a mesh: from inside, outside, far away, along axes, at vertices, along edges. */
static inline struct ray test_any_ray(const struct maker *m, const struct mesh *mesh, struct test_random *random) {
    struct box box = mesh_bounds(mesh);
    double size = vec3_length(vec3_sub(box.max, box.min));
    struct vec3 middle = vec3_scale(vec3_add(box.min, box.max), 0.5);
    int kind = (int)test_uniform(random, 0, 10);
    double distance = size * pow(10, kind == 0 ? test_uniform(random, 0, 7) : test_uniform(random, -1, 0.5));
    struct vec3 origin = vec3_add(middle, test_point(random, distance));
    uint32_t which = (uint32_t)test_uniform(random, 0, m->vertex_count), other = which;
    const double *v = m->vertices[which];
    struct vec3 target = vec3_make(v[0], v[1], v[2]);
    if (kind >= 6)
        target = vec3_add(middle, test_point(random, size / 3));
    if (kind == 2) { /* on a line between neighbours in the table: often an edge */
        other = which + 1 < m->vertex_count ? which + 1 : 0;
        const double *w = m->vertices[other];
        target = vec3_scale(vec3_add(target, vec3_make(w[0], w[1], w[2])), 0.5);
    }
    struct vec3 direction = vec3_sub(target, origin);
    if (kind == 3 || kind == 4) { /* along an axis, exactly over a vertex */
        int axis = (int)test_uniform(random, 0, 3);
        direction = vec3_make(axis == 0, axis == 1, axis == 2);
        if (kind == 4)
            direction = vec3_negate(direction);
        origin = vec3_add_scaled(target, direction, -size);
    }
    if (kind == 5) /* from a vertex */
        origin = target;
    struct ray ray = test_ray(origin, direction);
    if (kind == 8) {
        ray.t_min = test_uniform(random, 0, 1);
        ray.t_max = ray.t_min + test_uniform(random, 0, 1);
    }
    return ray;
}

#endif
