/* A maker for every kind of shape, of about the size of the unit ball around the origin (planes and some quadrics have
 * no end), for tests that hold for all of them. The makers are in test_every_shape.c: the compiler names the one that
 * is missing for a new kind. */
#ifndef GRAY_TESTS_SHAPE_MAKERS_H
#define GRAY_TESTS_SHAPE_MAKERS_H

#include "base/arena.h"
#include "csg/geometry.h"
#include "math/affine.h"
#include "mesh/mesh.h"
#include "tests/harness.h"

enum { MADE_MESHES = 512 };

/* Owns what the shapes are made of. Zero-initialise to create. */
struct shape_makers {
    struct arena arena;
    struct mesh *meshes[MADE_MESHES]; /* beyond them earlier ones come again */
    uint32_t mesh_count;
};

/* Volume and area by a closed form, or NAN where there is none. The area of a curve, which faces every ray, is that of
 * a sheet which as many random lines cross. */
struct made_shape {
    struct shape shape;
    double volume, area;
};

struct made_shape make_shape(struct shape_makers *makers, enum shape_kind kind, struct test_random *random);
/* The same of what the world places: shapes by their kind, and SHAPE_KIND_COUNT for a CSG solid. */
struct made_geometry {
    struct geometry geometry;
    double volume, area;
};
enum { GEOMETRY_KIND_COUNT = SHAPE_KIND_COUNT + 1 };
struct made_geometry make_geometry(struct shape_makers *makers, int kind, struct test_random *random);
/* A closed shape of any kind. */
struct shape make_solid(struct shape_makers *makers, struct test_random *random);
void shape_makers_destroy(struct shape_makers *makers);

/* A map that turns, scales by 1/2 to 2 along each axis, mirrors now and then, and moves by up to `spread`. */
struct transform make_transform(struct test_random *random, double spread);

#endif
