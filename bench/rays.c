/* The same rays through gray's mesh kernel and through Embree, interleaved in one process, on one thread or more:
 * camera rays 1024 x 1024, shadow rays from their hits to a point light, cosine-distributed bounces from there (fixed
 * seed). Every number is thread CPU time, the median of the repetitions; ratios are gray's speed divided by Embree's,
 * each from two interleaved runs. Camera rays are also traced in gray's packets of 64 and Embree's of 16 (coherent
 * flag). Embree is optional: build with -DHAVE_EMBREE and -lembree3.
 *
 *   rays [--models FOLDER] [--seed N] [--reps N] [--size N] [--threads N] [--json] [--isa NAME] [SCENE ...]
 *
 * With --threads the rays are distributed to that many threads in blocks of 4096, and a time is that of the slowest
 * thread; the structures are built by as many threads, and that time is wall-clock time.
 *
 * SCENE is a part of a scene's name; without one all are run. Meshes that are not in FOLDER are skipped with a message.
 * A disagreement is a ray where one kernel hits and the other does not, or the t differ by more than 1e-4 of their
 * size; both test in different precision, so rays past edges may differ: --explain lists the first few with the
 * distance to the nearest edge of the triangle in barycentric units. */
#include "base/isa.h"
#include "base/pool.h"
#include "bench/rays_scenes.h"
#include "mesh/mesh.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if defined(HAVE_EMBREE)
#include <embree3/rtcore.h>
#include <xmmintrin.h>
#endif

enum { KINDS = 3, MAX_REPS = 51, MAX_SCENES = 64 };
static const char *const kind_names[KINDS] = {"camera", "shadow", "bounce"};

struct bench_ray {
    float origin[3], direction[3], t_max;
};

struct bench_hit {
    float t;
    uint32_t triangle; /* UINT32_MAX: none */
    float u, v;
};

struct options {
    const char *models;
    uint64_t seed;
    int reps, threads;
    uint32_t size;
    bool json, explain;
    const char **wanted;
    int wanted_count;
};

struct timing {
    char name[64];
    uint32_t triangles;
    double build[2], memory[2]; /* gray, Embree: seconds and bytes */
    double speed[2][KINDS], packet_speed[2], ratio[KINDS], packet_ratio;
    uint64_t rays[KINDS], disagreements[KINDS];
};

