/* Points, rays, trees and meshes for randomised tests. */
#ifndef GRAY_TESTS_RANDOM_MAKERS_H
#define GRAY_TESTS_RANDOM_MAKERS_H

#include "csg/csg.h"
#include "mesh/mesh.h"
#include "tests/harness.h"

#include <math.h>

static inline struct vec3 random_vec3(struct test_random *random, double size) {
    double x = test_uniform(random, -size, size), y = test_uniform(random, -size, size);
    double z = test_uniform(random, -size, size);
    return vec3_make(x, y, z);
}

static inline struct ray ray_from(struct vec3 origin, struct vec3 direction) {
    return (struct ray){.origin = origin, .direction = direction, .t_min = -INFINITY, .t_max = INFINITY};
}

/* A random tree of `count` leaves from `first` on, in reverse Polish notation, with an inverse after some of the
 * tokens. Returns its length: 2 count - 1 and the inverses. */
static inline uint32_t random_program(struct test_random *random, uint32_t first, uint32_t count, double inverses,
                                      struct csg_token *program) {
    uint32_t length = 0, depth = 0, next = 0;
    while (next < count || depth > 1) {
        if (depth < 2 || (next < count && test_uniform(random, 0, 1) < 0.5)) {
            program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)(first + next++)};
            depth++;
        } else {
            double pick = test_uniform(random, 0, 3);
            program[length++] = (struct csg_token){pick < 1   ? CSG_UNION
                                                   : pick < 2 ? CSG_INTERSECTION
                                                              : CSG_DIFFERENCE,
                                                   0};
            depth--;
        }
        if (inverses > 0 && test_uniform(random, 0, 1) < inverses)
            program[length++] = (struct csg_token){CSG_INVERSE, 0};
    }
    return length;
}

/* A mesh with its index; a failure fails the test. */
static inline struct mesh *indexed_mesh(const struct mesh_input *input) {
    struct error error = {0};
    struct mesh *mesh = mesh_create(input, &error);
    if (!mesh || !mesh_build_accel(mesh, ACCEL_AUTO, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return mesh;
}

#endif
