/* A maker for every kind of shape, about as large as the unit ball at the origin (planes and some quadrics are
 * unbounded), for tests that hold for all of them. The makers are in test_every_shape.c: the compiler names the one
 * that is missing for a new kind. */
#ifndef GRAY_TESTS_SHAPE_MAKERS_H
#define GRAY_TESTS_SHAPE_MAKERS_H

#include "base/arena.h"
#include "csg/geometry.h"
#include "math/affine.h"
#include "mesh/mesh.h"
#include "tests/harness.h"

enum { MADE_MESHES = 512 };

/* Owns the memory of the shapes. Zero-initialise to create. */
struct shape_makers {
    struct arena arena;
    struct mesh *meshes[MADE_MESHES]; /* after that, earlier ones are used again */
    uint32_t mesh_count;
};

/* Volume and area in closed form, or NAN if there is none. A curve faces every ray; its area is that of a sheet that as
 * many random lines cross. */
struct made_shape {
    struct shape shape;
    double volume, area;
};

struct made_shape make_shape(struct shape_makers *makers, enum shape_kind kind, struct test_random *random);
/* The same for everything that a world contains: shapes by their kind, and SHAPE_KIND_COUNT for a CSG solid. */
struct made_geometry {
    struct geometry geometry;
    double volume, area;
};
enum { GEOMETRY_KIND_COUNT = SHAPE_KIND_COUNT + 1 };
struct made_geometry make_geometry(struct shape_makers *makers, int kind, struct test_random *random);
/* A closed shape of any kind. */
struct shape make_solid(struct shape_makers *makers, struct test_random *random);
void shape_makers_destroy(struct shape_makers *makers);

/* A map that rotates, scales by 1/2 to 2 along each axis, sometimes mirrors, and translates by up to `spread`. */
struct transform make_transform(struct test_random *random, double spread);

#endif
