// The same files through Assimp and tinyobjloader, whichever the compiler finds: reading and, as we do, triangulating.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <sys/stat.h>
#ifdef PEER_ASSIMP
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#endif
#ifdef PEER_TINYOBJ
#include <tiny_obj_loader.h>
#endif

static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

static void tell(const char *path, const char *peer, double seconds, size_t triangles) {
    struct stat status = {};
    (void)stat(path, &status);
    std::printf("%-28s %-15s %8.1f MB/s  %6.3f s  %zu triangles\n", path, peer, double(status.st_size) / seconds / 1e6,
                seconds, triangles);
}

int main(int count, char **paths) {
    for (int i = 1; i < count; i++) {
        const char *path = paths[i];
#ifdef PEER_TINYOBJ
        if (std::strstr(path, ".obj")) {
            double best = 1e9;
            size_t triangles = 0;
            for (int round = 0; round < 3; round++) {
                double start = now();
                tinyobj::ObjReader reader;
                if (!reader.ParseFromFile(path))
                    break;
                best = std::min(best, now() - start);
                triangles = 0;
                for (const auto &shape : reader.GetShapes())
                    triangles += shape.mesh.num_face_vertices.size();
            }
            tell(path, "tinyobjloader", best, triangles);
        }
#endif
#ifdef PEER_ASSIMP
        // STL repeats every corner: like us, it makes one vertex of those in one place.
        unsigned work = aiProcess_Triangulate | (std::strstr(path, ".stl") ? unsigned(aiProcess_JoinIdenticalVertices) : 0);
        double best = 1e9;
        size_t triangles = 0;
        for (int round = 0; round < 3; round++) {
            double start = now();
            Assimp::Importer importer;
            const aiScene *scene = importer.ReadFile(path, work);
            if (!scene)
                break;
            best = std::min(best, now() - start);
            triangles = 0;
            for (unsigned k = 0; k < scene->mNumMeshes; k++)
                triangles += scene->mMeshes[k]->mNumFaces;
        }
        tell(path, "Assimp", best, triangles);
#endif
    }
}