static double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double wall_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double build_seconds(int threads) {
    return threads > 1 ? wall_seconds() : cpu_seconds();
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(double *values, int count) {
    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    return values[count / 2];
}

/* gray */

static struct mesh *gray_build(const struct bench_scene *scene, int threads, double *seconds, double *memory) {
    char warning[256];
    struct pool *pool = threads > 1 ? pool_create(threads, warning) : NULL;
    double(*vertices)[3] = malloc(scene->vertex_count * sizeof *vertices);
    uint32_t *starts = malloc(((size_t)scene->triangle_count + 1) * sizeof *starts);
    if (!vertices || !starts)
        exit(3);
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            vertices[i][k] = (double)scene->vertices[i][k];
    for (uint32_t i = 0; i <= scene->triangle_count; i++)
        starts[i] = 3 * i;
    struct mesh_input input = {.name = scene->name,
                               .vertex_count = scene->vertex_count,
                               .face_count = scene->triangle_count,
                               .vertices = (const double(*)[3])vertices,
                               .face_start = starts,
                               .vertex_index = scene->corners[0]};
    struct error error = {0};
    struct mesh *mesh = mesh_create(&input, &error);
    size_t bare = mesh ? mesh_memory(mesh) : 0;
    double start = build_seconds(threads);
    if (!mesh || !mesh_build_accel(mesh, ACCEL_AUTO, pool, &error)) {
        fprintf(stderr, "rays: %s\n", error.text);
        exit(3);
    }
    *seconds = build_seconds(threads) - start;
    *memory = (double)(mesh_memory(mesh) - bare);
    pool_destroy(pool);
    free(vertices);
    free(starts);
    return mesh;
}

static struct ray gray_ray(const struct bench_ray *r) {
    return (struct ray){.origin = {(double)r->origin[0], (double)r->origin[1], (double)r->origin[2]},
                        .direction = {(double)r->direction[0], (double)r->direction[1], (double)r->direction[2]},
                        .t_min = 0,
                        .t_max = (double)r->t_max};
}

static void gray_trace(const struct mesh *mesh, const struct bench_ray *rays, struct bench_hit *hits, uint64_t count,
                       bool any, struct geom_scratch *scratch) {
    for (uint64_t i = 0; i < count; i++) {
        struct ray ray = gray_ray(&rays[i]);
        struct crossing c;
        if (any)
            hits[i] = (struct bench_hit){.triangle = mesh_any(mesh, &ray, ACCEL_AUTO, scratch) ? 0 : UINT32_MAX};
        else if (mesh_nearest(mesh, &ray, ACCEL_AUTO, scratch, &c))
            hits[i] = (struct bench_hit){(float)c.t, c.part, (float)c.u, (float)c.v};
        else
            hits[i] = (struct bench_hit){.triangle = UINT32_MAX};
    }
}

/* Packets of one tile; the results must equal those of single rays to the bit. */
static void gray_trace64(const struct mesh *mesh, const struct bench_ray *rays, struct bench_hit *hits, uint64_t count,
                         struct geom_scratch *scratch) {
    struct ray_packet packet = {.t_min = 0};
    struct packet_hits met;
    for (uint64_t i = 0; i < count; i += PACKET_RAYS) {
        const struct bench_ray *r = &rays[i];
        packet.count = count - i < PACKET_RAYS ? (uint32_t)(count - i) : PACKET_RAYS;
        packet.origin = vec3_make((double)r->origin[0], (double)r->origin[1], (double)r->origin[2]);
        for (uint32_t k = 0; k < packet.count; k++) {
            for (int axis = 0; axis < 3; axis++)
                packet.direction[axis][k] = (double)r[k].direction[axis];
            packet.t_max[k] = (double)r[k].t_max;
        }
        ray_packet_pad(&packet);
        uint64_t found = mesh_nearest_packet(mesh, &packet, ray_packet_all(&packet), ACCEL_GRID, scratch, &met);
        for (uint32_t k = 0; k < packet.count; k++)
            hits[i + k] = found >> k & 1
                              ? (struct bench_hit){(float)met.t[k], met.triangle[k], (float)met.u[k], (float)met.v[k]}
                              : (struct bench_hit){.triangle = UINT32_MAX};
    }
}

/* Embree */

#if defined(HAVE_EMBREE)
struct embree {
    RTCDevice device;
    RTCScene scene;
};

static int64_t embree_bytes;

static bool count_memory(void *user, ssize_t bytes, bool post) {
    (void)user;
    (void)post;
    embree_bytes += bytes;
    return true;
}

static struct embree embree_build(const struct bench_scene *scene, int threads, double *seconds, double *memory) {
    char configuration[32];
    snprintf(configuration, sizeof configuration, "threads=%d", threads);
    struct embree e = {.device = rtcNewDevice(configuration)};
    embree_bytes = 0;
    rtcSetDeviceMemoryMonitorFunction(e.device, count_memory, NULL);
    e.scene = rtcNewScene(e.device);
    rtcSetSceneBuildQuality(e.scene, RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry geometry = rtcNewGeometry(e.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void *v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, scene->vertex_count);
    void *c = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, scene->triangle_count);
    memcpy(v, scene->vertices, (size_t)12 * scene->vertex_count);
    memcpy(c, scene->corners, (size_t)12 * scene->triangle_count);
    int64_t before = embree_bytes;
    double start = build_seconds(threads);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(e.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(e.scene);
    *seconds = build_seconds(threads) - start;
    *memory = (double)(embree_bytes - before);
    return e;
}

static void embree_trace(const struct embree *e, const struct bench_ray *rays, struct bench_hit *hits, uint64_t count,
                         bool any) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (uint64_t i = 0; i < count; i++) {
        const struct bench_ray *r = &rays[i];
        struct RTCRayHit q;
        q.ray.org_x = r->origin[0];
        q.ray.org_y = r->origin[1];
        q.ray.org_z = r->origin[2];
        q.ray.dir_x = r->direction[0];
        q.ray.dir_y = r->direction[1];
        q.ray.dir_z = r->direction[2];
        q.ray.tnear = 0;
        q.ray.tfar = r->t_max;
        q.ray.time = 0;
        q.ray.mask = UINT32_MAX;
        q.ray.id = q.ray.flags = 0;
        if (any) {
            rtcOccluded1(e->scene, &context, &q.ray);
            hits[i] = (struct bench_hit){.triangle = q.ray.tfar < 0 ? 0 : UINT32_MAX};
            continue;
        }
        q.hit.geomID = q.hit.primID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(e->scene, &context, &q);
        hits[i] = (struct bench_hit){q.ray.tfar, q.hit.primID, q.hit.u, q.hit.v};
    }
}

static void embree_trace16(const struct embree *e, const struct bench_ray *rays, struct bench_hit *hits,
                           uint64_t count) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    struct RTCRayHit16 q;
    _Alignas(64) int valid[16];
    for (uint64_t i = 0; i < count; i += 16) {
        for (uint64_t k = 0; k < 16; k++) {
            const struct bench_ray *r = &rays[i + k < count ? i + k : count - 1];
            valid[k] = i + k < count ? -1 : 0;
            q.ray.org_x[k] = r->origin[0];
            q.ray.org_y[k] = r->origin[1];
            q.ray.org_z[k] = r->origin[2];
            q.ray.dir_x[k] = r->direction[0];
            q.ray.dir_y[k] = r->direction[1];
            q.ray.dir_z[k] = r->direction[2];
            q.ray.tnear[k] = 0;
            q.ray.tfar[k] = r->t_max;
            q.ray.time[k] = 0;
            q.ray.mask[k] = UINT32_MAX;
            q.ray.id[k] = q.ray.flags[k] = 0;
            q.hit.geomID[k] = q.hit.primID[k] = q.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, e->scene, &context, &q);
        for (uint64_t k = 0; k < 16 && i + k < count; k++)
            hits[i + k] = (struct bench_hit){q.ray.tfar[k], q.hit.primID[k], q.hit.u[k], q.hit.v[k]};
    }
}

