/* Any bytes as a command line, its words separated by line ends or NUL: options whose numbers are in range, or one line
 * and status 2; picture names made from -o stay inside their buffer. */
#include "session/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { WORDS = 64 };

static void demand(bool condition) {
    if (!condition)
        abort();
}

static void check_ranges(const struct options *options) {
    const struct settings *s = &options->settings;
    demand(s->samples >= 1 && s->samples <= 64 && s->area_samples >= 1 && s->area_samples <= 64);
    demand(s->reflect_limit >= 0 && s->reflect_limit <= 1000 && s->refract_limit >= 0 && s->refract_limit <= 1000);
    demand(s->side_tolerance >= 0 && s->corner_tolerance >= 0 && s->cutoff >= 0 && s->cutoff <= 1);
    demand(s->caustics.photons >= 0 && s->caustics.photons <= PHOTONS_MAX);
    demand(fabs(s->tone.exposure) <= 100 && s->tone.curve <= TONE_FILMIC);
    demand(options->width >= 0 && options->width <= 1 << 20 && options->height >= 0 && options->height <= 1 << 20);
    demand((options->width > 0) == (options->height > 0));
    demand(!s->cropped || (s->crop_x >= 0 && s->crop_y >= 0 && s->crop_width >= 1 && s->crop_height >= 1));
    demand(options->threads >= 0 && options->threads <= 1024);
    demand(options->shard <= options->shards && (options->shard > 0) == (options->shards > 0));
    demand(options->shard_of_pictures <= options->shards_of_pictures);
    demand(options->checkpoint_every >= 0 && options->picture_count >= 0 && options->script.time_limit >= 0);
    demand(options->farm_stall >= 0 && options->farm_silence >= 0);
    demand(options->script_count >= 0 && options->script_count < WORDS && options_isa_name(options) != NULL);
    for (int i = 0; i < options->script_count; i++)
        demand(options->scripts[i] != NULL);
    for (int i = 0; i < options->script.define_count; i++)
        demand(options->script.defines[i].name[0] != '\0' && options->script.defines[i].value != NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1), *words[WORDS + 1];
    int count = 0;
    if (!text)
        return 0;
    if (size)
        memcpy(text, data, size);
    text[size] = '\0';
    static char program[] = "gray";
    words[count++] = program;
    for (size_t at = 0; at < size && count < WORDS; at += strlen(text + at) + 1) {
        for (char *c = text + at; *c; c++) {
            if (*c == '\n')
                *c = '\0';
        }
        words[count++] = text + at;
    }
    words[count] = NULL;
    struct arena arena = {0};
    struct options options;
    struct error error = {0};
    if (options_parse(&options, count, words, &arena, &error)) {
        char name[64];
        check_ranges(&options);
        (void)options_digest(&options);
        if (options.output)
            (void)output_name(options.output, 1234567, name, sizeof name);
    } else {
        demand(error.kind == ERROR_USAGE && error.text[0] != '\0');
    }
    arena_destroy(&arena);
    free(text);
    return 0;
}
