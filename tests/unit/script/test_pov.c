/* Every shape and every combination against POV-Ray, if it is installed: tests/pov/pairs.lua writes the same scenes for
 * both programs. Which surface a pixel shows must be the same, and how far away it is, but for pixels at edges: those
 * whose 3 x 3 neighbours, in gray's picture, show another surface or one that is 0.15 units nearer or farther. */
#include "tests/harness.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* As in pairs.lua. */
#define DENSITY 0.1
/* Black fog in 16-bit numbers: half a step at the farthest surfaces is 3e-4 units; the patch is facets in both
 * programs.
 */
#define DEPTH_TOLERANCE 4e-4
#define FACET_TOLERANCE 2e-3
#define EDGE_DEPTH 0.15
/* A scene must not consist mostly of edges. */
#define MAX_EDGES 0.15

struct view {
    int width, height;
    int *colour;   /* a bit for each channel; 0: no surface */
    double *depth; /* from the camera */
};

static void take(struct view *view, int at, const double rgb[3]) {
    double max = fmax(rgb[0], fmax(rgb[1], rgb[2]));
    bool seen = max > 1e-3;
    view->colour[at] = 0;
    for (int k = 0; k < 3 && seen; k++)
        view->colour[at] |= (rgb[k] > max / 2) << k;
    view->depth[at] = seen ? -log(max) / DENSITY : 1e3;
}

static bool begin_view(struct view *view, int width, int height) {
    size_t count = (size_t)width * (size_t)height;
    *view = (struct view){width, height, calloc(count, sizeof *view->colour), calloc(count, sizeof *view->depth)};
    return view->colour && view->depth;
}

static void end_view(struct view *view) {
    free(view->colour);
    free(view->depth);
}

/* PFM: floats from the lowest row up. */
static bool read_gray(const char *path, struct view *view) {
    size_t size;
    char *data = test_read_file(path, &size);
    int width, height, used = 0;
    bool ok = data && sscanf(data, "PF %d %d %*f%n", &width, &height, &used) == 2 &&
              size == (size_t)used + 1 + 12 * (size_t)width * (size_t)height && begin_view(view, width, height);
    for (int i = 0; ok && i < width * height; i++) {
        float rgb[3];
        memcpy(rgb, data + used + 1 + 12 * i, sizeof rgb);
        take(view, (height - 1 - i / width) * width + i % width, (double[3]){rgb[0], rgb[1], rgb[2]});
    }
    free(data);
    return ok;
}

/* The next number of a PPM header; lines that begin with # are comments. NULL at its end. */
static char *header_number(char *at, int *number) {
    int used = 0;
    while (at && (*at == '\n' || *at == ' ' || *at == '#'))
        at = *at == '#' ? strchr(at, '\n') : at + 1;
    return at && sscanf(at, "%d%n", number, &used) == 1 ? at + used : NULL;
}

/* PPM of 16 bits, high byte first. */
static bool read_pov(const char *path, struct view *view) {
    size_t size;
    char *data = test_read_file(path, &size), *at = data && strncmp(data, "P6", 2) == 0 ? data + 2 : NULL;
    int width = 0, height = 0, max = 0;
    at = at ? header_number(at, &width) : NULL;
    at = at ? header_number(at, &height) : NULL;
    at = at ? header_number(at, &max) : NULL;
    bool ok = at && max == 65535 && size == (size_t)(at + 1 - data) + 6 * (size_t)width * (size_t)height &&
              begin_view(view, width, height);
    for (int i = 0; ok && i < width * height; i++) {
        const uint8_t *p = (const uint8_t *)at + 1 + 6 * i;
        double rgb[3];
        for (int k = 0; k < 3; k++)
            rgb[k] = (256 * p[2 * k] + p[2 * k + 1]) / 65535.0;
        take(view, i, rgb);
    }
    free(data);
    return ok;
}