static bool agree(const struct bench_hit *a, const struct bench_hit *b, bool any) {
    if ((a->triangle == UINT32_MAX) != (b->triangle == UINT32_MAX))
        return false;
    return any || a->triangle == UINT32_MAX || a->triangle == b->triangle ||
           fabsf(a->t - b->t) <= 1e-4f * (1e-3f + fabsf(b->t));
}
#endif

/* Rays */

static uint64_t dice;

static double roll(void) {
    uint64_t x = dice += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

static struct vec3 load(const float p[3]) {
    return vec3_make((double)p[0], (double)p[1], (double)p[2]);
}

static void set_ray(struct bench_ray *ray, struct vec3 origin, struct vec3 direction, double t_max) {
    *ray = (struct bench_ray){{(float)origin.x, (float)origin.y, (float)origin.z},
                              {(float)direction.x, (float)direction.y, (float)direction.z},
                              (float)t_max};
}

/* In tiles of 8 x 8 pixels, as a renderer would. */
static void camera_rays(const struct bench_scene *scene, uint32_t size, struct bench_ray *rays) {
    struct vec3 eye = load(scene->eye), view = vec3_normalize(vec3_sub(load(scene->target), eye));
    struct vec3 right = vec3_normalize(vec3_cross(view, vec3_make(0, 1, 0))), up = vec3_cross(right, view);
    double path_policy = tan((double)scene->field * M_PI / 360);
    uint64_t at = 0;
    for (uint32_t tile = 0; tile < size / 8 * (size / 8); tile++)
        for (uint32_t i = 0; i < 64; i++) {
            uint32_t x = tile % (size / 8) * 8 + i % 8, y = tile / (size / 8) * 8 + i / 8;
            double a = path_policy * ((x + 0.5) / size * 2 - 1), b = path_policy * (1 - (y + 0.5) / size * 2);
            set_ray(&rays[at++], eye, vec3_add_scaled(vec3_add_scaled(view, right, a), up, b), INFINITY);
        }
}

/* From the hits of the camera rays, slightly above the surface. */
static void secondary_rays(const struct bench_scene *scene, const struct mesh *mesh, const struct bench_ray *camera,
                           const struct bench_hit *hits, uint64_t count, struct bench_ray *shadow,
                           struct bench_ray *bounce, uint64_t *made) {
    *made = 0;
    struct box box = mesh_bounds(mesh);
    double lift = 1e-5 * vec3_length(vec3_sub(box.max, box.min));
    for (uint64_t i = 0; i < count; i++) {
        if (hits[i].triangle == UINT32_MAX)
            continue;
        struct ray ray = gray_ray(&camera[i]);
        const uint32_t *c = scene->corners[hits[i].triangle];
        struct vec3 a = load(scene->vertices[c[0]]);
        struct vec3 normal = vec3_normalize(
            vec3_cross(vec3_sub(load(scene->vertices[c[1]]), a), vec3_sub(load(scene->vertices[c[2]]), a)));
        if (vec3_dot(normal, ray.direction) > 0)
            normal = vec3_negate(normal);
        struct vec3 point = vec3_add_scaled(ray_at(&ray, (double)hits[i].t), normal, lift);
        set_ray(&shadow[*made], point, vec3_sub(load(scene->light), point), 1);
        struct vec3 side = fabs(normal.x) < 0.5 ? vec3_make(1, 0, 0) : vec3_make(0, 1, 0);
        side = vec3_normalize(vec3_cross(normal, side));
        double r = sqrt(roll()), angle = 2 * M_PI * roll();
        struct vec3 direction = vec3_scale(normal, sqrt(1 - r * r));
        direction = vec3_add_scaled(direction, side, r * cos(angle));
        direction = vec3_add_scaled(direction, vec3_cross(normal, side), r * sin(angle));
        set_ray(&bounce[(*made)++], point, direction, INFINITY);
    }
}

#if defined(HAVE_EMBREE)
static void explain(const struct bench_scene *scene, const char *kind, const struct bench_hit *ours,
                    const struct bench_hit *theirs) {
    const struct bench_hit *h = ours->triangle != UINT32_MAX ? ours : theirs;
    printf("    %s %s: ours %u at %.7g, theirs %u at %.7g, distance to an edge %.2g / %.2g\n", scene->name, kind,
           ours->triangle, (double)ours->t, theirs->triangle, (double)theirs->t,
           (double)fminf(h->u, fminf(h->v, 1 - h->u - h->v)),
           (double)fminf(theirs->u, fminf(theirs->v, 1 - theirs->u - theirs->v)));
}
#endif

/* Rays on threads */

enum shared_state { GRAY_SINGLE, GRAY_PACKETS, EMBREE_SINGLE, EMBREE_PACKETS };
enum { RAYS_IN_TURN = 4096, MAX_THREADS = 64 };

struct work {
    enum shared_state tracer;
    bool any;
    const struct mesh *mesh;
#if defined(HAVE_EMBREE)
    const struct embree *embree;
#endif
    const struct bench_ray *rays;
    struct bench_hit *hits;
    uint64_t count;
};

struct share {
    const struct work *work;
    int number, threads;
    struct geom_scratch scratch;
    double seconds;
};

static void trace_piece(const struct work *work, uint64_t from, uint64_t count, struct geom_scratch *scratch) {
    const struct bench_ray *rays = work->rays + from;
    struct bench_hit *hits = work->hits + from;
    switch (work->tracer) {
    case GRAY_SINGLE:
        gray_trace(work->mesh, rays, hits, count, work->any, scratch);
        return;
    case GRAY_PACKETS:
        gray_trace64(work->mesh, rays, hits, count, scratch);
        return;
    case EMBREE_SINGLE:
    case EMBREE_PACKETS:
#if defined(HAVE_EMBREE)
        if (work->tracer == EMBREE_SINGLE)
            embree_trace(work->embree, rays, hits, count, work->any);
        else
            embree_trace16(work->embree, rays, hits, count);
#endif
        return;
    }
}

static void *trace_share(void *argument) {
    struct share *share = argument;
    const struct work *work = share->work;
    uint64_t turn = share->threads > 1 ? RAYS_IN_TURN : work->count;
#if defined(HAVE_EMBREE)
    unsigned mode = _mm_getcsr();
    if (work->tracer >= EMBREE_SINGLE)
        _mm_setcsr(mode | 0x8040); /* Embree requires denormals to be flushed */
#endif
    double start = cpu_seconds();
    for (uint64_t from = turn * (uint64_t)share->number; from < work->count; from += turn * (uint64_t)share->threads)
        trace_piece(work, from, work->count - from < turn ? work->count - from : turn, &share->scratch);
    share->seconds = cpu_seconds() - start;
#if defined(HAVE_EMBREE)
    _mm_setcsr(mode);
#endif
    return NULL;
}

/* Seconds of the slowest thread. */
static double trace(const struct work *work, struct share *shares, int threads) {
    pthread_t thread[MAX_THREADS];
    double longest = 0;
    for (int i = 0; i < threads; i++) {
        shares[i].work = work;
        if (i > 0 && pthread_create(&thread[i], NULL, trace_share, &shares[i]) != 0)
            exit(3);
    }
    trace_share(&shares[0]);
    for (int i = 0; i < threads; i++) {
        if (i > 0)
            pthread_join(thread[i], NULL);
        longest = fmax(longest, shares[i].seconds);
    }
    return longest;
}

static void measure(const struct bench_scene *scene, const struct options *options, struct timing *result) {
    *result = (struct timing){.triangles = scene->triangle_count};
    snprintf(result->name, sizeof result->name, "%s", scene->name);
    int threads = options->threads;
    struct share shares[MAX_THREADS];
    for (int i = 0; i < threads; i++) {
        shares[i] = (struct share){.number = i, .threads = threads};
        if (!geom_scratch_init(&shares[i].scratch, 1024))
            exit(3);
    }
    struct mesh *mesh = gray_build(scene, threads, &result->build[0], &result->memory[0]);
    struct work work = {.mesh = mesh};
#if defined(HAVE_EMBREE)
    struct embree embree = embree_build(scene, threads, &result->build[1], &result->memory[1]);
    work.embree = &embree;
#endif
    uint64_t pixels = (uint64_t)options->size * options->size;
    struct bench_ray *rays[KINDS];
    struct bench_hit *hits[2], *packet_hits = calloc(pixels, sizeof *packet_hits);
    for (int i = 0; i < KINDS; i++)
        rays[i] = malloc(pixels * sizeof *rays[i]);
    for (int i = 0; i < 2; i++)
        hits[i] = calloc(pixels, sizeof *hits[i]);
    camera_rays(scene, options->size, rays[0]);
    gray_trace(mesh, rays[0], hits[0], pixels, false, &shares[0].scratch);
    secondary_rays(scene, mesh, rays[0], hits[0], pixels, rays[1], rays[2], &result->rays[1]);
    result->rays[0] = pixels;
    result->rays[2] = result->rays[1];
    for (int kind = 0; kind < KINDS; kind++) {
        double seconds[2][MAX_REPS], ratio[MAX_REPS], packet[2][MAX_REPS], packet_ratio[MAX_REPS];
        uint64_t count = result->rays[kind];
        if (count == 0)
            continue;
        for (int rep = 0; rep < options->reps; rep++) {
            work.rays = rays[kind];
            work.count = count;
            work.any = kind == 1;
            work.hits = hits[0];
            work.tracer = GRAY_SINGLE;
            seconds[0][rep] = trace(&work, shares, threads);
            work.hits = packet_hits;
            work.tracer = GRAY_PACKETS;
            packet[0][rep] = kind == 0 ? trace(&work, shares, threads) : 0;
            for (uint64_t i = 0; rep == 0 && kind == 0 && i < count; i++)
                if (packet_hits[i].triangle != hits[0][i].triangle ||
                    (packet_hits[i].triangle != UINT32_MAX && memcmp(&packet_hits[i], &hits[0][i], sizeof *hits[0]))) {
                    fprintf(stderr, "rays: %s: ray %llu of a packet has another answer than alone\n", scene->name,
                            (unsigned long long)i);
                    exit(3);
                }
#if defined(HAVE_EMBREE)
            work.hits = hits[1];
            work.tracer = EMBREE_SINGLE;
            seconds[1][rep] = trace(&work, shares, threads);
            for (uint64_t i = 0; rep == 0 && i < count; i++)
                if (!agree(&hits[0][i], &hits[1][i], kind == 1) && result->disagreements[kind]++ < 5 &&
                    options->explain)
                    explain(scene, kind_names[kind], &hits[0][i], &hits[1][i]);
            work.tracer = EMBREE_PACKETS;
            packet[1][rep] = kind == 0 ? trace(&work, shares, threads) : 0;
#else
            seconds[1][rep] = packet[1][rep] = INFINITY;
#endif
            ratio[rep] = seconds[1][rep] / seconds[0][rep];
            packet_ratio[rep] = packet[1][rep] / packet[0][rep];
        }
        result->ratio[kind] = median(ratio, options->reps);
        for (int k = 0; k < 2; k++)
            result->speed[k][kind] = 1e-6 * (double)count / median(seconds[k], options->reps);
        if (kind == 0) {
            result->packet_ratio = median(packet_ratio, options->reps);
            for (int k = 0; k < 2; k++)
                result->packet_speed[k] = 1e-6 * (double)count / median(packet[k], options->reps);
        }
    }
    for (int i = 0; i < KINDS; i++)
        free(rays[i]);
    free(hits[0]);
    free(hits[1]);
    free(packet_hits);
    mesh_release(mesh);
    for (int i = 0; i < threads; i++)
        geom_scratch_destroy(&shares[i].scratch);
#if defined(HAVE_EMBREE)
    rtcReleaseScene(embree.scene);
    rtcReleaseDevice(embree.device);
#endif
}

static void print_row(const struct timing *r) {
    printf("%-18s %8u | %7.1f %5.2f | %6.1f %5.2f |", r->name, r->triangles, 1e3 * r->build[0],
           r->build[0] / r->build[1], r->memory[0] / r->triangles, r->memory[0] / r->memory[1]);
    for (int k = 0; k < KINDS; k++)
        printf(" %6.2f", r->speed[0][k]);
    printf(" | %5.2f %5.2f %5.2f | %6.2f %6.2f %5.2f |", r->ratio[0], r->ratio[1], r->ratio[2], r->packet_speed[0],
           r->packet_speed[1], r->packet_ratio);
    for (int k = 0; k < KINDS; k++)
        printf(" %llu", (unsigned long long)r->disagreements[k]);
    printf("\n");
    fflush(stdout);
}

static void print_json(const struct timing *results, int count) {
    printf("[\n");
    for (int i = 0; i < count; i++) {
        const struct timing *r = &results[i];
        printf("  {\"scene\": \"%s\", \"triangles\": %u, \"build_seconds\": [%.6f, %.6f], \"bytes\": [%.0f, %.0f]",
               r->name, r->triangles, r->build[0], r->build[1], r->memory[0], r->memory[1]);
        for (int k = 0; k < KINDS; k++)
            printf(", \"%s\": {\"rays\": %llu, \"mrays\": [%.3f, %.3f], \"ratio\": %.4f, \"disagreements\": %llu}",
                   kind_names[k], (unsigned long long)r->rays[k], r->speed[0][k], r->speed[1][k], r->ratio[k],
                   (unsigned long long)r->disagreements[k]);
        printf(", \"packets\": {\"mrays\": [%.3f, %.3f], \"ratio\": %.4f}}%s\n", r->packet_speed[0], r->packet_speed[1],
               r->packet_ratio, i + 1 < count ? "," : "");
    }
    printf("]\n");
}

static void print_summary(const struct timing *results, int count) {
    double log_sum[KINDS + 3] = {0}, worst[KINDS + 3];
    for (int k = 0; k < KINDS + 3; k++)
        worst[k] = k < KINDS + 1 ? INFINITY : 0;
    for (int i = 0; i < count; i++) {
        const struct timing *r = &results[i];
        double value[KINDS + 3] = {r->ratio[0],
                                   r->ratio[1],
                                   r->ratio[2],
                                   r->packet_ratio,
                                   r->build[0] / r->build[1],
                                   r->memory[0] / r->memory[1]};
        for (int k = 0; k < KINDS + 3; k++) {
            log_sum[k] += log(value[k]);
            worst[k] = k < KINDS + 1 ? fmin(worst[k], value[k]) : fmax(worst[k], value[k]);
        }
    }
    printf("geometric mean: camera %.2f shadow %.2f bounce %.2f, against packets %.2f, build %.2f, memory %.2f\n",
           exp(log_sum[0] / count), exp(log_sum[1] / count), exp(log_sum[2] / count), exp(log_sum[3] / count),
           exp(log_sum[4] / count), exp(log_sum[5] / count));
    printf("worst:          camera %.2f shadow %.2f bounce %.2f, against packets %.2f, build %.2f, memory %.2f\n",
           worst[0], worst[1], worst[2], worst[3], worst[4], worst[5]);
}

struct bench {
    struct options options;
    struct timing results[MAX_SCENES];
    int count;
};

static bool wanted(const struct bench *bench, const char *name) {
    for (int i = 0; i < bench->options.wanted_count; i++)
        if (strstr(name, bench->options.wanted[i]))
            return true;
    return bench->options.wanted_count == 0;
}

static void run_scene(struct bench *bench, struct bench_scene *scene) {
    struct timing *result = &bench->results[bench->count++];
    measure(scene, &bench->options, result);
    if (!bench->options.json)
        print_row(result);
}

static bool load_model(const struct bench *bench, const char *name, struct bench_scene *scene) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.obj", bench->options.models, name);
    *scene = (struct bench_scene){0};
    if (bench_load_obj(scene, path)) {
        snprintf(scene->name, sizeof scene->name, "%s", name);
        bench_default_view(scene);
        return true;
    }
    fprintf(stderr, "rays: %s is not there, skipped\n", path);
    return false;
}

