/* How fast mesh files become meshes: reads every file named on the command line three times, tells the best. */
#include "base/error.h"
#include "formats/model.h"

#include <stdio.h>
#include <sys/stat.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int count, char **paths) {
    for (int i = 1; i < count; i++) {
        double best = 1e9;
        unsigned triangles = 0;
        struct stat status = {0};
        for (int round = 0; round < 3; round++) {
            struct model model;
            struct error error = {0};
            struct model_options options = {0};
            double start = now();
            if (!model_read(&model, paths[i], &options, &error)) {
                (void)fprintf(stderr, "%s\n", error.text);
                return 1;
            }
            double seconds = now() - start;
            best = seconds < best ? seconds : best;
            triangles = 0;
            for (size_t k = 0; k < model.meshes.count; k++)
                triangles += mesh_triangle_count(model_meshes(&model)[k].mesh);
            model_destroy(&model);
        }
        (void)stat(paths[i], &status);
        (void)printf("%-28s gray            %8.1f MB/s  %6.3f s  %u triangles\n", paths[i], (double)status.st_size / best / 1e6,
                     best, triangles);
    }
    return 0;
}
