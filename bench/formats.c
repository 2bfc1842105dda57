/* The speed of the mesh readers: reads every file named on the command line three times and prints the best wall-clock
 * time and the best processor time, which depends less on other programs. */
#include "base/error.h"
#include "formats/model.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

static double now(clockid_t clock) {
    struct timespec t;
    (void)clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void put32(FILE *file, uint32_t bits) {
    for (int i = 0; i < 4; i++)
        (void)fputc((int)(bits >> 8 * i & 255), file);
}

static void put_float(FILE *file, double x) {
    float single = (float)x;
    uint32_t bits;
    memcpy(&bits, &single, 4);
    put32(file, bits);
}

static void write_stl(const struct mesh *mesh, FILE *file) {
    uint32_t ignored;
    const double(*vertices)[3] = mesh_vertices(mesh, &ignored);
    for (int i = 0; i < 80; i++)
        (void)fputc(0, file);
    put32(file, mesh_face_count(mesh));
    for (uint32_t f = 0; f < mesh_face_count(mesh); f++) {
        const uint32_t *face = mesh_face(mesh, f, &ignored);
        for (int i = -3; i < 9; i++)
            put_float(file, i < 0 ? 0 : vertices[face[i / 3]][i % 3]);
        (void)fputc(0, file);
        (void)fputc(0, file);
    }
}

static void write_ply(const struct mesh *mesh, FILE *file) {
    uint32_t count, ignored;
    const double(*vertices)[3] = mesh_vertices(mesh, &count);
    fprintf(file, "ply\nformat binary_little_endian 1.0\nelement vertex %u\n", count);
    fprintf(file, "property float x\nproperty float y\nproperty float z\n");
    fprintf(file, "element face %u\nproperty list uchar int vertex_indices\nend_header\n", mesh_face_count(mesh));
    for (uint32_t i = 0; i < 3 * count; i++)
        put_float(file, vertices[i / 3][i % 3]);
    for (uint32_t f = 0; f < mesh_face_count(mesh); f++) {
        const uint32_t *face = mesh_face(mesh, f, &ignored);
        (void)fputc(3, file);
        for (int i = 0; i < 3; i++)
            put32(file, face[i]);
    }
}

/* Writes the first mesh of a file as binary triangles, which a shell script cannot do. */
static int convert(const char *from, const char *to, void (*write)(const struct mesh *, FILE *)) {
    struct model model;
    struct error error = {0};
    struct model_options options = {0};
    FILE *file = model_read(&model, from, &options, &error) ? fopen(to, "wb") : NULL;
    if (!file)
        return 1;
    write(model_meshes(&model)[0].mesh, file);
    model_destroy(&model);
    return fclose(file);
}

int main(int count, char **paths) {
    if (count == 4 && strcmp(paths[1], "--stl") == 0)
        return convert(paths[2], paths[3], write_stl);
    if (count == 4 && strcmp(paths[1], "--ply") == 0)
        return convert(paths[2], paths[3], write_ply);
    for (int i = 1; i < count; i++) {
        double best = 1e9, best_work = 1e9;
        unsigned triangles = 0;
        struct stat status = {0};
        for (int round = 0; round < 3; round++) {
            struct model model;
            struct error error = {0};
            struct model_options options = {0};
            double start = now(CLOCK_MONOTONIC), work = now(CLOCK_PROCESS_CPUTIME_ID);
            if (!model_read(&model, paths[i], &options, &error)) {
                (void)fprintf(stderr, "%s\n", error.text);
                return 1;
            }
            double seconds = now(CLOCK_MONOTONIC) - start;
            work = now(CLOCK_PROCESS_CPUTIME_ID) - work;
            best = seconds < best ? seconds : best;
            best_work = work < best_work ? work : best_work;
            triangles = 0;
            for (size_t k = 0; k < model.meshes.count; k++)
                triangles += mesh_triangle_count(model_meshes(&model)[k].mesh);
            model_destroy(&model);
        }
        (void)stat(paths[i], &status);
        (void)printf("%-32s gray           %7.1f MB/s %6.3f s   processor %7.1f MB/s %6.3f s   %u triangles\n",
                     paths[i], (double)status.st_size / best / 1e6, best, (double)status.st_size / best_work / 1e6,
                     best_work, triangles);
    }
    return 0;
}