static void run_made_of_models(struct bench *bench) {
    struct bench_scene mesh = {0}, scene = {0};
    if (wanted(bench, "subdivided") && load_model(bench, "stanford-bunny", &mesh)) {
        bench_subdivide(&mesh, 2);
        snprintf(mesh.name, sizeof mesh.name, "subdivided");
        bench_default_view(&mesh);
        run_scene(bench, &mesh);
        bench_scene_free(&mesh);
    }
    static const char *const in_stadium[] = {"teapot", "nefertiti"};
    for (int i = 0; i < 2; i++) {
        char name[64];
        snprintf(name, sizeof name, "stadium-%s", in_stadium[i]);
        if (!wanted(bench, name) || !load_model(bench, in_stadium[i], &mesh))
            continue;
        snprintf(scene.name, sizeof scene.name, "%s", name);
        bench_stadium(&scene, &mesh);
        run_scene(bench, &scene);
        bench_scene_free(&scene);
        bench_scene_free(&mesh);
    }
    static const char *const in_room[] = {"teapot", "stanford-bunny", "cow", "nefertiti", "fandisk", "spot"};
    struct bench_scene furniture[6];
    const struct bench_scene *pieces[6];
    int count = 0;
    for (int i = 0; i < 6 && wanted(bench, "room"); i++)
        if (load_model(bench, in_room[i], &furniture[count])) {
            pieces[count] = &furniture[count];
            count++;
        }
    if (count) {
        snprintf(scene.name, sizeof scene.name, "room");
        bench_room(&scene, pieces, count);
        run_scene(bench, &scene);
        bench_scene_free(&scene);
    }
    for (int i = 0; i < count; i++)
        bench_scene_free(&furniture[i]);
}

