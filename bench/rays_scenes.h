/* The scenes of bench/rays: a table of triangles with a camera and a point light. */
#ifndef GRAY_BENCH_RAYS_SCENES_H
#define GRAY_BENCH_RAYS_SCENES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct bench_scene {
    char name[64];
    float (*vertices)[3]; /* single precision, so that every kernel sees the same numbers */
    uint32_t (*corners)[3];
    uint32_t vertex_count, triangle_count, vertex_capacity, triangle_capacity;
    float eye[3], target[3], light[3];
    float field; /* full vertical angle, degrees */
};

void bench_scene_free(struct bench_scene *scene);
/* Reads v and f lines of an OBJ file; polygons become fans. False: it cannot be read. Camera and light are unchanged.
 */
bool bench_load_obj(struct bench_scene *scene, const char *path);
/* Sets a camera in front and above, and a light beside it, from the bounding box. */
void bench_default_view(struct bench_scene *scene);

void bench_sierpinski(struct bench_scene *scene, int depth);
void bench_terrain(struct bench_scene *scene, int side);
/* Divides every triangle into four, `levels` times, then displaces the vertices slightly. */
void bench_subdivide(struct bench_scene *scene, int levels);
/* A mesh one unit high in a bowl two hundred units wide. */
void bench_stadium(struct bench_scene *scene, const struct bench_scene *mesh);
/* Meshes standing in a closed room of six plain walls. */
void bench_room(struct bench_scene *scene, const struct bench_scene *const *meshes, int count);
/* A world from a seed: clusters of blobs, grass of slivers, plates and boxes of very different sizes. */
void bench_world(struct bench_scene *scene, uint64_t seed);

#endif
