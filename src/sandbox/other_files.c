/* A table of first bytes and endings. The first bytes decide before the ending does. */
#include "sandbox/other_files_internal.h"

#include <string.h>
#include <strings.h>

#define PICTURE "is a picture, not a scene; -o FILE names the picture to write, and gr.texture('FILE') reads one"
#define MODEL "is a model, not a scene; a script shows it with gr.mesh(material, 'FILE')"
#define OTHER_MODEL "is a model, not a scene; gr.mesh of a script reads OBJ, PLY, STL and glTF files"
#define OTHER_SCENE "is a file of another program; gray reads scenes that are Lua scripts (docs/language.md)"

/* Endings are separated by blanks. */
static const struct {
    const char *first_bytes, *endings, *words;
} kinds[] = {
    {"\x89PNG", ".png .jpg .jpeg .gif .hdr .exr .webp .bmp .tif .tiff .tga .ppm .pfm .svg", PICTURE},
    {"\xff\xd8\xff", ".apng .mp4 .webm .y4m .mkv .mov .avi", PICTURE},
    {"GIF8", "", PICTURE},
    {"#?RADIANCE", "", PICTURE},
    {"RIFF", "", PICTURE},
    {"glTF", ".glb .gltf .ply .stl .obj .gz", MODEL},
    {"ply\n", "", MODEL},
    {"solid ", "", MODEL},
    {"Kaydara FBX", ".fbx .3ds .dae .off .step .stp .iges .3mf .usd .usda .usdz .abc .x3d .wrl", OTHER_MODEL},
    {"BLENDER", ".blend .pov .inc .scad .pbrt .pde .py .js .json .xml .ma .mb .max .c4d .skp", OTHER_SCENE},
    {"<!DOCTYPE", ".html .htm .md .txt .pdf .doc .csv .sh .zip", OTHER_SCENE},
    {"<", "", OTHER_SCENE},
    {"PK\x03\x04", "", OTHER_SCENE},
};

static const char *ending_words(const char *path) {
    const char *dot = strrchr(path, '.');
    size_t length = dot ? strlen(dot) : 0;
    if (length < 2 || strpbrk(dot, "/ "))
        return NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        for (const char *at = kinds[i].endings; *at;) {
            size_t end = strcspn(at, " ");
            if (end == length && strncasecmp(at, dot, length) == 0)
                return kinds[i].words;
            at += end + (at[end] == ' ');
        }
    }
    return NULL;
}

const char *other_file_words(const char *path, const void *data, size_t size) {
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        size_t length = strlen(kinds[i].first_bytes);
        if (size >= length && memcmp(data, kinds[i].first_bytes, length) == 0)
            return kinds[i].words;
    }
    return ending_words(path);
}

const char *other_command_words(const char *name) {
    static const char *const commands[][2] = {{"help", "gray --help lists the options"},
                                              {"usage", "gray --help lists the options"},
                                              {"man", "gray --man is the manual"},
                                              {"manual", "gray --man is the manual"},
                                              {"version", "gray --version prints the version"}};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (strcasecmp(commands[i][0], name) == 0)
            return commands[i][1];
    const char *words = ending_words(name);
    return words && strcmp(words, PICTURE) == 0 ? "-o FILE names the picture to write, as in gray -o FILE scene.lua"
                                                : NULL;
}
