/* The data of the render process. Other files of the host do not include this. */
#ifndef GRAY_HOST_RENDER_PROCESS_INTERNAL_H
#define GRAY_HOST_RENDER_PROCESS_INTERNAL_H

#include "base/arena.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/pool.h"
#include "export/model_write.h"
#include "export/print_check.h"
#include "host/render_process.h"
#include "output/picture_files.h"
#include "radiosity/radiosity.h"
#include "render/render.h"
#include "script/script.h"
#include "session/options_table.h"
#include "world/world.h"

enum { WARNINGS_LIMIT = 256 };

/* What an option of the command line has done to the pictures of a script. */
struct replaced_fields {
    uint64_t fields; /* by setting, as bits */
    uint64_t pictures;
};

/* A model that is written when the script has ended. */
struct kept_model {
    bool ready, shows_next; /* the next picture is its thumbnail */
    struct model_files files;
    struct list thumbnail;      /* 3MF: the bytes of a PNG file */
    struct print_report report; /* of --check-print */
};

struct render_process {
    const struct options *options;
    const struct host_services *services;
    const char *script; /* the one that runs */
    uint32_t namesakes; /* models before it whose pictures have the same name */
    struct pool *pool;  /* made for the first picture */
    struct arena job;   /* memory of the current picture */
    struct assets assets;
    struct world_cache world_cache;  /* of the frame before, in an animation */
    struct radiosity radiosity;      /* of the picture before */
    struct radiosity_store store;    /* of solutions */
    const char *picture_file;        /* of the current picture, as the script wrote it */
    bool baked;                      /* its light is written */
    bool lacks_device;               /* --device auto found none: it is not sought again */
    struct digest rendered;          /* picture_work.shows of the last picture that was rendered */
    struct scene_writer *errors;     /* what scripts write to standard error */
    uint64_t pictures;               /* of this run of the scripts, including those that cannot be rendered */
    uint64_t played;                 /* those of them that are frames in a window: nothing is written */
    struct mem_account memory;       /* of the pictures of this script: worlds, indexes of meshes, photons, films */
    struct mem_account *account;     /* the same if there is a limit, or NULL */
    uint64_t reserved;               /* its part for the current picture */
    struct file_read_log read_log;   /* hash of the files that the scripts read, if tiles are kept for a later run */
    struct file_set reported;        /* files already reported to the supervisor; empty under --watch */
    int status;                      /* --check: worst of the problems reported so far in this script */
    bool building;                   /* the world */
    bool animates;                   /* the script has called gr.frames */
    bool skips;                      /* this run of the script is a frame that is not rendered */
    bool passed_over;                /* the last picture is before the one in the window */
    bool rewinds;                    /* the script runs again, for an earlier frame */
    uint64_t runs_before;            /* of the pool, before that */
    uint64_t warned[WARNINGS_LIMIT]; /* hashes of the warnings about scenes that this script has caused */
    int warned_count;
    struct replaced_fields replaced[LIST_COUNT(SETTINGS_WITH_FIELD)]; /* by setting, of its option */
    bool vain[OPTIONS_LIMIT];  /* by option, of this run: the notice that it has no effect was printed */
    struct digest first_frame; /* of the pixels of this run's first frame, and whether a later one differs */
    bool frames_differ;
    uint64_t frames_shown;
    uint32_t models;          /* calls of node:export */
    uint32_t model_pictures;  /* under -o MODEL */
    char picture_names[1024]; /* theirs, for a message */
    struct kept_model kept_model;
    struct gltf_scene *gltf_scene; /* of -o FILE.glb, while its frames are added */
    uint32_t gltf_frame;           /* the last one */
    struct list scene;             /* its text, of the only picture */
    uint32_t scenes;               /* that were written as text */
    unsigned faults;               /* the notices of scene_check that this script has caused */
};

/* A picture between the call of gr.render and the finished film. */
struct picture_work {
    struct render_process *process;
    const struct render_request *request;
    struct render_job job;
    struct picture_request picture_request;
    struct film film;
    struct world world;
    struct digest shows; /* of a frame, without its nodes; zero: none is equal to it */
    bool built;          /* the world is complete */
    bool ok;             /* the film is */
    struct picture_report report;
    char name[NAME_LIMIT]; /* in messages: that of the script, with the number of a frame */
};

bool render_process_need_pool(struct render_process *process, struct error *error);
/* Memory is charged to pictures from here on; returns the account of the script, for mem_charge. */
struct mem_account *render_process_charge_picture(struct render_process *process);
/* A piece of requested output, for struct text_writer. */
void render_process_print(void *context, const char *text);
/* Builds the world of the picture. changed: by a window, or NULL. */
struct changed_scene;
bool render_process_build_world(struct picture_work *work, const struct changed_scene *changed, struct error *error);
/* For a world of the picture, without a cache. */
struct world_input render_process_world_input(const struct picture_work *work);

#endif