static bool is_edge(const struct view *view, int x, int y) {
    int at = y * view->width + x;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            int nx = x + dx, ny = y + dy, n = ny * view->width + nx;
            if (nx < 0 || ny < 0 || nx >= view->width || ny >= view->height)
                continue;
            if (view->colour[n] != view->colour[at] || fabs(view->depth[n] - view->depth[at]) > EDGE_DEPTH)
                return true;
        }
    return false;
}

static void compare(const char *name, const struct view *gray, const struct view *pov) {
    int edges = 0, seen = 0, other = 0, far = 0, count = gray->width * gray->height;
    double largest = 0, tolerance = strcmp(name, "patch") == 0 ? FACET_TOLERANCE : DEPTH_TOLERANCE;
    CHECK(pov->width == gray->width && pov->height == gray->height);
    for (int i = 0; i < count; i++) {
        seen += gray->colour[i] != 0;
        if (is_edge(gray, i % gray->width, i / gray->width)) {
            edges++;
            continue;
        }
        other += gray->colour[i] != pov->colour[i];
        double difference = fabs(gray->depth[i] - pov->depth[i]);
        largest = fmax(largest, difference);
        far += difference > tolerance;
    }
    if (other > 0 || far > 0 || seen < count / 40 || edges > MAX_EDGES * count)
        test_fail(__FILE__, __LINE__, "%s: %d pixels show something else, %d are elsewhere (%g); %d seen, %d at edges",
                  name, other, far, largest, seen, edges);
}

/* Runs POV-Ray on the text of one scene and compares its picture with gray's, which exists already. */
static void check_scene(const char *name, const char *text) {
    char path[600], command[2000];
    struct view gray = {0}, pov = {0};
    (void)snprintf(path, sizeof path, "%s/%s.pov", test_folder(), name);
    test_write_text(path, text);
    (void)snprintf(command, sizeof command,
                   "cd '%s' && povray +I%s.pov +O%s.ppm +W200 +H150 +FP16 -A -D +WT1 File_Gamma=1.0 >%s.log 2>&1",
                   test_folder(), name, name, name);
    if (system(command) != 0) { /* NOLINT: the name comes from pairs.lua */
        test_fail(__FILE__, __LINE__, "povray fails on %s", path);
        return;
    }
    (void)snprintf(path, sizeof path, "%s/%s.pfm", test_folder(), name);
    bool ok = read_gray(path, &gray);
    (void)snprintf(path, sizeof path, "%s/%s.ppm", test_folder(), name);
    if (ok && read_pov(path, &pov))
        compare(name, &gray, &pov);
    else
        test_fail(__FILE__, __LINE__, "%s: a picture cannot be read", name);
    end_view(&gray);
    end_view(&pov);
}

TEST_LONG(silhouettes_depths_and_surfaces_of_every_shape_equal_those_of_pov_ray) {
    if (system("command -v povray >/dev/null 2>&1") != 0)
        test_skip("povray is not installed");
    char *script = test_read_file("tests/pov/pairs.lua", NULL);
    CHECK(script != NULL);
    struct test_result pictures = test_gray_scene(script, "-q -ss 1 scene.lua", NULL);
    struct test_result texts = test_gray_scene(script, "-q -D POV=true scene.lua", NULL);
    if (pictures.status != 0 || texts.status != 0)
        test_fail(__FILE__, __LINE__, "%s%s", pictures.err, texts.err);
    int scenes = 0;
    static const char mark[] = "// SCENE ";
    for (char *at = strstr(texts.out, mark), *next; at; at = next, scenes++) {
        char name[64];
        next = strstr(at + 1, mark);
        if (next)
            next[-1] = '\0';
        CHECK(sscanf(at + strlen(mark), "%63[a-z_]", name) == 1);
        check_scene(name, at);
    }
    CHECK(scenes >= 25);
    free(script);
    test_free_result(&pictures);
    test_free_result(&texts);
}