static void run_all(struct bench *bench) {
    static const char *const models[] = {"teapot", "cow", "spot", "fandisk", "cessna", "stanford-bunny", "nefertiti"};
    struct bench_scene scene = {0};
    if (!bench->options.json)
        printf("%-18s %8s | %7s %5s | %6s %5s | %-20s | %-17s | %-19s | %s\n", "scene", "tris", "build", "ratio",
               "B/tri", "ratio", "camera shadow bounce", "ratio to Embree", "packets, 16, ratio", "disagreements");
    for (size_t i = 0; i < sizeof models / sizeof *models; i++)
        if (wanted(bench, models[i]) && load_model(bench, models[i], &scene)) {
            run_scene(bench, &scene);
            bench_scene_free(&scene);
        }
    if (wanted(bench, "sierpinski")) {
        snprintf(scene.name, sizeof scene.name, "sierpinski");
        bench_sierpinski(&scene, 9);
        run_scene(bench, &scene);
        bench_scene_free(&scene);
    }
    if (wanted(bench, "terrain")) {
        snprintf(scene.name, sizeof scene.name, "terrain");
        bench_terrain(&scene, 1024);
        run_scene(bench, &scene);
        bench_scene_free(&scene);
    }
    run_made_of_models(bench);
    for (uint64_t i = 0; i < 3; i++) {
        char name[64];
        snprintf(name, sizeof name, "world-%llu", (unsigned long long)(bench->options.seed + i));
        if (!wanted(bench, name))
            continue;
        memcpy(scene.name, name, sizeof name);
        bench_world(&scene, bench->options.seed + i);
        run_scene(bench, &scene);
        bench_scene_free(&scene);
    }
}

