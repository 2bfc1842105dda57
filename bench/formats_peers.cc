// The same files with Assimp and tinyobjloader, whichever are installed: reading and, as in gray, triangulating.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <sys/stat.h>
#ifdef PEER_ASSIMP
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#endif
#ifdef PEER_TINYOBJ
#include <tiny_obj_loader.h>
#endif

static double now(clockid_t clock) {
    timespec t = {};
    (void)clock_gettime(clock, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// The best wall-clock time and the best processor time of the rounds.
struct Best {
    double clock = 1e9, work = 1e9, clock_start = 0, work_start = 0;
    void start() {
        clock_start = now(CLOCK_MONOTONIC);
        work_start = now(CLOCK_PROCESS_CPUTIME_ID);
    }
    void stop() {
        clock = std::min(clock, now(CLOCK_MONOTONIC) - clock_start);
        work = std::min(work, now(CLOCK_PROCESS_CPUTIME_ID) - work_start);
    }
};

static void print_best(const char *path, const char *peer, const Best &best, size_t triangles) {
    struct stat status = {};
    (void)stat(path, &status);
    std::printf("%-32s %-14s %7.1f MB/s %6.3f s   processor %7.1f MB/s %6.3f s   %zu triangles\n", path, peer,
                double(status.st_size) / best.clock / 1e6, best.clock, double(status.st_size) / best.work / 1e6,
                best.work, triangles);
}

int main(int count, char **paths) {
    for (int i = 1; i < count; i++) {
        const char *path = paths[i];
#ifdef PEER_TINYOBJ
        if (std::strstr(path, ".obj")) {
            Best best;
            size_t triangles = 0;
            for (int round = 0; round < 3; round++) {
                best.start();
                tinyobj::ObjReader reader;
                if (!reader.ParseFromFile(path))
                    break;
                best.stop();
                triangles = 0;
                for (const auto &shape : reader.GetShapes())
                    triangles += shape.mesh.num_face_vertices.size();
            }
            print_best(path, "tinyobjloader", best, triangles);
        }
#endif
#ifdef PEER_ASSIMP
        // STL repeats every corner: like gray, Assimp joins equal vertices.
        unsigned work =
            aiProcess_Triangulate | (std::strstr(path, ".stl") ? unsigned(aiProcess_JoinIdenticalVertices) : 0);
        Best best;
        size_t triangles = 0;
        for (int round = 0; round < 3; round++) {
            best.start();
            Assimp::Importer importer;
            const aiScene *scene = importer.ReadFile(path, work);
            if (!scene)
                break;
            best.stop();
            triangles = 0;
            for (unsigned k = 0; k < scene->mNumMeshes; k++)
                triangles += scene->mMeshes[k]->mNumFaces;
        }
        print_best(path, "Assimp", best, triangles);
#endif
    }
}