int main(int argc, char **argv) {
    static struct bench bench = {.options = {.models = "models", .seed = 1, .reps = 5, .threads = 1, .size = 1024}};
    const char *names[64];
    bench.options.wanted = names;
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(word, "--json") == 0)
            bench.options.json = true;
        else if (strcmp(word, "--explain") == 0)
            bench.options.explain = true;
        else if (strcmp(word, "--models") == 0)
            bench.options.models = value, i++;
        else if (strcmp(word, "--seed") == 0)
            bench.options.seed = strtoull(value, NULL, 10), i++;
        else if (strcmp(word, "--reps") == 0)
            bench.options.reps = atoi(value), i++;
        else if (strcmp(word, "--threads") == 0)
            bench.options.threads = atoi(value), i++;
        else if (strcmp(word, "--size") == 0)
            bench.options.size = (uint32_t)atoi(value) / 8 * 8, i++;
        else if (strcmp(word, "--isa") == 0 && cpu_select_isa(value))
            i++;
        else if (word[0] != '-' && bench.options.wanted_count < 64)
            names[bench.options.wanted_count++] = word;
        else {
            fprintf(stderr, "usage: rays [--models FOLDER] [--seed N] [--reps N] [--size N] [--threads N] [--isa NAME] "
                            "[--json] [--explain] [SCENE ...]\n");
            return 2;
        }
    }
    if (bench.options.reps < 1 || bench.options.reps > MAX_REPS || bench.options.size < 8 ||
        bench.options.threads < 1 || bench.options.threads > MAX_THREADS) {
        fprintf(stderr, "rays: --reps is 1 to %d, --threads 1 to %d, --size at least 8\n", MAX_REPS, MAX_THREADS);
        return 2;
    }
    run_all(&bench);
    if (bench.options.json)
        print_json(bench.results, bench.count);
    else if (bench.count)
        print_summary(bench.results, bench.count);
    return 0;
}
